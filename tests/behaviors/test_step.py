"""STEP on the simulated robot: both feet, all directions, heights, tilts, cut short."""

import math

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand, Scenario
from atlas_drake.behaviors.step.config import StepRules
from atlas_drake.messages import Behavior, BehaviorStatus, StepStatus, Vector3
from atlas_drake.messages.event import STEPS_LEFT
from atlas_drake.scenario.terrain import Block

LEFT, RIGHT = 0, 1
LONGEST = 9.0
"""No step of this file takes as long [s]."""
LANDING_ERROR = 0.02
"""Farthest that a step within reach may land from where it was sent [m]."""
STANDING = {LEFT: (0.016, 0.14), RIGHT: (0.016, -0.14)}
"""Where the feet are when the robot starts at the origin [m]."""


def in_stand(report):
    return report.current_behavior is Behavior.STAND


def flags(report):
    return report.step_feedback.status_flags


def waiting(index):
    """Whether this step is done and the robot waits for the next one."""

    def look(report):
        step = report.step_feedback
        done = step.current_step_index == index and step.t_step_rem == 0.0
        return done and step.status_flags == StepStatus.SUBSTATE_SWAYING

    return look


def in_air(report):
    return flags(report) == StepStatus.SUBSTATE_STEPPING


class Stepping:
    """A recording of a robot that is told step by step."""

    def __init__(self, record, scenario):
        self.recording = record(scenario)
        self.sim = self.recording.sim
        self.index = 0

    def send(self, foot, x, y, z=0.0, yaw=0.0, normal=(0.0, 0.0, 1.0), **action):
        """Asks for the next step."""
        command = AtlasSimInterfaceCommand(behavior="STEP")
        command.step_params.use_spec = True
        self.index += 1
        spec = command.step_params.desired_step_spec
        spec.step_index, spec.foot_index = self.index, foot
        spec.foot.position, spec.foot.yaw = Vector3(x, y, z), yaw
        spec.foot.normal = Vector3.from_array(normal)
        for name, value in action.items():
            setattr(spec.action, name, value)
        self.sim.publish(command)

    def step(self, *args, **kwargs):
        """Asks for the next step and waits until it is done."""
        self.send(*args, **kwargs)
        assert self.recording.advance(LONGEST, waiting(self.index))
        return self.sim.footsteps[-1]

    def assert_done(self):
        """Every step landed in place; upright, and nothing to complain of."""
        sim = self.sim
        assert not sim.has_fallen
        complaints = [e.text for e in sim.events if e.kind in ("warning", STEPS_LEFT)]
        assert complaints == []
        landed = [step["index"] for step in sim.footsteps]
        assert landed == list(range(1, self.index + 1))
        for step in sim.footsteps:
            assert step["error_m"] <= LANDING_ERROR, step
            turned = step["landed"][2] - step["commanded"][2]
            assert abs(math.remainder(turned, 2.0 * math.pi)) < 0.05, step

    def stand(self):
        """Asks for STAND, which comes at once."""
        self.recording.ask("stand")
        self.recording.advance(0.02)
        report = self.report
        assert in_stand(report)
        status = report.behavior_feedback.status_flags
        assert status == BehaviorStatus.TRANSITION_SUCCESS
        self.recording.advance(0.6)
        assert not self.sim.has_fallen

    @property
    def report(self):
        return self.recording.looks[-1].report


@pytest.fixture
def stepping(record):
    """Makes a robot to be told; the coarser physics halves the wait."""
    return lambda **scenario: Stepping(record, Scenario(**scenario))


@pytest.mark.slow
def test_a_step_ahead_is_quasi_static_and_ends_before_stand_takes_over(stepping):
    robot = stepping()
    robot.send(LEFT, 0.2, 0.14)
    assert robot.recording.advance(LONGEST, in_air)
    robot.recording.ask("stand")
    stance = robot.report.foot_pos_est[RIGHT].position
    pelvis = []
    while in_air(robot.report):
        robot.recording.advance(0.02)
        pelvis.append(robot.sim.pelvis_pose.translation()[:2])
    # The body stands over the stance foot and does not fall towards the other.
    assert np.ptp(pelvis, axis=0).max() < 0.03
    assert abs(pelvis[-1][1] - stance.y) < 0.05
    assert len(pelvis) * 0.02 > 1.0
    # Asked to stand, it puts the foot down first.
    report = robot.report
    assert report.current_behavior is Behavior.STEP
    assert report.desired_behavior is Behavior.STAND
    status = report.behavior_feedback.status_flags
    assert status == BehaviorStatus.TRANSITION_IN_PROGRESS
    assert robot.recording.advance(LONGEST, in_stand)
    status = robot.report.behavior_feedback.status_flags
    assert status == BehaviorStatus.TRANSITION_SUCCESS
    robot.assert_done()
    # Over both feet when STAND takes over.
    middle = 0.5 * sum(foot.position.x for foot in robot.report.foot_pos_est)
    assert robot.sim.pelvis_pose.translation()[0] == pytest.approx(middle, abs=0.05)


