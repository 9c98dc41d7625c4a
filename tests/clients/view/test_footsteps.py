"""The drawn footsteps, and the shape of a sole."""

import math

import numpy as np
import pytest

from atlas_drake.clients.view.footsteps import (
    COMMANDED,
    LANDED,
    MARK_LIFT,
    SATURATED,
    FootstepMark,
    footstep_marks,
    mark_solid,
    sole_outline,
)
from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    AtlasSimInterfaceCommand,
    Behavior,
    StepStatus,
    WalkStatus,
)
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import Footstep
from atlas_drake.palette import FEET
from atlas_drake.records.tick_record import KEPT_LANDINGS, landed_among
from atlas_drake.robot import SoleSize


def step(index, x, y=0.1, yaw=0.0, z=0.0):
    data = AtlasBehaviorStepData()
    data.step_index = index
    data.foot_index = (index - 1) % 2
    data.pose.position.x, data.pose.position.y = x, y
    data.pose.position.z = z
    data.pose.orientation.z = math.sin(0.5 * yaw)
    data.pose.orientation.w = math.cos(0.5 * yaw)
    return data


@pytest.fixture
def marks(record_of):
    """Gives the marks of a walk with these steps, as sent and as they are taken."""

    def marks(
        steps, taken=(), *, current=0, landed=(), behavior=Behavior.WALK, walks=True
    ):
        command = AtlasSimInterfaceCommand(behavior=behavior)
        feedback = AtlasBehaviorWalkFeedback(current_step_index=current)
        feedback.status_flags = WalkStatus.SUBSTATE_SWAYING
        for place, data in enumerate(steps):
            command.walk_params.step_queue[place] = data
        for place, data in enumerate(taken or steps):
            feedback.step_queue_saturated[place] = data
        if not walks:
            behavior, feedback = Behavior.STAND, AtlasBehaviorWalkFeedback()
        record = record_of(
            behavior={"current": behavior},
            request=command,
            walk=feedback,
            landed=tuple(landed),
        )
        return footstep_marks(record)

    return marks


def landed(index, commanded, saturated=None, at=None, z=0.0):
    data = {"index": index, "foot": (index - 1) % 2, "commanded": commanded}
    data |= {"landed_height": z, "error_m": 0.0, "error_rad": 0.0}
    data |= {"saturated": saturated or commanded, "landed": at or commanded}
    return Event(1.0, "footstep", f"step {index} landed", data)


@pytest.mark.parametrize("behavior", [Behavior.WALK, Behavior.named(160, "MY_WALK")])
def test_steps_to_come_are_drawn_where_commanded(behavior, marks):
    steps = [step(1, 0.25, yaw=0.2), step(2, 0.5, -0.1)]
    assert marks(steps, behavior=behavior) == [
        FootstepMark(COMMANDED, 0, 0.25, 0.1, 0.2),
        FootstepMark(COMMANDED, 1, 0.5, -0.1, 0.0),
    ]
    # Also a step of an earlier message, and none unless Atlas walks.
    found = marks(steps[1:], taken=steps, behavior=behavior)
    assert {(m.kind, m.foot) for m in found} == {
        (COMMANDED, 0),
        (COMMANDED, 1),
    }
    assert marks(steps, walks=False) == []


def test_a_walk_that_nobody_requested_is_drawn_as_it_is_taken(record_of):
    feedback = AtlasBehaviorWalkFeedback(status_flags=WalkStatus.SUBSTATE_SWAYING)
    feedback.step_queue_saturated[0] = step(1, 0.26)
    (mark,) = footstep_marks(record_of(request=None, walk=feedback))
    assert (mark.kind, mark.x) == (COMMANDED, pytest.approx(0.26))


def test_the_step_of_step_is_drawn_while_it_is_taken(record_of):
    feedback = AtlasBehaviorStepFeedback(
        t_step_rem=0.3, status_flags=StepStatus.SUBSTATE_STEPPING
    )
    feedback.desired_step_saturated = step(2, 0.2, -0.1, z=0.05)
    record = record_of(behavior={"current": Behavior.STEP}, step=feedback)
    assert footstep_marks(record) == [FootstepMark(COMMANDED, 1, 0.2, -0.1, 0.0, 0.05)]
    feedback.t_step_rem = 0.0  # It waits for the next one.
    assert footstep_marks(record) == []


def test_a_step_that_is_not_taken_as_commanded_is_drawn_twice(marks):
    found = marks([step(1, 0.9)], taken=[step(1, 0.42)])
    assert [mark.kind for mark in found] == [COMMANDED, SATURATED]
    assert found[1].x == pytest.approx(0.42, abs=0.005)
    # Unless the correction is small.
    found = marks([step(1, 0.25)], taken=[step(1, 0.255)])
    assert [mark.kind for mark in found] == [COMMANDED]


