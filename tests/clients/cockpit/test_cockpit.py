"""The cockpit of a simulation: its page's process, and who is joined to it."""

import urllib.error
import urllib.request

import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.clients.cockpit.cockpit import Cockpit, CockpitError, open_cockpit


@pytest.fixture(scope="module")
def cockpit():
    pytest.importorskip("aiohttp", reason="the cockpit is not installed")
    cockpit = Cockpit(port=8280)
    yield cockpit
    cockpit.close()


@pytest.fixture(scope="module")
def flown(cockpit):
    sim = AtlasSimulation(view=cockpit.meshcat, overlays=cockpit.overlays)
    cockpit.join(sim)
    return sim


def test_a_missing_package_is_named_with_what_installs_it(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    with pytest.raises(CockpitError, match=r"atlas-drake\[cockpit\]"):
        Cockpit()


@pytest.mark.slow
def test_a_host_of_another_computer_is_refused():
    with pytest.raises(CockpitError, match=r"cannot be served on 192\.0\.2\.1"):
        Cockpit(host="192.0.2.1")


@pytest.mark.slow
def test_the_page_is_served_and_the_run_goes_on_without_it(cockpit, flown):
    page = urllib.request.urlopen(cockpit.web_url()).read().decode()
    assert "atlas_drake" in page
    assert urllib.request.urlopen(f"{cockpit.web_url()}meshcat.js").status == 200
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(
            urllib.request.Request(cockpit.web_url(), headers={"Origin": "http://a.b"})
        )
    before = flown.time
    flown.advance(0.1)
    assert flown.time == pytest.approx(before + 0.1)


def test_a_simulation_that_follows_takes_the_page_over(cockpit, flown):
    following = AtlasSimulation()
    cockpit.join(following)
    assert (flown.hooks, len(following.hooks)) == ([], 1)
    cockpit.join(flown)
    assert following.hooks == []


@pytest.mark.slow
def test_a_simulation_is_opened_with_its_cockpit_in_real_time(capsys):
    sim, cockpit = open_cockpit(Scenario(name="seen"))
    assert cockpit.web_url() in capsys.readouterr().out
    assert (sim.scenario.name, sim.meshcat, sim.realtime_rate) == (
        "seen",
        cockpit.meshcat,
        1.0,
    )
    cockpit.close()
