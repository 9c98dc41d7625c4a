"""WALK on the simulated robot: substates, steps added, cut short, out of reach."""

import itertools
import math

import numpy as np
import pytest

from atlas_drake.messages import NO_STEP, Behavior, BehaviorStatus, WalkStatus

pytestmark = pytest.mark.slow

SUBSTATES = (
    WalkStatus.SUBSTATE_SWAYING
    | WalkStatus.SUBSTATE_STEPPING
    | WalkStatus.SUBSTATE_CATCHING
)
LONGEST = 12.0
"""No walk of this file takes as long [s]."""
LANDING_ERROR = 0.02
"""Farthest that a step within reach may land from where it was sent [m]."""


def in_stand(report):
    return report.current_behavior is Behavior.STAND


def stepping(index):
    """Whether the robot takes this step."""

    def look(report):
        walk = report.walk_feedback
        return (
            walk.current_step_index == index
            and walk.step_queue_saturated[0].step_index == index
        )

    return look


def changes(recording, value):
    """The values of the reports of one walk, repetitions left out."""
    walking = [
        value(look.report)
        for look in recording.looks
        if look.report.current_behavior is Behavior.WALK
    ]
    return [key for key, _ in itertools.groupby(walking)]


def flags(report):
    return report.walk_feedback.status_flags


def assert_upright(recording):
    assert not recording.sim.has_fallen
    assert recording.sim.summary()["max_pelvis_tilt_rad"] < 0.2


def assert_returned_by_itself(recording):
    report = recording.looks[-1].report
    assert in_stand(report)
    feedback = report.behavior_feedback
    assert feedback.status_flags == BehaviorStatus.WARNING_AUTO_TRANS
    assert (feedback.trans_from, feedback.trans_to) == (Behavior.WALK, Behavior.STAND)
    assert report.desired_behavior is Behavior.STAND
    # The walk's own flags end with it.
    assert flags(report) == WalkStatus.OKAY


@pytest.fixture(scope="module")
def two_steps(record, walk_message):
    """A walk of two steps, from the command to STAND."""
    recording = record()
    recording.sim.publish(walk_message((1, 0, 0.2, 0.14), (2, 1, 0.2, -0.14)))
    recording.advance(LONGEST, in_stand)
    return recording


def test_a_walk_takes_its_steps_and_returns_to_stand_by_itself(two_steps):
    assert_returned_by_itself(two_steps)
    assert_upright(two_steps)
    steps = two_steps.sim.footsteps
    assert [(step["index"], step["foot"]) for step in steps] == [(1, 0), (2, 1)]
    assert all(step["error_m"] <= LANDING_ERROR for step in steps)
    # What is said to have landed is where the feet are.
    for foot, step in enumerate(steps):
        pose = two_steps.looks[-1].report.foot_pos_est[foot].position
        np.testing.assert_allclose([pose.x, pose.y], step["landed"][:2], atol=0.005)
    assert two_steps.sim.summary()["success"]


def test_a_walk_reports_its_phases_and_steps_as_they_come_up(two_steps):
    assert changes(two_steps, flags) == [
        WalkStatus.SUBSTATE_SWAYING,
        WalkStatus.SUBSTATE_STEPPING,
        WalkStatus.SUBSTATE_CATCHING | WalkStatus.WARNING_INSUFFICIENT_STEP_DATA,
    ]
    walk = [
        (
            w.current_step_index,
            [s.step_index for s in w.step_queue_saturated if s.step_index != NO_STEP],
        )
        for w in changes(two_steps, lambda report: report.walk_feedback)
    ]
    assert [key for key, _ in itertools.groupby(walk)] == [
        (0, [1, 2]),
        (1, [1, 2]),
        (1, [2]),
        (2, [2]),
        (2, []),
    ]
    needed = changes(
        two_steps, lambda report: report.walk_feedback.next_step_index_needed
    )
    assert needed == [3]


