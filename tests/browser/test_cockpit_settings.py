"""Settings and scenarios of the cockpit in a real browser."""

import pytest
from pydrake.common.yaml import yaml_load

from .conftest import CockpitPage, Run, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.browser]

GAIN = "controller.gains.dcm_gain"


@pytest.fixture(scope="module")
def page(tmp_path_factory, browser):
    """The page of a run that is replaced by others."""
    pytest.importorskip("aiohttp", reason="the cockpit is not installed")
    folder = tmp_path_factory.mktemp("teleop")
    run = Run(folder, "teleop", "--port", "8280")
    page = CockpitPage(browser, run.url)
    yield page
    assert not page.errors
    page.page.close()
    run.end()


def downloaded(page, name):
    with page.page.expect_download() as download:
        page.press(name)
    return yaml_load(data=download.value.path().read_text())


def test_settings_are_changed_saved_and_started(page):
    page.tab("Settings")
    page.labelled("Search settings").fill("dcm_gain")
    field = page.page.get_by_label(GAIN, exact=True)
    field.fill("much")
    field.press("Enter")
    page.page.get_by_role("alert").filter(has_text="number").wait_for()
    wait_for(lambda: field.input_value() == "2.0", "the value in force")
    field.fill("2.6")
    field.press("Enter")
    page.page.get_by_text("1 change needs a restart").wait_for()
    assert downloaded(page, "Save settings")["controller"] == {
        "gains": {"dcm_gain": 2.6}
    }
    with page.page.expect_navigation():  # The page of another run.
        page.press("Restart with changes")
    page.awaits_run()
    page.tab("Settings")
    page.page.get_by_role("switch", name="Changed only").click()
    wait_for(lambda: field.count() == 1, "the setting that differs")
    assert field.input_value() == "2.6"


def test_another_scenario_is_started_and_a_bad_one_is_not(page):
    page.tab("Scenario")
    files = page.page.locator("input[type=file]")
    bad = {"name": "bad.yaml", "mimeType": "text/yaml", "buffer": b"model: nobody"}
    files.set_input_files(bad)
    page.page.get_by_text("bad.yaml, 13 bytes").wait_for()
    page.press("Start scenario")
    page.page.get_by_role("alert").filter(has_text="model").wait_for()
    robot = page.page.locator(".robot")
    assert robot.inner_text() == "atlas"
    page.page.get_by_role("combobox", name="Scenario").select_option("stand_v3")
    with page.page.expect_navigation():
        page.press("Start scenario")
    page.awaits_run()
    assert robot.inner_text() == "atlas_v3"
    page.until("cockpit.isComplete()")
    page.tab("Scenario")
    assert downloaded(page, "Save what I did")["model"] == "atlas_v3"
