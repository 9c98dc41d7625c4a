"""The widgets in Meshcat, without a browser."""

import math
import struct

import pytest
from pydrake.geometry import Meshcat

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.robot import load_robot
from atlas_drake.teleop.controls import (
    PAGE_TURNS,
    PUSH_IMPULSE,
    SHARES,
    SLIDERS,
    STRIDE,
    Action,
    fitted,
    legend,
)
from atlas_drake.teleop.pages import MAX_ROWS, SWITCHES, joint_slider, pages_with
from atlas_drake.teleop.panel import Panel, stick_direction
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.scene import CAMERA

OWN = fitted(load_robot(), ControllerConfig())


@pytest.fixture(scope="module")
def meshcat():
    return Meshcat()


@pytest.fixture
def overlays():
    return Overlays(["com"])


@pytest.fixture
def said():
    return []


@pytest.fixture
def panel(meshcat, robot, overlays, said):
    meshcat.DeleteAddedControls()
    return Panel(meshcat, robot, overlays, say=said.append)


def text(word):
    """A word in MessagePack."""
    return bytes([0xD9, len(word)]) + word.encode()


def click(meshcat, action, times=1):
    """What a browser sends."""
    fields = ("type", "button", "name", action.label)
    for _ in range(times):
        meshcat._InjectWebsocketMessage(b"\x82" + b"".join(map(text, fields)))


def slide(meshcat, slider, value):
    """What a web client sends, whatever the value."""
    fields = ("type", "slider", "name", slider.label, "value")
    number = b"\xcb" + struct.pack(">d", value)
    meshcat._InjectWebsocketMessage(b"\x83" + b"".join(map(text, fields)) + number)


def open_page(panel, meshcat, slider):
    """Turns pages until a slider shows."""
    for _ in range(20):
        if slider.label in meshcat.GetSliderNames():
            return
        click(meshcat, Action.NEXT_PAGE)
        panel.read()
    pytest.fail(f"no page has {slider.label}")


def test_every_button_has_its_key_on_every_page(panel, meshcat, robot):
    for _ in pages_with(robot, OWN, ()):
        for action in Action:
            meshcat.GetButtonClicks(action.label)
            # A button of this name with another key would be refused.
            with pytest.raises(RuntimeError, match="keycode"):
                meshcat.AddButton(action.label, "KeyZ")
        click(meshcat, Action.NEXT_PAGE)
        panel.read()


def test_a_click_is_read_once_on_any_page(panel, meshcat):
    click(meshcat, Action.NEXT_PAGE)
    assert panel.read().clicks == ()
    click(meshcat, Action.RESET)
    assert panel.read().clicks == (Action.RESET,)
    assert panel.read().clicks == ()


def test_pages_are_short_and_together_have_everything(robot):
    pages = pages_with(robot, OWN, range(robot.num_joints))
    for page in pages:
        rows = 1 + len(PAGE_TURNS) + len(page.actions) + len(page.sliders)
        assert rows <= MAX_ROWS
        # They become JavaScript and CSS strings.
        assert not set("'\"\\") & set(page.title + page.note)
    assert {a for page in pages for a in page.actions} == set(Action) - set(PAGE_TURNS)
    labels = {slider.label for page in pages for slider in page.sliders}
    assert {slider.label for slider in (*SLIDERS, *SWITCHES.values())} < labels
    assert {f"{name} [rad]" for name in robot.joint_names} < labels
    assert len({page.title for page in pages}) == len(pages)


def test_pages_turn_both_ways_and_in_a_circle(panel, meshcat):
    at_first = meshcat.GetSliderNames()
    click(meshcat, Action.NEXT_PAGE)
    panel.read()
    walking = meshcat.GetSliderNames()
    assert STRIDE.label in walking
    click(meshcat, Action.PREVIOUS_PAGE)
    panel.read()
    assert meshcat.GetSliderNames() == at_first
    click(meshcat, Action.PREVIOUS_PAGE)
    click(meshcat, Action.NEXT_PAGE, times=2)
    panel.read()
    assert meshcat.GetSliderNames() == walking


def test_values_of_sliders_stay_when_the_page_turns(panel, meshcat):
    open_page(panel, meshcat, STRIDE)
    meshcat.SetSliderValue(STRIDE.label, 0.27)
    assert panel.read().value(STRIDE) == pytest.approx(0.27)
    # Moved just before the page turns, so that no look has seen it yet.
    meshcat.SetSliderValue(STRIDE.label, 0.11)
    open_page(panel, meshcat, PUSH_IMPULSE)
    assert STRIDE.label not in meshcat.GetSliderNames()
    assert panel.read().value(STRIDE) == pytest.approx(0.11)
    panel.set(STRIDE, 0.22)
    assert panel.read().value(STRIDE) == pytest.approx(0.22)
    open_page(panel, meshcat, STRIDE)
    assert meshcat.GetSliderValue(STRIDE.label) == pytest.approx(0.22)


def test_a_value_between_two_steps_of_its_slider_is_kept(panel, meshcat):
    open_page(panel, meshcat, STRIDE)
    panel.set(STRIDE, 0.2234)
    assert meshcat.GetSliderValue(STRIDE.label) == pytest.approx(0.22)
    open_page(panel, meshcat, PUSH_IMPULSE)
    open_page(panel, meshcat, STRIDE)
    assert panel.read().value(STRIDE) == 0.2234
    panel.set(STRIDE, 9.0)
    assert panel.read().value(STRIDE) == STRIDE.high


