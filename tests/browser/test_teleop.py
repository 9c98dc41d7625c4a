"""The control panel: keys, buttons and sliders in a real browser."""

import json

import numpy as np
import pytest
from pydrake.geometry import Meshcat, MeshcatParams

from atlas_drake import AtlasSimulation, Behavior
from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.robot import load_robot
from atlas_drake.teleop.controls import PELVIS_HEIGHT, Action, fitted
from atlas_drake.teleop.pages import MAX_ROWS, pages_with
from atlas_drake.teleop.panel import Panel
from atlas_drake.teleop.session import Session
from atlas_drake.visualization.overlays import Overlays

from .conftest import drag, wait_for

pytestmark = pytest.mark.slow

OWN = fitted(load_robot(), ControllerConfig())

DRAG_POINTS = 5
"""Places on the way of the mouse from where a slider is to where it shall be."""

BEYOND = 5
"""How far beyond a slider's end the mouse is moved to reach that end [pixel]."""


LOOK = 0.04
"""Simulated time in which the session looks at the panel once [s]."""
SMALL_WINDOW = (1280, 657)
"""A browser's on a small laptop [pixel]."""
PANEL_SHARE = 0.25
"""Of the window's width that the panel may cover, so that the robot stays in sight."""
PAGE_TURNS = 20
"""More than there are pages."""


class Hand:
    """Somebody at the panel of a simulated robot."""

    def __init__(self, open_page):
        self.meshcat = Meshcat(MeshcatParams(host="localhost"))
        self.sim = AtlasSimulation()
        self._panel = Panel(self.meshcat, self.sim.robot, Overlays())
        self._session = Session(self.sim, self._panel, real_time=False)
        self.page = open_page(self.meshcat.web_url())
        # The page is ready once it knows the style, which comes after the buttons.
        self.page.wait_for_function("document.querySelector('.dg li style') !== null")

    def open_panel(self):
        """Unfolds it, as it is folded in a small window."""
        drag(self.page, middle(self.page, "document.querySelector('.close-button')"))
        self.page.wait_for_function(
            "document.querySelector('.dg.main > ul.closed') === null"
        )

    def click(self, action):
        """Clicks on a button, and waits until the click has arrived."""
        before = self.meshcat.GetButtonClicks(action.label)
        drag(self.page, middle(self.page, row(action.label)))
        wait_for(
            lambda: self.meshcat.GetButtonClicks(action.label) > before, "the click"
        )

    def turn_to(self, slider):
        """Turns pages until a slider shows."""
        for _ in range(PAGE_TURNS):
            if self.page.evaluate(f"{row(slider.label)} !== undefined"):
                return
            self.turn_page()
        pytest.fail(f"no page has {slider.label}")

    def turn_page(self):
        """Clicks for the next page, and waits until it is there."""
        before = self.title()
        self.click(Action.NEXT_PAGE)
        self.go(LOOK)
        wait_for(lambda: self.title() != before, "the next page")
        # The old page's sliders go and the new one's come one after the other.
        names = set(self.meshcat.GetSliderNames())
        wait_for(lambda: self.sliders() == names, "the sliders")

    def title(self):
        """What the open page says at its top."""
        return self.page.evaluate(
            "getComputedStyle(document.querySelector('.dg.main > ul'), '::before')"
            ".content"
        ).strip('"')

    def sliders(self):
        """Labels of the sliders in the panel."""
        return set(
            self.page.evaluate(
                "[...document.querySelectorAll('.dg.main > ul > .has-slider "
                ".property-name')].map(e => e.textContent)"
            )
        )

    def slide(self, slider, value):
        """Drags a slider to a value or next to it, and says which it got."""
        before = self.meshcat.GetSliderValue(slider.label)
        track = f"{row(slider.label)}.querySelector('.slider')"
        left, top, width, height = box(self.page, track)
        begin, end = (
            left + width * (at - slider.low) / (slider.high - slider.low)
            for at in (before, value)
        )
        # The mouse has to come down on the slider, and may go up beyond its end.
        begin = min(max(begin, left + 1.0), left + width - 1.0)
        end += {slider.low: -BEYOND, slider.high: BEYOND}.get(value, 0.0)
        y = top + 0.5 * height
        drag(self.page, *((x, y) for x in np.linspace(begin, end, DRAG_POINTS)))
        shown = self.shown(slider)
        assert shown == pytest.approx(value, abs=2.0 * slider.step)
        wait_for(
            lambda: self.meshcat.GetSliderValue(slider.label) == pytest.approx(shown),
            f"{slider.label} to be {shown}",
        )
        return shown

    def shown(self, slider):
        """What the page writes beside a slider."""
        return float(
            self.page.evaluate(f"{row(slider.label)}.querySelector('input').value")
        )

    def forget_clicks(self):
        """Has nobody hear what was pressed since the last look."""
        self._panel.read()

    def go(self, seconds):
        """Lets the session look and simulate."""
        end = self.sim.time + seconds
        while self.sim.time < end - 1e-9:
            self._session.advance()


