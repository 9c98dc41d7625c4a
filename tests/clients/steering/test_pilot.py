"""A robot that is steered by hand does what people expect, also by late reports."""

from collections import deque

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Behavior, InvalidMessageError, Scenario
from atlas_drake.clients.steering.joint_motion import DAMPING, SPEED, JointFacts
from atlas_drake.clients.steering.pilot import Pilot, pilot_of, reports_of
from atlas_drake.clients.steering.reports import Reports
from atlas_drake.clients.steering.walker import PATIENCE, Walker
from atlas_drake.messages import BehaviorStatus
from atlas_drake.messages.commands import commands_at_start
from atlas_drake.planning.footholds import Gait
from atlas_drake.robot import load_robot

ACTS_WITHIN = 0.1
"""Simulated time from a click until the controller has heard it [s]."""
LOOK = 0.02
"""Simulated time between two calls of a pilot [s]."""


@pytest.fixture(scope="module")
def shared():
    return AtlasSimulation()


@pytest.fixture
def sim(shared):
    shared.reset(seed=0)
    shared.hooks.clear()
    return shared


@pytest.fixture
def pilot(sim):
    return pilot_of(sim)


def joints_of(sim):
    return sim.output("commands").joints


class Late:
    """A pilot that sees the robot ten times a second, 0.1 s late."""

    def __init__(self, sim):
        gait = sim.scenario.controller_config().gait()
        facts = JointFacts.of(sim.robot)
        self.pilot = Pilot(facts, gait, sim.publish, reports_of(sim))
        self.frames, self.ticks = deque(maxlen=2), 0
        self.attend(sim)
        sim.hooks.append(self.attend)

    def attend(self, sim):
        if self.ticks % 5 == 0:
            self.frames.append(reports_of(sim))
            self.pilot.see(self.frames[0])
        self.ticks += 1
        self.pilot.update(LOOK)


@pytest.mark.parametrize(
    ("control", "values"),
    [
        ("walk", {"forward": float("nan")}),
        ("walk", {"forward": 1e6}),
        ("gait", {"stride": -5.0}),
        ("gait", {"limits": 1.0}),
        ("plan_to", {"x": "far", "y": 0.0}),
        ("plan_to", {"x": 1e9, "y": 0.0}),
        ("move_step", {"index": 1, "x": 0.0, "y": 0.0}),
        ("send_plan", {}),
        ("share", {"joints": ["nose"], "k_effort": 1}),
        ("behave", {"name": "FLY"}),
    ],
)
def test_what_cannot_be_used_is_refused_and_changes_nothing(
    sim, pilot, control, values
):
    with pytest.raises(InvalidMessageError):
        getattr(pilot, control)(**values)
    sim.advance(0.04)
    assert sim.commands == []
    assert sim.current_behavior is Behavior.STAND


# ---- walking -----------------------------------------------------------------


def test_walking_begins_within_a_tenth_of_a_second(sim, pilot):
    pilot.walk(forward=1.0)
    sim.advance(ACTS_WITHIN)
    assert sim.current_behavior is Behavior.WALK
    assert pilot.direction == (1.0, 0.0, 0.0)


@pytest.mark.slow
def test_a_walk_waits_until_the_robot_stands(sim, pilot):
    pilot.behave("manipulate")
    sim.advance(0.1)
    assert sim.current_behavior is Behavior.MANIPULATE
    pilot.walk(forward=1.0)
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.WALK, 3.0)


@pytest.mark.slow
def test_a_walk_that_was_sent_and_is_not_seen_yet_is_stopped(sim):
    pilot = Late(sim).pilot
    pilot.walk(forward=1.0)
    pilot.update(LOOK)
    pilot.stop()
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.WALK, 0.1)
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.STAND, 4.0)
    assert len(sim.footsteps) <= 2  # And not the four that were sent.


def test_stop_gives_the_legs_back_and_leaves_the_arms(sim):
    pilot = Late(sim).pilot
    pilot.share(sim.robot.joint_names, 255)
    sim.advance(0.2)
    pilot.stop()
    sim.advance(0.3)
    legs = sim.robot.limb("l_leg", "r_leg")
    shares = np.array(sim.atlas_state.k_effort)
    assert not shares[legs].any()
    assert (shares[~legs] == 255).all()
    assert sim.current_behavior is Behavior.STAND
    assert not sim.has_fallen


