"""The drawn footsteps, and the shape of a sole."""

import math

import numpy as np
import pytest

from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasBehaviorWalkFeedback,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
    WalkStatus,
)
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import Footstep
from atlas_drake.robot import SoleSize
from atlas_drake.visualization.footsteps import (
    KEPT,
    FootstepMark,
    Kind,
    footstep_marks,
    sole_outline,
)


def step(index, x, y=0.1, yaw=0.0, z=0.0):
    data = AtlasBehaviorStepData()
    data.step_index = index
    data.foot_index = (index - 1) % 2
    data.pose.position.x, data.pose.position.y = x, y
    data.pose.position.z = z
    data.pose.orientation.z = math.sin(0.5 * yaw)
    data.pose.orientation.w = math.cos(0.5 * yaw)
    return data


def walking(steps, taken=(), current=0, behavior=Behavior.WALK):
    command = AtlasSimInterfaceCommand()
    command.behavior = behavior
    report = AtlasSimInterfaceState()
    report.current_behavior = behavior
    report.walk_feedback.status_flags = WalkStatus.SUBSTATE_SWAYING
    report.walk_feedback.current_step_index = current
    for place, data in enumerate(steps):
        command.walk_params.step_queue[place] = data
    for place, data in enumerate(taken or steps):
        report.walk_feedback.step_queue_saturated[place] = data
    return BehaviorRequest(behavior, command, 1), report


def leave(report, behavior):
    report.current_behavior = behavior
    report.walk_feedback = AtlasBehaviorWalkFeedback()


def landed(index, commanded, saturated=None, at=None, z=0.0):
    data = {"index": index, "foot": (index - 1) % 2, "commanded": commanded}
    data |= {"landed_height": z, "error_m": 0.0, "error_rad": 0.0}
    data |= {"saturated": saturated or commanded, "landed": at or commanded}
    return Event(1.0, "footstep", f"step {index} landed", data)


@pytest.mark.parametrize("behavior", [Behavior.WALK, Behavior.named(160, "MY_WALK")])
def test_steps_to_come_are_drawn_where_commanded(behavior):
    steps = [step(1, 0.25, yaw=0.2), step(2, 0.5, -0.1)]
    request, report = walking(steps, behavior=behavior)
    assert footstep_marks(request, report, [], Plan()) == [
        FootstepMark(Kind.COMMANDED, 0, 0.25, 0.1, 0.2),
        FootstepMark(Kind.COMMANDED, 1, 0.5, -0.1, 0.0),
    ]
    # Also a step of an earlier message, and none unless Atlas walks.
    request, report = walking(steps[1:], taken=steps, behavior=behavior)
    marks = footstep_marks(request, report, [], Plan())
    assert {(m.kind, m.foot) for m in marks} == {
        (Kind.COMMANDED, 0),
        (Kind.COMMANDED, 1),
    }
    leave(report, Behavior.STAND)
    assert footstep_marks(request, report, [], Plan()) == []


def test_a_step_that_is_not_taken_as_commanded_is_drawn_twice():
    request, report = walking([step(1, 0.9)], taken=[step(1, 0.42)])
    marks = footstep_marks(request, report, [], Plan())
    assert [mark.kind for mark in marks] == [Kind.COMMANDED, Kind.SATURATED]
    assert marks[1].x == pytest.approx(0.42, abs=0.005)
    # Unless the correction is small.
    request, report = walking([step(1, 0.25)], taken=[step(1, 0.255)])
    marks = footstep_marks(request, report, [], Plan())
    assert [mark.kind for mark in marks] == [Kind.COMMANDED]


def test_steps_are_drawn_at_the_height_at_which_they_are_taken():
    # The pelvis' height, as the tutorial sends it, says nothing of the ground.
    request, report = walking(
        [step(2, 0.5, z=0.9), step(3, 0.9, z=0.9)],
        taken=[step(2, 0.5, z=0.05), step(3, 0.7, z=0.1)],
        current=2,
    )
    marks = footstep_marks(
        request, report, [landed(1, [0.25, 0.1, 0.0], z=0.03)], Plan()
    )
    assert [(m.kind, m.z) for m in marks] == [
        (Kind.LANDED, 0.03),
        (Kind.COMMANDED, 0.03),
        (Kind.COMMANDED, 0.05),
        (Kind.COMMANDED, 0.1),
        (Kind.SATURATED, 0.1),
    ]


def test_a_landed_step_is_drawn_as_landed_and_where_it_was_commanded():
    event = landed(1, [0.25, 0.1, 0.0], at=[0.26, 0.1, 0.0])
    request, report = walking([step(1, 0.25), step(2, 0.5)], current=2)
    marks = footstep_marks(request, report, [event], Plan())
    assert marks[:2] == [
        FootstepMark(Kind.LANDED, 0, 0.26, 0.1, 0.0),
        FootstepMark(Kind.COMMANDED, 0, 0.25, 0.1, 0.0),
    ]
    # Step 1 is over: what is left to come is step 2 alone.
    assert [mark.foot for mark in marks[2:]] == [1]


def test_landed_steps_look_the_same_before_and_after_the_walk_ends():
    event = landed(1, [0.25, 0.1, 0.0], saturated=[0.2, 0.1, 0.0])
    request, report = walking([step(1, 0.25)], current=2)
    before = set(footstep_marks(request, report, [event], Plan()))
    leave(report, Behavior.STAND)
    assert set(footstep_marks(request, report, [event], Plan())) == before
    assert {mark.kind for mark in before} == set(Kind)


@pytest.mark.parametrize("behavior", [Behavior.STAND, Behavior.named(100, "MARCH")])
def test_steps_that_a_plan_has_are_drawn_for_any_behavior(behavior):
    request, report = walking([])
    leave(report, behavior)
    plan = Plan(footsteps=(Footstep(1, 1, np.array([0.301, -0.1, 0.1]), 0.2),))
    assert footstep_marks(request, report, [], plan) == [
        FootstepMark(Kind.COMMANDED, 1, 0.3, -0.1, 0.21, 0.1)
    ]


def test_only_the_latest_landed_steps_are_drawn():
    request, report = walking([])
    events = [landed(i, [0.1 * i, 0.1, 0.0]) for i in range(1, KEPT + 11)]
    other = [Event(0.0, "behavior", "STAND -> WALK")]
    marks = footstep_marks(request, report, [*events, *other], Plan())
    shown = [mark.x for mark in marks if mark.kind is Kind.LANDED]
    assert len(shown) == KEPT
    assert min(shown) == pytest.approx(1.1)


def test_the_outline_is_the_sole_and_shows_where_the_toes_are():
    sole = SoleSize(length=0.26, width=0.12)
    outline = sole_outline(sole)
    assert outline[0].max() == pytest.approx(0.13)
    assert outline[0].min() == pytest.approx(-0.13)
    assert np.abs(outline[1]).max() == pytest.approx(0.06)
    assert np.all(outline[2] == 0.0)
    at_front = outline[1][np.isclose(outline[0], 0.13)]
    at_back = outline[1][np.isclose(outline[0], -0.13)]
    assert np.ptp(at_front) < np.ptp(at_back)
    # Counter-clockwise, so that the sole is seen from above.
    x, y = outline[0], outline[1]
    area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    assert 0.9 * 0.26 * 0.12 < area < 0.26 * 0.12
