"""Joints moved by hand: what was commanded counts before a report shows it."""

import pickle

import numpy as np
import pytest

from atlas_drake import InvalidMessageError
from atlas_drake.clients.steering.joint_motion import (
    DAMPING,
    SHOWN_WITHIN,
    SPEED,
    STAND_PREP,
    JointFacts,
    JointMotion,
)
from atlas_drake.frozen import replace
from atlas_drake.messages import Behavior
from atlas_drake.messages.commands import commands_at_start
from atlas_drake.robot import load_robot

ELBOW = "l_arm_ely"


@pytest.fixture(scope="module")
def robot():
    return load_robot("atlas")


@pytest.fixture
def at_start(robot):
    return commands_at_start(robot, Behavior.STAND).joints


@pytest.fixture
def position(robot):
    return robot.stand_prep + 0.01


@pytest.fixture
def sent():
    return []


@pytest.fixture
def motion(robot, at_start, position, sent):
    return JointMotion(JointFacts.of(robot), sent.append, at_start, position)


@pytest.fixture
def command_of(sent):
    """Returns the command of a call, if it sends one."""

    def command_of(call, *arguments):
        sent.clear()
        call(*arguments)
        return sent[-1] if sent else None

    return command_of


def applied(command, in_force):
    """The commands in force after a message."""
    given = {
        name: np.array(values, dtype=float)
        for name in ("position", "kp_position", "ki_position", "kp_velocity")
        if (values := getattr(command, name))
    }
    if command.k_effort:
        given["k_effort"] = np.array(command.k_effort, dtype=float)
    return replace(in_force, **given)


def test_the_facts_can_be_sent_to_another_process(robot):
    facts = pickle.loads(pickle.dumps(JointFacts.of(robot)))
    assert facts.joint_names == robot.joint_names
    np.testing.assert_array_equal(facts.default_kp, robot.default_kp)


def test_a_joint_that_is_taken_stays_where_it_is_with_damping(
    robot, motion, at_start, position, command_of
):
    command = command_of(motion.share, [ELBOW], 128)
    elbow = robot.joint_index(ELBOW)
    assert command.k_effort[elbow] == sum(command.k_effort) == 128
    assert command.kp_velocity[elbow] == DAMPING
    assert command.position[elbow] == position[elbow]
    others = np.arange(robot.num_joints) != elbow
    np.testing.assert_array_equal(
        np.array(command.position)[others], at_start.position[others]
    )


def test_what_was_commanded_counts_before_it_shows(
    robot, motion, at_start, position, command_of
):
    motion.share(robot.joint_names, 255)
    command = command_of(motion.hold)
    np.testing.assert_array_equal(command.position, position)
    motion.see_joints(at_start, position)  # A report that was under way.
    assert not np.any(command_of(motion.go_limp).kp_position)
    assert set(motion.shares) == {255.0}


def test_a_command_that_does_not_show_was_refused(motion, at_start, position):
    motion.share([ELBOW], 255)
    for _ in range(SHOWN_WITHIN - 1):
        motion.see_joints(at_start, position)
        assert motion.shares.sum() == 255
    motion.see_joints(at_start, position)
    assert motion.shares.sum() == 0


def test_what_another_one_commanded_counts_once_ones_own_has_shown(
    motion, at_start, position, command_of
):
    shown = applied(command_of(motion.share, [ELBOW], 255), at_start)
    motion.see_joints(shown, position)
    motion.see_joints(at_start, position)
    assert motion.shares.sum() == 0


@pytest.mark.parametrize("lag", [0, 1, 5, 10])
def test_a_set_point_goes_at_a_bounded_speed_however_late_reports_are(
    robot, motion, at_start, position, lag, command_of
):
    """Reports come every 5 updates, ``lag`` updates old."""
    elbow, dt, target = robot.joint_index(ELBOW), 0.02, position[0] - 0.5
    in_force = applied(command_of(motion.share, [ELBOW], 255), at_start)
    target = in_force.position[elbow] - 0.5
    motion.move(ELBOW, target)
    history = [in_force]
    for count in range(100):
        command = command_of(motion.move_on, dt)
        if command is not None:
            before = in_force.position[elbow]
            in_force = applied(command, in_force)
            step = before - in_force.position[elbow]
            assert 0.0 < step <= SPEED * dt + 1e-12
        history.append(in_force)
        if count % 5 == 0:
            motion.see_joints(history[max(len(history) - 1 - lag, 0)], position)
    assert in_force.position[elbow] == target
    assert command_of(motion.move_on, dt) is None


def test_holding_and_going_limp_touch_the_users_joints_alone(
    robot, motion, at_start, command_of
):
    arm = robot.limb("l_arm")
    motion.share([name for name in robot.joint_names if name.startswith("l_arm")], 255)
    limp = command_of(motion.go_limp)
    assert not np.array(limp.kp_position)[arm].any()
    np.testing.assert_array_equal(
        np.array(limp.kp_position)[~arm], at_start.kp_position[~arm]
    )
    np.testing.assert_array_equal(command_of(motion.hold).kp_position, robot.default_kp)


@pytest.mark.parametrize("ends", ["hold", "go_limp", "forget_joints"])
def test_a_motion_ends(motion, ends, command_of):
    motion.share([ELBOW], 255)
    motion.move(ELBOW, 1.0)
    getattr(motion, ends)()
    assert command_of(motion.move_on, 0.02) is None


def test_the_users_joints_go_to_a_saved_pose(
    robot, motion, at_start, position, command_of
):
    motion.share([ELBOW], 255)
    motion.save_pose(" here ")
    assert motion.poses == (STAND_PREP, "here")
    motion.see_joints(applied(command_of(motion.hold), at_start), position + 0.05)
    motion.go_to_pose("here")
    end = command_of(motion.move_on, 10.0).position
    elbow = robot.joint_index(ELBOW)
    assert end[elbow] == position[elbow]
    motion.go_to_pose(STAND_PREP)
    assert command_of(motion.move_on, 10.0).position[elbow] == robot.stand_prep[elbow]


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("share", ([ELBOW], 256)),
        ("share", ([ELBOW], float("nan"))),
        ("share", (["nose"], 1)),
        ("share", (ELBOW, 1)),
        ("share", ([7], 1)),
        ("move", (ELBOW, 40.0)),
        ("move", ("nose", 0.0)),
        ("go_to_pose", ("handstand",)),
        ("save_pose", (" ",)),
        ("save_pose", (41 * "a",)),
    ],
)
def test_what_cannot_be_used_is_refused(motion, name, values, command_of):
    with pytest.raises(InvalidMessageError):
        getattr(motion, name)(*values)
    assert command_of(motion.move_on, 0.02) is None
    assert motion.shares.sum() == 0
