"""Settings of a scenario: described, checked, started, written."""

import io
import shutil
from dataclasses import dataclass
from pathlib import Path

import orjson
import pytest
from pydrake.common.yaml import yaml_load

from atlas_drake import ScenarioError
from atlas_drake.clients.cli.progress import Progress
from atlas_drake.clients.cli.teleop import followed
from atlas_drake.clients.cockpit.fields import (
    param_fields,
    scenario_fields,
    settings_of,
)
from atlas_drake.scenario import Scenario, with_settings
from atlas_drake.units import Radians
from atlas_drake.worlds.world import WorldError

HERON = Path(__file__).parents[2] / "robots" / "heron"
GAIN = "controller.gains.dcm_gain"


@pytest.fixture(scope="module")
def settings():
    return {one["path"]: one for one in scenario_fields(Scenario().resolved())}


def test_a_setting_has_unit_bounds_and_usual_value(settings):
    step = settings["physics_step"]
    assert (step["value"], step["usual"], step["unit"]) == ("0.003", "0.003", "s")
    told = step["kind"], step["bounds"], step["needs"]
    assert told == ("number", "> 0", "a restart")
    assert settings["jitter.mass"]["bounds"] == "≥ 0, < 1"
    assert settings["jitter.mass"]["needs"] == "a new run"
    assert settings["state"]["choices"] == ["true", "estimated"]
    assert settings["start.on_gantry"]["kind"] == "flag"
    assert settings["controller.walk.limits.duration"]["kind"] == "yaml"


def test_settings_of_the_package_say_what_they_are(settings):
    silent = [path for path, one in settings.items() if not one["text"]]
    assert all(path.startswith(("plant.", "simulator.")) for path in silent)


def test_the_examples_can_be_chosen():
    assert "platform" in settings_of(Scenario().resolved(), "")["examples"]


def test_every_value_is_read_back_from_its_text(settings):
    usual = Scenario().resolved()
    texts = [f"{path}={one['value']}" for path, one in settings.items()]
    assert with_settings(Scenario(), texts).resolved() == usual


@dataclass(frozen=True)
class BowParams:
    """Parameters of a behavior of a user's own."""

    depth: Radians = 0.3
    """How deep."""
    times: int = 2
    fast: bool = False
    name: str = "bow"


def test_parameters_of_a_behavior_are_described_as_settings_are():
    depth, times, fast, name = param_fields(BowParams)
    assert (depth["path"], depth["value"], depth["unit"]) == ("depth", "0.3", "rad")
    kinds = [one["kind"] for one in (depth, times, fast, name)]
    assert kinds == ["number", "number", "flag", "text"]


def test_settings_are_written_as_what_differs(run):
    text = run.do("written", changes={GAIN: "2.6"})
    assert yaml_load(data=text)["controller"] == {"gains": {"dcm_gain": 2.6}}


def test_a_value_that_is_refused_says_why(run):
    with pytest.raises(ScenarioError, match="physics_step"):
        run.do("check", changes={"physics_step": "1.0"})
    with pytest.raises(ScenarioError, match=GAIN):
        run.do("check", changes={GAIN: "much"})
    assert run.do("check", changes={GAIN: "2.5"})


def test_a_scenario_with_errors_is_not_started(run, next_run):
    next_run.why_not = ""
    for text in ("", "a: b: c", "controler: {}", "model: nobody", "[1, 2]"):
        with pytest.raises(ScenarioError):
            run.do("start", text=text)
    assert next_run.scenario is None


def test_another_controller_waits_for_the_program(run, next_run):
    next_run.why_not = ""
    run.do("start", changes={GAIN: "2.5", "model": "atlas_v3"})
    asked = next_run.take()
    assert asked.model == "atlas_v3"
    assert asked.controller_config().gains.dcm_gain == 2.5


def test_another_seed_begins_at_once(run, next_run, shared_sim):
    shared_sim.advance(0.02)
    run.do("start", changes={"seed": "3", "jitter.position": "0.01"})
    assert next_run.scenario is None
    assert (shared_sim.time, shared_sim.scenario.seed) == (0.0, 3)
    described = orjson.loads(run.page.settings().page)
    assert (described["seed"], described["robot"]) == (3, "atlas")
    shared_sim.restart(Scenario())


def test_a_program_of_one_simulation_says_so(run):
    with pytest.raises(ScenarioError, match="teleop"):
        run.do("start", changes={GAIN: "2.5"})


def test_a_simulation_that_cannot_be_built_leaves_the_present_one():
    said = []

    class Page:
        def say(self, text, lasting=False):
            said.append(text)

    def build(scenario, cockpit):
        raise WorldError("it is full")

    asked = Scenario(name="crowd")
    assert followed("now", asked, build, Page(), Progress(io.StringIO(), 1.0)) == "now"
    assert said[-1] == "crowd cannot be simulated: it is full"


def test_imported_robots_can_be_chosen(tmp_path, monkeypatch):
    for folder, name in (("here", "bird"), ("there", "horse"), ("there", "mule")):
        path = tmp_path / folder / name / "robot.yaml"
        shutil.copytree(HERON, path.parent)
        (path.parent / "heron.yaml").rename(path)
    monkeypatch.chdir(tmp_path / "here")
    rides = tmp_path / "there" / "mule" / "robot.yaml"
    scenario = Scenario(model=str(rides)).resolved()
    robots = settings_of(scenario, "")["robots"]
    assert robots[0] == ["atlas", "atlas"]
    assert [label for _, label in robots[-3:]] == [
        "bird (imported)",
        "horse (imported)",
        "mule (imported)",
    ]
    assert robots[-1][0] == str(rides)
    # What is chosen is a scenario's model.
    assert with_settings(scenario, [f"model={robots[-3][0]}"]).model == robots[-3][0]
