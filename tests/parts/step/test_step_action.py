"""Steps that STEP reads from messages: thresholds, defaults, bounds, both forms."""

import math

import numpy as np
import pytest

from atlas_drake.messages import (
    AtlasBehaviorStepAction,
    AtlasBehaviorStepParams,
    Vector3,
)
from atlas_drake.messages.footstep import FootPose, StepAction
from atlas_drake.parts.step.action import (
    SIDE_BY_SIDE,
    ActionRules,
    demo_step,
    desired_step,
    resolve_action,
    step_spec_from,
)
from atlas_drake.planning.demo_steps import DEMO_STEPS
from atlas_drake.planning.footholds import Gait
from atlas_drake.rotations import rotation_z

DEFAULT, RULES = StepAction(knee_nominal=0.72), ActionRules()
LEVEL = (0.0, 0.0)


def resolved(**fields):
    action = AtlasBehaviorStepAction()
    for name, value in fields.items():
        setattr(action, name, value)
    return resolve_action(action, DEFAULT, RULES)


@pytest.mark.parametrize(
    ("name", "ignored", "used"),
    [
        ("step_duration", 0.0, 1.5),
        ("sway_duration", 0.19, 0.2),
        ("swing_height", 0.09, 0.1),
        ("lift_height", 0.09, 0.1),
        ("knee_nominal", 0.29, 0.3),
        ("max_body_accel", 0.0, 0.2),
        ("max_foot_vel", 0.0, 0.3),
    ],
)
def test_a_value_below_its_threshold_is_ignored(name, ignored, used):
    assert getattr(resolved(**{name: ignored}), name) == getattr(DEFAULT, name)
    assert getattr(resolved(**{name: used}), name) == used


@pytest.mark.parametrize("name", ["sway_end_dist", "step_end_dist"])
def test_end_distances_count_within_five_centimetres(name):
    for value in (0.02, 0.0, -0.02):
        assert getattr(resolved(**{name: value}), name) == value
    for value in (0.051, -0.06, 0.1):
        assert getattr(resolved(**{name: value}), name) == getattr(DEFAULT, name)
    # The sole has not room for all of that.
    largest = getattr(RULES.most, name)
    assert getattr(resolved(**{name: 0.05}), name) == largest
    assert getattr(resolved(**{name: -0.05}), name) == -largest


def test_values_above_their_maximum_are_clamped():
    largest = {
        "step_duration": 20.0,
        "sway_duration": 20.0,
        "swing_height": 0.20,
        "lift_height": 0.25,
        "knee_nominal": 1.0,
        "max_body_accel": 1.0,
        "max_foot_vel": 1.0,
    }
    desired = resolved(**dict.fromkeys(largest, 90.0))
    assert {name: getattr(desired, name) for name in largest} == largest


def params(use_spec=True, **fields):
    message = AtlasBehaviorStepParams()
    message.use_spec = use_spec
    step = message.desired_step_spec if use_spec else message.desired_step
    step.step_index, step.foot_index = 4, 1
    for name, value in fields.items():
        setattr(message, name, value)
    return message


def test_without_a_step_there_is_none():
    assert desired_step(AtlasBehaviorStepParams(), LEVEL, DEFAULT, RULES) is None
    # The form that is not in use does not count.
    assert desired_step(params(use_spec=False), LEVEL, DEFAULT, RULES) is not None
    message = params(use_spec=False)
    message.use_spec = True
    assert desired_step(message, LEVEL, DEFAULT, RULES) is None


def test_the_full_form():
    message = params()
    spec = message.desired_step_spec
    spec.foot.position = Vector3(0.3, -0.1, 0.2)
    spec.foot.yaw = 0.4
    spec.foot.normal = Vector3(0.0, 1.2, 1.6)
    spec.action.lift_height = 0.15
    desired = desired_step(message, LEVEL, DEFAULT, RULES)
    assert (desired.index, desired.foot, desired.yaw) == (4, 1, 0.4)
    np.testing.assert_allclose(desired.p_WF, [0.3, -0.1, 0.2])
    np.testing.assert_allclose(desired.normal, [0.0, 0.6, 0.8])
    assert desired.action.lift_height == 0.15
    # And back.
    again = step_spec_from(desired)
    assert (again.foot.position, again.foot.yaw) == (spec.foot.position, 0.4)
    apex = desired.action.lift_height + desired.action.swing_height
    assert desired.swing_height == pytest.approx(apex)
    assert again.action.lift_height == 0.15
    assert (again.step_index, again.foot_index) == (4, 1)


