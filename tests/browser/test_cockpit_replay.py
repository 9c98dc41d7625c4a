"""A log in the cockpit, in a real browser: slider, plots, two robots, a recording."""

import pytest

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Behavior

from .conftest import CockpitPage, Run, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.browser]

END = 3.0
"""End of the log [s]."""
CHANNEL = "balance.com.x"


@pytest.fixture(scope="module")
def page(tmp_path_factory, browser):
    """The page of ``atlas-drake replay`` over a log, and one beside."""
    pytest.importorskip("aiohttp", reason="the cockpit is not installed")
    folder = tmp_path_factory.mktemp("replay")
    log = folder / "run.mcap"
    with AtlasSimulation(log=log) as sim:
        sim.advance(1.0)
        sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))
        sim.advance(END - 1.0)
    run = Run(folder, "replay", log, "--cockpit", "--beside", log, "--port", "8480")
    page = CockpitPage(browser, run.url)
    yield page
    assert not page.errors
    page.page.close()
    run.end()


def test_a_log_is_played_searched_plotted_and_recorded(page):
    wait_for(lambda: page.time >= END - 0.1, "the end of the log")
    wait_for(lambda: page.paused, "the rest")
    assert page.mode == "FREEZE"
    wait_for(lambda: "FREEZE" in page.events(), "the event")

    # View, panels and plots follow the slider.
    slider = page.page.get_by_role("slider", name="Time of the log")
    box = slider.bounding_box()
    page.page.mouse.click(box["x"] + 0.2 * box["width"], box["y"] + 0.5 * box["height"])
    page.becomes("STAND")
    assert page.time == pytest.approx(0.2 * END, abs=0.15)
    assert float(slider.input_value()) == pytest.approx(0.2 * END, abs=0.15)
    wait_for(lambda: "FREEZE" not in page.events(), "the events until then")

    page.labelled("Channel to plot").fill(CHANNEL)
    curves = page.page.locator(".chart polyline")
    wait_for(lambda: curves.count() == 2, "the curves of both logs")
    assert curves.nth(1).get_attribute("stroke-dasharray")
    page.press(f"Remove {CHANNEL}")
    wait_for(lambda: curves.count() == 0, "no curves")

    # Two robots stand side by side.
    page.until("""["/drake/visualizer", "/atlas_drake/beside"].every((path) =>
      Object.keys(cockpit.find(path)?.children ?? {}).length)""")

    page.press("Record")
    page.button("Stop and save").wait_for()
    page.press("Pause")
    wait_for(lambda: page.time > 1.5, "some motion")
    with page.page.expect_download() as download:
        page.press("Stop and save")
    assert download.value.suggested_filename.endswith(".html")
    with open(download.value.path(), encoding="utf-8") as file:
        assert "MeshCat" in file.read()


def test_a_log_is_not_commanded(page):
    assert page.page.get_by_role("tab").all_inner_texts() == ["Joints"]
    assert page.button("STOP").count() == 0
    assert page.button("None mine").count() == 0
    page.key("i")
    page.tells("it can be played, not commanded")
    assert page.see("document.documentElement.scrollHeight") <= 720