def test_steps_are_drawn_at_the_height_at_which_they_are_taken(marks):
    # The pelvis' height, as the tutorial sends it, says nothing of the ground.
    found = marks(
        [step(2, 0.5, z=0.9), step(3, 0.9, z=0.9)],
        taken=[step(2, 0.5, z=0.05), step(3, 0.7, z=0.1)],
        current=2,
        landed=[landed(1, [0.25, 0.1, 0.0], z=0.03)],
    )
    assert [(m.kind, m.z) for m in found] == [
        (LANDED, 0.03),
        (COMMANDED, 0.03),
        (COMMANDED, 0.05),
        (COMMANDED, 0.1),
        (SATURATED, 0.1),
    ]


def test_a_landed_step_is_drawn_as_landed_and_where_it_was_commanded(marks):
    event = landed(1, [0.25, 0.1, 0.0], at=[0.26, 0.1, 0.0])
    found = marks([step(1, 0.25), step(2, 0.5)], current=2, landed=[event])
    assert found[:2] == [
        FootstepMark(LANDED, 0, 0.26, 0.1, 0.0),
        FootstepMark(COMMANDED, 0, 0.25, 0.1, 0.0),
    ]
    # Step 1 is over: what is left to come is step 2 alone.
    assert [mark.foot for mark in found[2:]] == [1]


def test_landed_steps_look_the_same_before_and_after_the_walk_ends(marks):
    events = [landed(1, [0.25, 0.1, 0.0], saturated=[0.2, 0.1, 0.0])]
    before = set(marks([step(1, 0.25)], current=2, landed=events))
    assert set(marks([step(1, 0.25)], landed=events, walks=False)) == before
    assert {mark.kind for mark in before} == set(MARK_LIFT)


@pytest.mark.parametrize("behavior", [Behavior.STAND, Behavior.named(100, "MARCH")])
def test_steps_that_a_plan_has_are_drawn_for_any_behavior(behavior, record_of):
    planned = Footstep(1, 1, np.array([0.301, -0.1, 0.1]), 0.2)
    record = record_of(behavior={"current": behavior}, footsteps=(planned,))
    assert footstep_marks(record) == [FootstepMark(COMMANDED, 1, 0.3, -0.1, 0.21, 0.1)]


def test_only_the_latest_landed_steps_are_drawn(marks):
    events = [landed(i, [0.1 * i, 0.1, 0.0]) for i in range(1, KEPT_LANDINGS + 11)]
    other = [Event(0.0, "behavior", "STAND -> WALK")]
    found = marks([], landed=landed_among([*events, *other]))
    shown = [mark.x for mark in found if mark.kind is LANDED]
    assert len(shown) == KEPT_LANDINGS
    assert min(shown) == pytest.approx(1.1)


def test_the_outline_is_the_sole_and_shows_where_the_toes_are():
    x, y, _ = sole_outline(SoleSize(length=0.26, width=0.12))
    extent = (x.min(), x.max(), y.min(), y.max())
    assert extent == pytest.approx((-0.13, 0.13, -0.06, 0.06))
    front, back = (y[np.isclose(x, end)] for end in (0.13, -0.13))
    assert np.ptp(front) < np.ptp(back)
    # Counter-clockwise, so that the sole is seen from above.
    area = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    assert 0.9 * 0.26 * 0.12 < area < 0.26 * 0.12


@pytest.mark.parametrize("kind", MARK_LIFT)
def test_a_mark_lies_level_where_its_sole_is(kind):
    sole = SoleSize(length=0.26, width=0.12)
    solid = mark_solid(FootstepMark(kind, 1, 2.0, 1.0, 0.5 * math.pi, 0.3), sole)
    x, y, z = solid.triangles[0]
    assert np.ptp(z) == pytest.approx(0.0, abs=1e-12)
    assert z[0] == pytest.approx(0.3 + MARK_LIFT[kind])
    # The foot points along y; an outline is drawn along the sole's edge.
    assert (0.5 * (x.min() + x.max()), 0.5 * (y.min() + y.max())) == pytest.approx(
        (2.0, 1.0), abs=0.01
    )
    assert np.ptp(x) == pytest.approx(0.12, abs=0.03)
    assert np.ptp(y) == pytest.approx(0.26, abs=0.03)
    assert solid.color == FEET[1]
    assert (solid.opacity < 1.0) == (kind == LANDED)
