"""A log in the cockpit, in a real browser: slider, plots, two robots, a recording."""

import pytest

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Behavior

from .conftest import Run, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.browser]

END = 3.0
"""End of the log [s]."""
CHANNEL = "balance.com.x"


@pytest.fixture(scope="module")
def url(tmp_path_factory):
    """The address of ``atlas-drake replay --cockpit`` over a log, and one beside."""
    pytest.importorskip("nicegui", reason="the cockpit is not installed")
    folder = tmp_path_factory.mktemp("replay")
    log = folder / "run.mcap"
    with AtlasSimulation(log=log) as sim:
        sim.advance(1.0)
        sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))
        sim.advance(END - 1.0)
    run = Run(folder, "replay", log, "--cockpit", "--beside", log, "--port", "8480")
    yield run.url
    run.end()


@pytest.fixture
def page(url, browser):
    page = browser.new_page(viewport={"width": 1280, "height": 720})
    errors = []
    page.on("pageerror", lambda error: errors.append(error))  # noqa: PLW0108
    page.goto(url)
    wait_for(lambda: says(page, "Time"), "the first state")
    yield page
    assert not errors
    page.close()


def says(page, label):
    found = page.get_by_label(label, exact=True)
    return found.first.inner_text() if found.count() else ""


def time_of(page):
    return float(says(page, "Time").split()[0])


def press(page, name):
    page.get_by_role("button", name=name, exact=True).first.click()


def test_a_log_is_played_searched_plotted_and_recorded(page):
    wait_for(lambda: time_of(page) >= END - 0.1, "the end of the log")
    wait_for(lambda: says(page, "Speed").startswith("paused"), "the rest")
    assert says(page, "Mode") == "FREEZE"
    events = page.get_by_role("log").first
    assert "FREEZE" in events.inner_text()

    # View, panels and plots follow the slider.
    slider = page.get_by_role("slider", name="Time of the log")
    box = page.locator(".scrubber .q-slider").bounding_box()
    middle = box["y"] + 0.5 * box["height"]
    page.mouse.click(box["x"] + 0.2 * box["width"], middle)
    wait_for(lambda: says(page, "Mode") == "STAND", "the time before")
    assert time_of(page) == pytest.approx(0.2 * END, abs=0.15)
    wait_for(
        lambda: float(slider.get_attribute("aria-valuenow")) < 1.0, "the slider itself"
    )
    assert "FREEZE" not in events.inner_text()

    page.get_by_label("Channel to plot").fill(CHANNEL)
    curves = page.locator(".chart polyline")
    wait_for(lambda: curves.count() == 2, "the curves of both logs")
    assert curves.nth(1).get_attribute("stroke-dasharray")
    press(page, f"Remove {CHANNEL}")
    wait_for(lambda: curves.count() == 0, "no curves")

    # Two robots stand side by side.
    assert page.evaluate(
        """['/drake/visualizer', '/atlas_drake/beside'].every((path) =>
          Object.keys(viewer.scene_tree.find(path.split('/').slice(1)).children)
            .length)"""
    )

    press(page, "Record")
    page.get_by_role("button", name="Stop and save").wait_for()
    press(page, "Pause")
    wait_for(lambda: time_of(page) > 1.5, "some motion")
    with page.expect_download() as download:
        press(page, "Stop and save")
    assert download.value.suggested_filename.endswith(".html")
    with open(download.value.path(), encoding="utf-8") as file:
        assert "MeshCat" in file.read()


def test_a_log_is_not_commanded(page):
    assert page.get_by_role("tab", name="Walk").count() == 0
    assert page.get_by_role("button", name="STOP", exact=True).count() == 0
    assert page.get_by_role("button", name="None mine").is_hidden()
    page.keyboard.press("i")
    page.get_by_text("it can be played, not commanded").first.wait_for()
    inner = page.evaluate("document.documentElement.scrollHeight")
    assert inner <= 720
