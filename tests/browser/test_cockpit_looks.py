"""The look of the cockpit in a real browser: sizes, contrast, what covers what."""

import io
import re

import pytest

from .conftest import PHONE, SCREEN, SMALL_LAPTOP, CockpitPage, wait_for
from .looks import (
    FAINT,
    HIDDEN_JOINTS,
    INNER_SIZE,
    NAMELESS,
    SMALL_CONTROLS,
    STOP_COVERED,
)

pytestmark = [pytest.mark.slow, pytest.mark.browser]

SIZES = [PHONE, SMALL_LAPTOP, SCREEN]
CHANNEL = "balance.com.x"
LINES = 5
"""Events that are seen at least on a small laptop."""


@pytest.fixture
def page(page):
    """The page of a run that goes on slowly, which leaves the computer to the page."""
    page.ask("rate", rate=0.1)
    return page


def plot(page, channel=CHANNEL):
    page.labelled("Channel to plot").fill(channel)
    page.button(f"Remove {channel}").wait_for()


@pytest.mark.parametrize("size", SIZES)
def test_every_control_has_a_size_one_can_hit(page, size):
    page.page.set_viewport_size(size)
    plot(page)
    small, hidden = set(), page.see(HIDDEN_JOINTS)
    for tab in ("Walk", "Pelvis", "Scenario", "Settings", "Joints"):
        page.tab(tab)
        if tab == "Settings":
            page.labelled("Search settings").fill("controller.stand")
            page.page.locator(".setting").first.wait_for()
        small.update(page.see(SMALL_CONTROLS))
    for menu in ("Show", "Push", "Pose", "New run", "Keys", "Gains of r_arm_shy"):
        page.press(menu)
        opened = page.page.locator(".menu:popover-open")
        opened.wait_for()
        small.update(page.see(SMALL_CONTROLS))
        page.page.evaluate("document.querySelector('.menu:popover-open').hidePopover()")
    page.press(f"Remove {CHANNEL}")
    assert small == set()
    assert hidden == []


@pytest.mark.parametrize("size", SIZES)
def test_nothing_covers_stop(page, size):
    page.page.set_viewport_size(size)
    page.page.wait_for_timeout(100)
    found = page.see(STOP_COVERED)
    assert found["covered"] == []
    assert found["opened"] > 50
    stop = page.button("STOP").bounding_box()
    assert stop["y"] + stop["height"] <= size["height"]


@pytest.mark.parametrize("size", [SMALL_LAPTOP, SCREEN])
def test_a_screen_shows_all_without_scrolling(page, size):
    page.page.set_viewport_size(size)
    plot(page)
    page.page.wait_for_timeout(100)
    inner = page.see(INNER_SIZE)
    assert inner[0] <= size["width"]
    assert inner[1] <= size["height"]
    begin, _, end, _ = page.box("#view")
    assert end - begin > 0.45 * size["width"]
    # The plot and the events are whole without scrolling at the right.
    _, top, _, bottom = page.box(".right")
    for part in (".chart", "[role=log]"):
        box = page.box(part)
        assert box[1] >= top
        assert box[3] <= bottom
    line, events = page.box("[role=log] p"), page.box("[role=log]")
    assert events[3] - events[1] >= LINES * (line[3] - line[1])
    # The left side uses its height.
    _, top, _, bottom = page.box(".left")
    last = page.box(".dial:last-child")
    assert top + 0.8 * (bottom - top) < last[3] <= bottom
    page.press(f"Remove {CHANNEL}")


def test_a_phone_shows_the_robot_first(page):
    page.page.set_viewport_size(PHONE)
    assert page.see(INNER_SIZE)[0] <= PHONE["width"]
    view = page.page.locator("#view").bounding_box()
    assert view["y"] < 0.3 * PHONE["height"]
    assert view["width"] > 0.9 * PHONE["width"]
    page.page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
    stop = page.button("STOP").bounding_box()
    assert 0 < stop["y"] < PHONE["height"] - stop["height"]


def test_everything_has_a_name_and_can_be_read_in_light_and_dark(page):
    plot(page)
    themes = set()
    for _ in range(2):
        for tab in ("Walk", "Pelvis", "Scenario", "Settings", "Joints"):
            page.tab(tab)
            if tab == "Settings":
                page.labelled("Search settings").fill("dcm_gain")
            assert page.see(NAMELESS) == []
            assert page.see(FAINT) == []
        for menu in ("Show", "Push", "Pose", "New run", "Keys"):
            page.press(menu)
            assert page.see(NAMELESS) == []
            assert page.see(FAINT) == []
            page.page.evaluate(
                "document.querySelector('.menu:popover-open').hidePopover()"
            )
        themes.add(page.see("getComputedStyle(document.body).backgroundColor"))
        page.press("Dark or light")
    assert len(themes) == 2
    page.press(f"Remove {CHANNEL}")


def test_a_picture_is_fine_whatever_the_page_draws(page):
    from PIL import Image

    page.page.evaluate("viewer.renderer.setPixelRatio(0.5)")
    with page.page.expect_download() as download:
        page.press("Picture")
    picture = Image.open(io.BytesIO(download.value.path().read_bytes()))
    assert picture.width >= 1280
    assert picture.height >= 720
    assert len(picture.convert("RGB").resize((64, 64)).getcolors(4096)) > 100
    assert page.see("viewer.renderer.getPixelRatio()") == 0.5


def test_plots_say_what_there_is_not_and_their_axes_can_be_read(page):
    search = page.labelled("Channel to plot")
    search.fill("balance.con.x")
    search.press("Enter")
    page.page.get_by_text(
        re.compile(r"there is no channel “balance.con.x”; the nearest: .*balance.com.x")
    ).wait_for()
    plot(page)
    chart = page.page.locator(".chart")
    wait_for(lambda: chart.locator("polyline").count() == 1, "the curve")
    texts = chart.locator("text").all_text_contents()
    assert len(texts) > 4
    assert len(set(texts)) == len(texts)
    before = chart.locator("polyline").get_attribute("points")
    wait_for(
        lambda: chart.locator("polyline").get_attribute("points") != before,
        "the curve to go on",
    )
    page.labelled("Time plotted").select_option("60")
    page.press(f"Remove {CHANNEL}")
    wait_for(lambda: chart.count() == 0, "no plot")


def test_a_search_that_says_so_many_shows_so_many(page):
    page.tab("Settings")
    page.labelled("Search settings").fill("dcm")
    said = page.page.get_by_text(re.compile(r"^\d+ of \d+ settings$"))
    said.wait_for()
    count = int(said.inner_text().split()[0])
    assert 1 < count < 40
    assert page.page.locator(".setting").count() == count
    page.labelled("Search settings").fill("")


def test_the_page_says_that_the_robot_loads(teleop, browser):
    late = []
    page = CockpitPage(
        browser,
        teleop.url,
        before=lambda one: one.route("**/cas-v1/**", lambda one: late.append(one)),  # noqa: PLW0108
    )
    loading = page.page.get_by_text("Loading the robot")
    wait_for(lambda: loading.is_visible() and len(late) > 5, "files of the robot")
    page.page.evaluate("0")  # Hears of the last files.
    while late:
        late.pop().continue_()
    page.page.unroute_all()
    loading.wait_for(state="hidden")
    assert page.see("cockpit.isComplete()")
    page.page.close()
