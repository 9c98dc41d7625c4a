"""Settings and scenarios of the cockpit in a real browser."""

import re

import pytest
from pydrake.common.yaml import yaml_load

from .conftest import FAST, Run, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.browser]

GAIN = "controller.gains.dcm_gain"


@pytest.fixture(scope="module")
def teleop(tmp_path_factory):
    """Address of ``atlas-drake teleop`` in a process of its own."""
    pytest.importorskip("nicegui", reason="the cockpit is not installed")
    folder = tmp_path_factory.mktemp("teleop")
    run = Run(folder, "teleop", *FAST, "--port", "8280")
    yield run.url
    run.end()


@pytest.fixture
def page(teleop, open_page):
    page = open_page(teleop)
    page.set_viewport_size({"width": 1280, "height": 720})
    page.get_by_role("tab", name="Settings").wait_for()
    return page


def tab(page, name):
    page.get_by_role("tab", name=name).click()


def press(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def downloaded(page, name):
    with page.expect_download() as download:
        press(page, name)
    return yaml_load(data=download.value.path().read_text())


def choose(page, name, option):
    page.get_by_role("combobox", name=name, exact=True).click()
    page.get_by_role("option", name=option, exact=True).click()


def robot_is(page, name):
    page.locator(".robot", has_text=re.compile(f"^{name}$")).wait_for()


def test_settings_are_changed_saved_and_started(page):
    tab(page, "Settings")
    page.get_by_label("Search settings").fill("dcm_gain")
    field = page.get_by_label(GAIN, exact=True)
    field.fill("much")
    field.press("Enter")
    page.get_by_text(re.compile(f"^{GAIN}: .*number")).wait_for()
    wait_for(lambda: field.input_value() == "2.0", "the value in force")
    field.fill("2.6")
    field.press("Enter")
    page.get_by_text("1 change needs a restart").wait_for()
    assert downloaded(page, "Save settings")["controller"] == {
        "gains": {"dcm_gain": 2.6}
    }
    press(page, "Restart with changes")
    page.get_by_role("tab", name="Joints", selected=True).wait_for()
    tab(page, "Settings")
    page.get_by_role("switch", name="Changed only").click()
    wait_for(lambda: field.count() == 1, "the setting that differs")
    assert field.input_value() == "2.6"


def test_another_scenario_is_started_and_a_bad_one_is_not(page):
    tab(page, "Scenario")
    files = page.locator("input[type=file]")
    bad = {"name": "bad.yaml", "mimeType": "text/yaml", "buffer": b"model: nobody"}
    files.set_input_files(bad)
    page.get_by_text("bad.yaml").first.wait_for()
    press(page, "Start scenario")
    page.get_by_role("alert").filter(has_text="model").wait_for()
    robot_is(page, "atlas")
    choose(page, "Scenario", "stand_v3")
    press(page, "Start scenario")
    robot_is(page, "atlas_v3")
    wait_for(
        lambda: page.evaluate(
            "typeof viewer !== 'undefined' && Object.keys(viewer.scene_tree"
            ".find(['drake', 'visualizer']).children).length > 0"
        ),
        "the robot in the view",
    )
    tab(page, "Scenario")
    assert downloaded(page, "Save what I did")["model"] == "atlas_v3"