def test_a_plan_that_was_sent_and_is_not_seen_yet_is_stopped(sim):
    pilot = Late(sim).pilot
    pilot.plan_to(2.0, 0.0)
    pilot.send_plan()
    pilot.update(LOOK)
    pilot.stop()
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.WALK, 0.1)
    sim.advance(0.1)
    assert sim.atlas_sim_interface_state.desired_behavior == Behavior.STAND


@pytest.mark.slow
def test_a_robot_is_steered_by_late_reports_and_stops_with_its_feet_side_by_side():
    sim = AtlasSimulation()
    pilot = Late(sim).pilot
    pilot.walk(forward=1.0)
    sim.advance(3.0)
    pilot.walk(forward=1.0, turn=1.0)
    sim.advance(2.0)
    pilot.stop()
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.STAND, 4.0)
    assert pilot.direction is None
    assert not [one for one in sim.events if one.kind in ("refusal", "steps left")]
    assert sim.pelvis_pose.translation()[0] > 0.8
    # A command for each step, as each needs one more to follow; few besides.
    assert len(sim.commands) < 3 * len(sim.footsteps)


@pytest.mark.slow
def test_a_plan_of_many_steps_is_walked_by_late_reports():
    sim = AtlasSimulation()
    pilot = Late(sim).pilot
    count = pilot.plan_to(0.8, 0.2)
    pilot.send_plan()
    sim.advance(1.0)
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.STAND, 12.0)
    assert len(sim.footsteps) == count > 4
    assert sim.pelvis_pose.translation()[:2] == pytest.approx([0.8, 0.2], abs=0.1)


def test_a_plan_keeps_the_height_of_the_ground():
    sim = AtlasSimulation(Scenario(world="qual_task_1"))
    pilot = pilot_of(sim)
    pilot.plan_to(0.5, 0.0)
    _, x, y, _ = pilot.plan_marks[0]
    pilot.move_step(1, x + 0.02, y)
    assert pilot.plan_marks[0][1] == pytest.approx(x + 0.02)
    pilot.send_plan()
    assert pilot.plan_marks == ()
    sim.advance(0.2)
    assert sim.current_behavior is Behavior.WALK
    (command,) = sim.commands
    queue = command.message.walk_params.step_queue
    assert [step.pose.position.z for step in queue] == pytest.approx(
        [1.0] * 4, abs=0.01
    )


def test_a_dropped_plan_is_not_sent(pilot):
    pilot.plan_to(1.0, 0.0, 0.0)
    pilot.drop_plan()
    with pytest.raises(InvalidMessageError):
        pilot.send_plan()


class Walk:
    """A walker, and what it sent last."""

    def __init__(self, report):
        self.sent = []
        self.walker = Walker(Gait(), self.sent.append, report)

    def next_command(self, report):
        self.sent.clear()
        self.walker.see_report(report)
        self.walker.walk_on()
        return self.sent[-1].behavior if self.sent else None


@pytest.fixture
def walk(standing):
    return Walk(standing)


def test_a_plan_waits_for_the_end_of_a_walk(walk, standing):
    assert walk.walker.plan_to(1.0, 0.0) > 4
    standing.current_behavior = standing.desired_behavior = Behavior.WALK
    walk.walker.send_plan()
    assert walk.sent[-1].behavior == Behavior.STAND
    assert walk.next_command(standing) is None
    standing.current_behavior = standing.desired_behavior = Behavior.STAND
    assert walk.next_command(standing) == Behavior.WALK


def test_a_walk_that_is_refused_or_ended_begins_on_request_alone(walk, standing):
    walk.walker.walk(forward=1.0)
    assert walk.next_command(standing) is not None
    standing.header.stamp = PATIENCE + 0.1
    assert walk.next_command(standing) is None
    assert walk.walker.direction is None
    walk.walker.walk(forward=1.0)
    standing.current_behavior = Behavior.WALK
    walk.next_command(standing)
    standing.current_behavior = Behavior.STAND
    assert walk.next_command(standing) is None
    assert walk.walker.direction is None


def test_a_fall_ends_a_walk(walk, standing):
    walk.walker.walk(forward=1.0)
    standing.behavior_feedback.status_flags = BehaviorStatus.ERROR_FALLING
    assert walk.next_command(standing) is None
    assert walk.walker.direction is None


def test_small_shares_of_a_direction_are_rounded(walk):
    walk.walker.walk(forward=0.93, left=-0.19, turn=-0.4)
    assert walk.walker.direction == (1.0, 0.0, -0.5)


def test_the_nearest_gait_that_can_be_walked_holds(pilot):
    in_force = pilot.gait(stride=30.0)
    assert in_force == pilot.gait_in_force
    assert in_force["stride"] < 1.0