def test_the_rest_of_a_step_counts_down_to_its_touchdown(two_steps):
    landings = [e.time for e in two_steps.sim.events if e.kind == "footstep"]
    looks = [
        (look.time, look.report.walk_feedback.t_step_rem)
        for look in two_steps.looks
        if look.report.current_behavior is Behavior.WALK
    ]
    # Through the first weight shift, too, and whichever phase the step is in.
    for begin, end in ((-math.inf, landings[0]), tuple(landings)):
        during = [(t, rest) for t, rest in looks if begin + 0.02 < t < end - 0.02]
        assert len(during) > 5
        left = [end - t for t, _ in during]
        np.testing.assert_allclose([rest for _, rest in during], left, atol=0.03)
    assert all(rest == 0.0 for t, rest in looks if t > landings[1] + 0.01)


def test_asked_to_stand_the_robot_finishes_its_step_and_catches(record, walk_message):
    recording = record()
    recording.sim.publish(
        walk_message((1, 0, 0.2, 0.14), (2, 1, 0.4, -0.14), (3, 0, 0.6, 0.14))
    )
    assert recording.advance(LONGEST, stepping(1))
    recording.ask("stand")
    recording.advance(0.06)
    # Another WALK withdraws the request, and sends the steps anew.
    recording.sim.publish(walk_message((2, 1, 0.4, -0.14), (3, 0, 0.6, 0.14)))
    recording.advance(0.06)
    report = recording.looks[-1].report
    assert report.desired_behavior is Behavior.WALK
    status = report.behavior_feedback.status_flags
    assert not status & BehaviorStatus.TRANSITION_IN_PROGRESS
    assert recording.advance(LONGEST, stepping(2))
    recording.ask("stand")
    recording.advance(0.1)
    report = recording.looks[-1].report
    assert report.current_behavior is Behavior.WALK
    assert report.desired_behavior is Behavior.STAND
    status = report.behavior_feedback.status_flags
    assert status == BehaviorStatus.TRANSITION_IN_PROGRESS
    assert flags(report) & SUBSTATES == WalkStatus.SUBSTATE_STEPPING
    assert recording.advance(LONGEST, in_stand)
    status = recording.looks[-1].report.behavior_feedback.status_flags
    assert status == BehaviorStatus.TRANSITION_SUCCESS
    # It was asked to stop: that there are no more steps is no warning.
    assert changes(recording, flags)[-1] == WalkStatus.SUBSTATE_CATCHING
    assert [step["index"] for step in recording.sim.footsteps] == [1, 2]
    assert_upright(recording)


def test_steps_are_added_and_changed_while_walking(record, walk_message):
    recording = record()
    recording.sim.publish(walk_message((1, 0, 0.2, 0.14), (2, 1, 0.4, -0.14)))
    needed = []
    assert recording.advance(LONGEST, stepping(1))
    needed.append(recording.looks[-1].report.walk_feedback.next_step_index_needed)
    # Step 1 has begun and stays what it is; step 2 is changed, 3 and 4 are new.
    recording.sim.publish(
        walk_message(
            (1, 0, 0.1, 0.14), (2, 1, 0.3, -0.14), (3, 0, 0.5, 0.14), (4, 1, 0.5, -0.14)
        )
    )
    recording.advance(0.1)
    needed.append(recording.looks[-1].report.walk_feedback.next_step_index_needed)
    recording.advance(LONGEST, in_stand)
    assert needed == [3, 5]
    assert_upright(recording)
    assert_returned_by_itself(recording)
    steps = recording.sim.footsteps
    assert [step["commanded"][0] for step in steps] == [0.2, 0.3, 0.5, 0.5]
    assert all(step["error_m"] <= LANDING_ERROR for step in steps)
    # No pause for the news.
    times = [e.time for e in recording.sim.events if e.kind == "footstep"]
    np.testing.assert_allclose(np.diff(times), 0.63, atol=0.08)