@pytest.mark.parametrize("slider", SLIDERS, ids=lambda slider: slider.label)
def test_no_web_client_sets_a_value_beyond_its_slider(panel, meshcat, slider, said):
    open_page(panel, meshcat, slider)
    sent = {-1e6: slider.low, 1e300: slider.high}
    sent |= dict.fromkeys((math.nan, math.inf, -math.inf), slider.high)
    for value, in_force in sent.items():
        said.clear()
        slide(meshcat, slider, value)
        assert panel.read().value(slider) == pytest.approx(in_force)
        # The browser's slider shows the value in force again.
        shown = meshcat.GetSliderValue(slider.label)
        assert shown == pytest.approx(in_force, abs=slider.step)
        (line,) = said
        assert slider.label in line
        assert repr(value) in line


def test_a_joint_stays_within_its_limits_and_a_switch_is_on_or_off(
    panel, meshcat, robot, overlays
):
    elbow = robot.joint_index("l_arm_ely")
    panel.show_joints({elbow: 0.5})
    slider = joint_slider(robot, elbow)
    open_page(panel, meshcat, slider)
    for value, in_force in ((math.nan, 0.5), (1e3, robot.position_upper[elbow])):
        slide(meshcat, slider, value)
        assert panel.read().joints == pytest.approx({elbow: in_force})
    open_page(panel, meshcat, SWITCHES["com"])
    slide(meshcat, SWITCHES["com"], math.nan)
    panel.read()
    assert overlays.is_on("com")


def test_a_browser_may_round_to_a_step_beyond_the_end(panel, meshcat, said):
    open_page(panel, meshcat, STRIDE)
    slide(meshcat, STRIDE, STRIDE.high + 0.5 * STRIDE.step)
    assert panel.read().value(STRIDE) == STRIDE.high
    assert said == []


def test_the_view_shows_that_the_simulation_is_paused(panel, meshcat):
    panel.show_paused(True)
    assert meshcat.HasPath(f"{CAMERA}/paused")
    panel.show_paused(False)
    assert not meshcat.HasPath(f"{CAMERA}/paused")


def test_every_action_has_a_key_of_its_own_in_the_legend(robot):
    text = legend(robot)
    for action in Action:
        assert f" {action.key.cap} " in text.replace("\n", " ")
    assert max(map(len, text.splitlines())) <= 88
    assert len({action.key.code for action in Action}) == len(Action)


def test_the_sliders_begin_where_they_should(panel):
    controls = panel.read()
    assert controls.clicks == ()
    assert controls.stick is None
    for slider in SLIDERS:
        assert controls.value(slider) == pytest.approx(slider.value)
        assert slider.low <= slider.value <= slider.high
    panel.set(SHARES["legs"], 200)
    assert panel.read().shares["legs"] == 200


def test_the_users_joints_get_a_page(panel, meshcat, robot):
    elbow, arm = robot.joint_index("l_arm_ely"), SHARES["left arm"]
    at_once = {elbow: 1.004, 3: 0.0}
    panel.show_joints(at_once)
    assert panel.read().joints == at_once
    open_page(panel, meshcat, arm)
    click(meshcat, Action.NEXT_PAGE)
    panel.read()
    assert set(meshcat.GetSliderNames()) == {arm.label, "l_arm_ely [rad]"}
    meshcat.SetSliderValue("l_arm_ely [rad]", 0.7)
    panel.show_joints({elbow: 0.0})
    assert panel.read().joints == pytest.approx({elbow: 0.7})
    # Given back: its page goes, and the one before it opens.
    panel.show_joints({})
    assert panel.read().joints == {}
    assert set(meshcat.GetSliderNames()) == {s.label for s in SHARES.values()}
    panel.show_joints({elbow: 0.2})
    assert panel.read().joints == {elbow: 0.2}


def test_overlays_are_switched(panel, meshcat, overlays):
    open_page(panel, meshcat, SWITCHES["com"])
    assert meshcat.GetSliderValue("show com") == 1
    meshcat.SetSliderValue("show com", 0)
    meshcat.SetSliderValue("show owner", 1)
    panel.read()
    assert not overlays.is_on("com")
    assert overlays.is_on("owner")
    # A link has one color: switching one coloring on ends the other.
    for other, switch in (("owner", "effort"), ("effort", "owner")):
        meshcat.SetSliderValue(f"show {switch}", 1)
        panel.read()
        assert overlays.is_on(switch)
        assert not overlays.is_on(other)
        assert meshcat.GetSliderValue(f"show {other}") == 0


def test_gamepad_axes_become_a_direction():
    assert stick_direction([0.0, 0.0, 0.0, 0.0]) == (0.0, 0.0, 0.0)
    assert stick_direction([0.1, -0.1, 0.1]) == (0.0, 0.0, 0.0)
    assert stick_direction([0.0, -1.0, 0.0]) == (1.0, 0.0, 0.0)
    assert stick_direction([-1.0, 0.0, 0.6]) == (0.0, 1.0, -0.5)
    assert stick_direction([]) == (0.0, 0.0, 0.0)
    assert stick_direction([math.nan, -math.inf, 7.0]) == (0.0, 0.0, -1.0)