def row(label):
    """JavaScript for the row of the panel that has a label, or undefined."""
    return (
        "[...document.querySelectorAll('.dg li')].find(e => "
        f"e.querySelector('.property-name')?.textContent === {json.dumps(label)})"
    )


def box(page, element):
    """Left, top, width and height of an element, once it is in the window [pixel]."""
    return page.evaluate(
        f"(() => {{ const e = {element}; e.scrollIntoView({{block: 'center'}});"
        "const b = e.getBoundingClientRect();"
        "return [b.left, b.top, b.width, b.height] })()"
    )


def middle(page, element):
    left, top, width, height = box(page, element)
    return left + 0.5 * width, top + 0.5 * height


@pytest.fixture
def hand(open_page):
    return Hand(open_page)


def test_a_key_makes_the_robot_walk(hand):
    key = Action.FORWARD.key
    hand.page.keyboard.press(key.code)
    label = Action.FORWARD.label
    wait_for(lambda: hand.meshcat.GetButtonClicks(label), "the key")
    hand.go(0.08)
    assert hand.meshcat.GetButtonClicks(label) == 1
    assert hand.sim.current_behavior is Behavior.WALK


def test_every_page_fits_and_hears_every_key(hand):
    width, height = SMALL_WINDOW
    hand.page.set_viewport_size({"width": width, "height": height})
    hand.open_panel()
    pages = pages_with(hand.sim.robot, OWN, ())
    for page in pages:
        assert hand.title().startswith(f"{page.title}: page ")
        rows = hand.page.evaluate(
            "[...document.querySelectorAll('.dg.main > ul > li')]"
            ".filter(e => e.getClientRects().length)"
            ".map(e => e.matches('.folder') ? 'folder' :"
            " e.querySelector('.property-name').textContent)"
        )
        actions = [Action.PREVIOUS_PAGE, Action.NEXT_PAGE]
        actions += [action for action in Action if action in page.actions]
        labels = [c.label for c in (*actions, *page.sliders)]
        assert [row for row in rows if row != "folder"] == labels
        assert ("folder" in rows) == page.scene
        assert len(rows) < MAX_ROWS
        box = "document.querySelector('.dg.main').getBoundingClientRect()"
        assert hand.page.evaluate(f"{box}.bottom") <= height
        assert hand.page.evaluate(f"{box}.width") <= PANEL_SHARE * width
        # There is nothing to scroll: the wheel leaves the robot where it is.
        extent = "document.documentElement.scrollHeight"
        assert hand.page.evaluate(extent) == height
        if not page.scene:
            tall = "(e => e.scrollHeight - e.clientHeight)"
            panel = "document.querySelector('.dg.main > ul')"
            assert hand.page.evaluate(f"{tall}({panel})") <= 0
        for action in Action:
            before = hand.meshcat.GetButtonClicks(action.label)
            if action not in (Action.PREVIOUS_PAGE, Action.NEXT_PAGE):
                hand.page.keyboard.press(action.key.code)
                wait_for(
                    lambda a=action, b=before: (
                        hand.meshcat.GetButtonClicks(a.label) == b + 1
                    ),
                    f"the key {action.key.cap}",
                )
        hand.forget_clicks()
        hand.turn_page()
    assert hand.title().startswith(pages[0].title)


def test_a_button_and_a_slider_move_the_pelvis(hand):
    sim = hand.sim
    hand.open_panel()
    hand.turn_to(PELVIS_HEIGHT)
    hand.click(Action.MANIPULATE)
    hand.go(0.2)
    assert sim.current_behavior is Behavior.MANIPULATE
    # The slider has gone to where the pelvis is, in the browser too.
    height = sim.pelvis_pose.translation()[2]
    wait_for(
        lambda: abs(hand.shown(PELVIS_HEIGHT) - height) < 0.02, "the slider to follow"
    )
    goal = hand.slide(PELVIS_HEIGHT, height - 0.1)
    hand.go(0.08)
    feedback = sim.atlas_sim_interface_state.manipulate_feedback
    assert feedback.clamped.pelvis_height == pytest.approx(goal)
    hand.go(2.0)
    assert sim.pelvis_pose.translation()[2] == pytest.approx(goal, abs=0.02)
    assert not sim.has_fallen