@pytest.mark.slow
def test_the_robot_steps_with_one_foot_on_a_tilted_block(stepping):
    block = Block(
        size=[0.4, 0.34, 0.2], position=[0.38, 0.13, 0.06], rpy=[0.1, -0.15, 0.0]
    )
    robot = stepping(terrain=[block])
    R_WB = block.X_WT.rotation().matrix()
    robot.step(LEFT, 0.38, 0.13, 0.06, normal=R_WB[:, 2])
    robot.recording.advance(1.0)
    foot = robot.report.foot_pos_est[LEFT].orientation
    z_axis = np.array(
        [
            2.0 * (foot.x * foot.z + foot.w * foot.y),
            2.0 * (foot.y * foot.z - foot.w * foot.x),
            1.0 - 2.0 * (foot.x**2 + foot.y**2),
        ]
    )
    assert z_axis @ R_WB[:, 2] == pytest.approx(1.0, abs=1e-3)
    # The other foot: for its step the robot stands on the slope alone.
    robot.step(RIGHT, 0.2, -0.2)
    robot.assert_done()
    robot.stand()


@pytest.mark.slow
def test_a_foot_that_finds_no_ground_returns_to_lift_off(stepping):
    robot = stepping()
    # It has leant into the step, too.
    robot.send(LEFT, 0.2, 0.14, 0.15, step_end_dist=0.03)
    assert robot.recording.advance(LONGEST, waiting(1))
    (left,) = [e for e in robot.sim.events if e.kind == STEPS_LEFT]
    assert "no ground" in left.text
    assert not robot.sim.has_fallen
    foot = robot.report.foot_pos_est[LEFT].position
    np.testing.assert_allclose([foot.x, foot.y], STANDING[LEFT], atol=LANDING_ERROR)
    # A foot that is back where it was has taken no step.
    assert robot.sim.footsteps == []
    assert not robot.sim.summary()["success"]
    robot.stand()


def test_a_step_is_reported_as_it_is_taken(stepping):
    robot = stepping()
    robot.send(LEFT, 1.0, 0.9, yaw=1.0, max_foot_vel=0.25, lift_height=0.12)
    robot.recording.advance(0.02)
    robot.recording.advance(0.1)
    feedback = robot.report.step_feedback
    assert (feedback.current_step_index, feedback.next_step_index_needed) == (1, 2)
    spec, data = feedback.desired_step_spec_saturated, feedback.desired_step_saturated
    assert (spec.step_index, spec.foot_index) == (1, LEFT)
    # As far as a leg reaches, and no farther.
    stance = robot.report.foot_pos_est[RIGHT].position
    assert 0.2 < spec.foot.position.x - stance.x < 0.5
    assert 0.2 < spec.foot.position.y - stance.y < 0.6
    assert 0.3 < spec.foot.yaw < 0.7
    assert (data.pose.position.x, data.pose.position.y) == (
        spec.foot.position.x,
        spec.foot.position.y,
    )
    assert spec.action.lift_height == 0.12
    # The foot's speed asks for more time than the message does.
    assert spec.action.step_duration > 2.0
    assert data.duration == spec.action.step_duration
    assert data.swing_height >= 0.12
    planned = spec.action.sway_duration + spec.action.step_duration + StepRules.settle
    assert feedback.t_step_rem == pytest.approx(planned - 0.12, abs=0.05)
    # It will land so far from where it was sent.
    (warning,) = [e for e in robot.sim.events if e.kind == "warning"]
    p = spec.foot.position
    away = math.hypot(p.x - 1.0, p.y - 0.9)
    assert f"step 1 is out of reach and ends {away:.2f} m" in warning.text


def test_a_step_out_of_reach_is_refused_and_the_next_one_taken(stepping):
    robot = stepping(model="atlas_v3")
    # Too far down for its place, and too far up for any leg.
    for x, z in ((-0.25, -0.15), (0.2, 0.22)):
        robot.index = 0
        robot.send(LEFT, x, 0.13, z)
        robot.recording.advance(0.04)
        left = [e for e in robot.sim.events if e.kind == STEPS_LEFT]
        assert "step 1 is not taken: it is out of reach" in left[-1].text
        assert robot.report.step_feedback.current_step_index == 0
    assert len(left) == 2
    robot.index = 0
    robot.send(LEFT, 0.1, 0.13)
    robot.recording.advance(0.06)
    assert robot.report.step_feedback.current_step_index == 1