# ---- behaviors ---------------------------------------------------------------


def test_walk_begins_on_the_spot_and_steps_alternate(standing):
    sent = []
    robot = load_robot("atlas")
    joints = commands_at_start(robot, Behavior.STAND).joints
    reports = Reports(standing, joints, robot.stand_prep)
    pilot = Pilot(JointFacts.of(robot), Gait(), sent.append, reports)
    pilot.behave("walk")
    pilot.update(LOOK)
    (walk,) = sent
    assert {step.pose.position.x for step in walk.walk_params.step_queue} == {0.0}
    pilot.behave("STEP")
    pilot.behave(Behavior.STEP)
    one, other = (command.step_params.desired_step for command in sent[1:])
    assert {one.foot_index, other.foot_index} == {0, 1}
    assert one.pose.position.x > 0.1
    assert pilot.direction is None


def test_user_takes_all_joints_and_the_next_behavior_gives_back(sim, pilot):
    pilot.share(["l_arm_ely"], 100)
    sim.advance(0.02)
    before = sim.atlas_state.position
    pilot.behave("USER")
    sim.advance(0.04)
    joints = joints_of(sim)
    assert set(joints.k_effort) == {255}
    assert (joints.kp_velocity >= DAMPING).all()
    # The robot still sets its feet down.
    np.testing.assert_allclose(joints.position, before, atol=0.02)
    pilot.behave("FREEZE")
    sim.advance(0.04)
    assert joints_of(sim).k_effort.sum() == 100


@pytest.mark.parametrize("make", [pilot_of, lambda sim: Late(sim).pilot])
def test_behaviors_at_once_after_one_another_give_back_what_was_before(sim, make):
    pilot = make(sim)
    pilot.share(["l_arm_ely"], 100)
    for name in ("USER", "USER", "FREEZE", "STAND"):
        pilot.behave(name)
    sim.advance(0.3)
    assert joints_of(sim).k_effort.sum() == 100
    assert sim.current_behavior is Behavior.STAND


def test_stop_comes_to_rest(sim, pilot):
    pilot.behave("MANIPULATE")
    sim.advance(0.1)
    pilot.stop()
    sim.advance(0.1)
    assert sim.atlas_sim_interface_state.desired_behavior == Behavior.STAND


# ---- joints, and jumps of time -----------------------------------------------


def test_a_joint_follows_at_a_bounded_speed(sim, pilot):
    elbow = sim.robot.joint_index("l_arm_ely")
    pilot.share(["l_arm_ely"], 255)
    sim.advance(0.2)
    begin = joints_of(sim).position[elbow]
    pilot.move("l_arm_ely", begin - 0.1)
    sim.advance(0.06)
    assert 0.0 < begin - joints_of(sim).position[elbow] <= 0.08 * SPEED + 1e-9
    sim.advance(0.1)
    assert joints_of(sim).position[elbow] == pytest.approx(begin - 0.1)


def test_all_joints_are_held_at_once_by_late_reports(sim):
    pilot = Late(sim).pilot
    pilot.share(sim.robot.joint_names, 255)
    pilot.hold()
    sim.advance(0.02)
    joints = joints_of(sim)
    np.testing.assert_array_equal(joints.kp_position, sim.robot.default_kp)
    assert set(joints.k_effort) == {255.0}


def test_a_pose_is_saved_and_gone_to(sim, pilot):
    pilot.share(["l_arm_ely"], 255)
    pilot.save_pose("here")
    assert "here" in pilot.poses
    elbow = sim.robot.joint_index("l_arm_ely")
    here = sim.atlas_state.position[elbow]
    pilot.move("l_arm_ely", here - 0.05)
    sim.advance(0.1)
    pilot.go_to_pose("here")
    sim.advance(0.1)
    assert joints_of(sim).position[elbow] == pytest.approx(here)


@pytest.mark.parametrize("jump", ["reset", "back"])
def test_a_jump_of_time_forgets_what_went_on(sim, pilot, jump):
    sim.advance(0.02)
    snapshot = sim.snapshot()
    pilot.share(["l_arm_ely"], 255)
    pilot.move("l_arm_ely", 1.0)
    pilot.plan_to(1.0, 0.0)
    pilot.walk(forward=1.0)
    sim.advance(0.04)
    sim.reset() if jump == "reset" else sim.restore(snapshot)
    count = len(sim.commands)
    sim.advance(ACTS_WITHIN)
    assert pilot.direction is None
    assert pilot.plan_marks == ()
    assert len(sim.commands) == count
    assert sim.current_behavior is Behavior.STAND