@pytest.mark.parametrize("use_spec", [True, False])
def test_height_may_be_relative_to_the_stance_foot(use_spec):
    message = params(use_spec, use_relative_step_height=True)
    z = 0.1
    if use_spec:
        message.desired_step_spec.foot.position.z = z
    else:
        message.desired_step.pose.position.z = z
        message.desired_step.duration = 1.0
    # The right foot steps, so that the left one, at 0.3 m, counts.
    desired = desired_step(message, (0.3, -0.7), DEFAULT, RULES)
    assert desired.p_WF[2] == pytest.approx(0.4)


def test_the_plain_form_counts_its_apex_from_between_the_footholds():
    message = params(use_spec=False)
    step = message.desired_step
    step.duration, step.swing_height = 1.2, 0.3
    step.pose.position.z = 0.1
    step.pose.orientation.y = math.sin(0.05)
    step.pose.orientation.w = math.cos(0.05)
    desired = desired_step(message, LEVEL, DEFAULT, RULES)
    assert desired.action.step_duration == 1.2
    apex = 0.1 + desired.action.lift_height + desired.action.swing_height
    assert apex == pytest.approx(0.05 + 0.3)
    # The orientation's z axis is the ground's normal.
    np.testing.assert_allclose(
        desired.normal, [math.sin(0.1), 0.0, math.cos(0.1)], atol=1e-12
    )
    step.swing_height = 0.01
    low = desired_step(message, LEVEL, DEFAULT, RULES)
    assert low.action.swing_height == DEFAULT.swing_height


def stance(ahead, yaw=0.0):
    """Feet of which the right one is ``ahead`` [m] of the left one."""
    R_WF = rotation_z(yaw)
    left = np.array([1.0, -2.0, 0.0])
    right = left + R_WF @ np.array([ahead, -0.25, 0.0])
    return FootPose(left, R_WF), FootPose(right, R_WF)


@pytest.mark.parametrize("yaw", [0.0, 2.0])
@pytest.mark.parametrize(
    ("ahead", "foot"),
    [
        (-1.0, 1),
        (-1.05 * SIDE_BY_SIDE, 1),
        (-0.95 * SIDE_BY_SIDE, 0),
        (0.0, 0),
        (1.05 * SIDE_BY_SIDE, 0),
        (1.0, 0),
    ],
)
def test_a_demonstration_steps_with_the_foot_that_is_behind(ahead, yaw, foot):
    gait = Gait()
    feet = stance(ahead * gait.stride, yaw)
    desired = demo_step(feet, 3, DEFAULT, gait)
    assert (desired.index, desired.foot) == (3, foot)
    assert desired.duration == DEFAULT.step_duration
    apex = DEFAULT.lift_height + DEFAULT.swing_height
    assert desired.swing_height == pytest.approx(apex)
    assert desired.action == DEFAULT
    forward = rotation_z(yaw)[:, 0]
    assert forward @ (desired.p_WF - feet[1 - foot].p_WF) > 0.05


def test_a_demonstration_comes_to_an_end():
    assert demo_step(stance(0.0), DEMO_STEPS, DEFAULT, Gait()) is not None
    assert demo_step(stance(0.0), DEMO_STEPS + 1, DEFAULT, Gait()) is None


@pytest.mark.parametrize("foot", [0, 1])
def test_the_plain_form_counts_a_relative_height_from_the_stance_foot(foot):
    message = params(use_spec=False, use_relative_step_height=True)
    step = message.desired_step
    step.foot_index, step.duration, step.swing_height = foot, 1.0, 0.3
    # The foot comes from 0.2 m, and goes to 0.06 m.
    feet_z = (0.2, 0.05) if foot == 0 else (0.05, 0.2)
    step.pose.position.z = 0.01
    action = desired_step(message, feet_z, DEFAULT, RULES).action
    rise = action.lift_height + action.swing_height
    assert rise == pytest.approx(0.3 - 0.5 * (0.2 - 0.06))
