"""The widgets in Meshcat, without a browser."""

import pytest
from pydrake.geometry import Meshcat

from atlas_drake.teleop.controls import SHARES, SLIDERS, Action, legend
from atlas_drake.teleop.panel import Panel, stick_direction
from atlas_drake.visualization.overlays import Overlays


@pytest.fixture(scope="module")
def meshcat():
    return Meshcat()


@pytest.fixture
def overlays():
    return Overlays(["com"])


@pytest.fixture
def panel(meshcat, robot, overlays):
    meshcat.DeleteAddedControls()
    return Panel(meshcat, robot, overlays)


def test_every_button_has_its_key(panel, meshcat):
    for action in Action:
        assert meshcat.GetButtonClicks(action.label) == 0
        # A button of this name with another key would be refused.
        with pytest.raises(RuntimeError, match="keycode"):
            meshcat.AddButton(action.label, "KeyZ")


def test_no_key_does_two_things():
    codes = [action.key.code for action in Action]
    assert len(set(codes)) == len(codes)


def test_the_legend_names_every_key():
    for action in Action:
        assert f" {action.key.cap} " in legend().replace("\n", " ")
    assert max(map(len, legend().splitlines())) <= 88


def test_the_sliders_begin_where_they_should(panel):
    controls = panel.read()
    assert controls.clicks == ()
    assert controls.stick is None
    for slider in SLIDERS:
        assert controls.value(slider) == pytest.approx(slider.value)
        assert slider.low <= slider.value <= slider.high


def test_sliders_move(panel):
    panel.set(SHARES["legs"], 200)
    assert panel.read().shares["legs"] == 200


def test_the_users_joints_get_sliders(panel, meshcat, robot):
    elbow = robot.joint_index("l_arm_ely")
    panel.show_joints({elbow: 1.0, 3: 0.0})
    assert panel.read().joints == pytest.approx({elbow: 1.0, 3: 0.0})
    panel.show_joints({3: 0.5})
    assert panel.read().joints == pytest.approx({3: 0.0})
    assert "l_arm_ely [rad]" not in meshcat.GetSliderNames()
    panel.show_joints({})
    assert panel.read().joints == {}


def test_overlays_are_switched(panel, meshcat, overlays):
    assert meshcat.GetSliderValue("show com") == 1
    meshcat.SetSliderValue("show com", 0)
    meshcat.SetSliderValue("show owner", 1)
    panel.read()
    assert not overlays.is_on("com")
    assert overlays.is_on("owner")
    # A link has one colour: switching one colouring on ends the other.
    meshcat.SetSliderValue("show effort", 1)
    panel.read()
    assert overlays.is_on("effort")
    assert meshcat.GetSliderValue("show owner") == 0


def test_sticks_point_somewhere():
    assert stick_direction([0.0, 0.0, 0.0, 0.0]) == (0.0, 0.0, 0.0)
    assert stick_direction([0.1, -0.1, 0.1]) == (0.0, 0.0, 0.0)
    assert stick_direction([0.0, -1.0, 0.0]) == (1.0, 0.0, 0.0)
    assert stick_direction([-1.0, 0.0, 0.6]) == (0.0, 1.0, -0.5)
    assert stick_direction([]) == (0.0, 0.0, 0.0)
