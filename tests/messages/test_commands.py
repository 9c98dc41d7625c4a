"""The commands in force: merged by field, refused as a whole, the later one wins."""

import dataclasses
import logging

import numpy as np
import pytest

from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import NOTHING
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
    Header,
    accept,
)
from atlas_drake.messages.commands import (
    KEPT,
    apply,
    commands_at_start,
    log_refusals,
    merge_ports,
)
from atlas_drake.messages.event import MESSAGE, REFUSAL
from atlas_drake.messages.joint_command import JOINT_FIELDS
from atlas_drake.robot import load_robot

ROBOT = load_robot()
START = commands_at_start(ROBOT, Behavior.STAND)
ARRAYS = [
    (kind, name)
    for kind in (AtlasCommand, AtlasSimInterfaceCommand)
    for name in JOINT_FIELDS
    if hasattr(kind, name)
]


def everything():
    """A joint command with all arrays, each with numbers of its own, within bounds."""
    command = AtlasCommand()
    for number, name in enumerate(JOINT_FIELDS):
        setattr(command, name, [number + 0.01 * j for j in range(28)])
    command.k_effort = list(range(28))
    return command


def sent(force, *messages, time=1.0):
    """What is in force after these messages, sent at one time to their ports."""
    ports = [NOTHING, NOTHING]
    for message in messages:
        is_sim = isinstance(message, AtlasSimInterfaceCommand)
        ports[is_sim] = dataclasses.replace(message).freeze()
    return merge_ports(force, ports, ROBOT, time)


def assert_in_force(force, command):
    for name in JOINT_FIELDS:
        np.testing.assert_array_equal(
            getattr(force.joints, name), getattr(command, name), err_msg=name
        )


def assert_only_the_error_is_new(after, before):
    """Everything that acts on the robot is as it was."""
    assert after.joints is before.joints
    assert after.request is before.request
    stamps = after.atlas_stamp, after.sim_stamp
    assert stamps == (before.atlas_stamp, before.sim_stamp)


@pytest.mark.parametrize("behavior", Behavior)
def test_at_start_the_stand_prep_pose_and_default_gains_are_in_force(behavior):
    start = commands_at_start(ROBOT, behavior)
    expected = dict.fromkeys(JOINT_FIELDS, np.zeros(28))
    expected |= {"position": ROBOT.stand_prep, "kp_position": ROBOT.default_kp}
    users = behavior in (Behavior.USER, Behavior.NONE)
    expected |= {"kd_position": ROBOT.default_kd, "k_effort": np.full(28, 255 * users)}
    for name, values in expected.items():
        np.testing.assert_array_equal(getattr(start.joints, name), values)
    assert (start.request.behavior, start.request.number) == (behavior, 0)
    assert start.error_code is ErrorCode.NO_ERRORS


@pytest.mark.parametrize("kind", [AtlasCommand, AtlasSimInterfaceCommand])
def test_velocity_gains_come_into_force_within_their_bound(kind):
    bound = 50.0 * ROBOT.effort_limit / ROBOT.velocity_limit
    odd = np.arange(28) % 2
    after = sent(START, kind(kp_velocity=np.where(odd, 1e6, 0.9 * bound)))
    expected = np.where(odd, bound, 0.9 * bound)
    np.testing.assert_allclose(after.joints.kp_velocity, expected)


@pytest.mark.parametrize(("kind", "field"), ARRAYS)
def test_an_array_comes_into_force_leaves_the_others_and_the_later_one_wins(
    kind, field
):
    before = sent(START, everything())
    assert_in_force(before, everything())
    # Between the integral bounds in force, so that it may be either of them.
    values = np.full(28, 7.5) if field.startswith("i_effort") else np.full(28, 7.0)
    after = sent(before, kind(**{field: values}))
    assert after.error_code is ErrorCode.NO_ERRORS
    assert after.request.number == (2 if kind is AtlasSimInterfaceCommand else 0)
    expected = everything()
    setattr(expected, field, values.copy())
    values[:] = 9.0  # The sender's array is not the one in force.
    assert_in_force(after, expected)
    assert_in_force(sent(after, everything()), everything())


@pytest.mark.parametrize("field", JOINT_FIELDS)
def test_a_bad_array_refuses_the_whole_command(field):
    before = sent(START, everything())
    command = everything()
    command.position = [0.5] * 28  # Good, and yet it must not be applied.
    setattr(command, field, [1.0] * 27)
    after = sent(before, command, time=4.0)
    assert_only_the_error_is_new(after, before)
    assert after.error_code is ErrorCode.VALUE_OUT_OF_RANGE
    assert (after.received, after.refused) == (2, 1)
    refusal = after.events[-1]
    assert (refusal.kind, refusal.time) == (REFUSAL, 4.0)
    assert field in refusal.text
    assert refusal.data == {"number": 2, "command": "AtlasCommand", "field": field}


def test_integral_bounds_must_not_cross_those_in_force():
    before = sent(
        START, AtlasCommand(i_effort_min=[-2.0] * 28, i_effort_max=[3.0] * 28)
    )
    for field, value in (("i_effort_min", 3.5), ("i_effort_max", -2.5)):
        values = [0.0] * 28
        values[5] = value
        after = sent(before, AtlasCommand(**{field: values}))
        assert_only_the_error_is_new(after, before)
        # The message is told of its own field and of the joint.
        assert f"{field}[5]" in after.events[-1].text
        assert ROBOT.joint_names[5] in after.events[-1].text
    both = AtlasCommand(i_effort_min=[4.0] * 28, i_effort_max=[5.0] * 28)
    assert sent(before, both).error_code is ErrorCode.NO_ERRORS


@pytest.mark.parametrize("shares", [[], [0] * 28])
def test_user_gives_every_joint_to_the_user_with_any_k_effort(shares):
    after = sent(START, AtlasSimInterfaceCommand(behavior="USER", k_effort=shares))
    np.testing.assert_array_equal(after.k_effort, np.full(28, 255.0))


def test_at_one_instant_the_behavior_command_is_the_later_one():
    atlas = AtlasCommand(k_effort=[7] * 28)
    sim = AtlasSimInterfaceCommand(k_effort=[9] * 28)
    after = sent(START, sim, atlas, time=2.0)
    np.testing.assert_array_equal(after.k_effort, np.full(28, 9.0))


def test_one_refused_message_does_not_take_the_other_with_it():
    bad, good = AtlasCommand(position=[0.0]), AtlasSimInterfaceCommand(behavior="WALK")
    once = merge_ports(START, [bad, good], ROBOT, 1.0)
    assert once.request.behavior is Behavior.WALK
    assert once.joints is START.joints
    assert (once.refused, once.received, once.request.number) == (1, 2, 2)
    # Neither is new while it stays, and a message that leaves its port stays in force.
    assert merge_ports(once, [bad, good], ROBOT, 2.0) is once
    assert merge_ports(once, [NOTHING, NOTHING], ROBOT, 2.0) is once


def test_an_equal_message_is_new_only_with_another_stamp_or_if_sent_again():
    def walk(stamp=0.0, gain=(0.0,) * 28):
        header = Header(stamp)
        return AtlasSimInterfaceCommand(header, behavior="WALK", kp_position=gain)

    again, force = walk().freeze(), START
    for message, number in (
        (walk(), 1),
        (walk(gain=[0] * 28), 1),
        (walk(gain=np.zeros(28)), 1),
        (again, 2),
        (again, 2),
        (walk(), 2),
        (walk().freeze(), 3),
        (walk(stamp=1.5), 4),
        (walk(stamp=1.5), 4),
    ):
        force = merge_ports(force, [NOTHING, message], ROBOT, 1.0)
        assert force.request.number == force.received == number
    assert force.requests[1].command == force.requests[2].command


def test_a_message_passed_directly_is_always_new():
    message = AtlasSimInterfaceCommand(behavior="WALK")
    force = merge_ports(START, [NOTHING, message], ROBOT, 1.0)
    force, refusal = apply(force, accept(message, ROBOT), ROBOT, 1.0)
    assert refusal is None
    assert [request.number for request in force.requests] == [0, 1, 2]
    # What is on the port has been received already, and so counts no second time.
    assert merge_ports(force, [NOTHING, message], ROBOT, 1.0) is force
    outcome = accept(AtlasCommand(k_effort=[300]), ROBOT)
    refused, refusal = apply(force, outcome, ROBOT, 2.0)
    assert refusal == outcome
    assert (refused.received, refused.refused) == (3, 1)


def test_a_message_that_changes_on_its_port_is_new():
    command = AtlasCommand(position=[0.0] * 28)
    force = merge_ports(START, [command, NOTHING], ROBOT, 1.0)
    command.position[3] = 0.5
    force = merge_ports(force, [command, NOTHING], ROBOT, 2.0)
    assert force.received == 2
    assert force.joints.position[3] == 0.5
    assert force.events[0].data["message"].position[3] == 0.0


def test_time_must_not_run_backward_for_either_kind():
    # The two kinds have clocks of their own, and a message without stamp is sent now.
    force = sent(START, AtlasCommand(Header(3.0)), time=1.0)
    force = sent(force, AtlasCommand(), time=5.0)
    force = sent(force, AtlasSimInterfaceCommand(Header(4.0), behavior="STAND"))
    assert force.error_code is ErrorCode.NO_ERRORS
    for message in (
        AtlasCommand(Header(4.9), position=[0.0] * 28),
        AtlasSimInterfaceCommand(Header(3.9), behavior="WALK"),
    ):
        # The door knows nothing of the time; what is in force refuses the message.
        late, refusal = apply(force, accept(message, ROBOT), ROBOT, 1.0)
        assert_only_the_error_is_new(late, force)
        assert late.error_code is refusal.error_code is ErrorCode.TIME_RAN_BACKWARD
        assert refusal.field == "header.stamp"
    equal = AtlasCommand(Header(5.0))
    assert sent(force, equal).error_code is ErrorCode.NO_ERRORS


def test_each_message_is_an_event_and_a_good_one_clears_the_error_alone():
    bad, good = AtlasCommand(position=[0.0]), AtlasCommand(position=[0.1] * 28)
    stand = AtlasSimInterfaceCommand(behavior="STAND")
    force = sent(START, bad)
    assert force.error_code is not ErrorCode.NO_ERRORS
    force = sent(sent(force, good), stand, time=2.0)
    assert force.error_code is ErrorCode.NO_ERRORS
    assert (force.received, force.refused) == (3, 1)
    told = [(event.kind, event.time, event.data["number"]) for event in force.events]
    assert told == [(REFUSAL, 1.0, 1), (MESSAGE, 1.0, 2), (MESSAGE, 2.0, 3)]
    kept = [event.data.get("message") for event in force.events]
    assert kept == [None, accept(good, ROBOT).message, accept(stand, ROBOT).message]


@pytest.mark.slow
def test_entries_of_the_last_moments_are_all_kept_and_older_ones_dropped():
    force = START
    for number in range(6 * KEPT):
        behavior = "WALLK" if number % 2 else "STAND"
        force = sent(force, AtlasSimInterfaceCommand(behavior=behavior))
    assert force.received == len(force.events) == 6 * KEPT
    assert force.refused == 3 * KEPT
    assert len(force.requests) >= 3 * KEPT
    later = sent(force, AtlasSimInterfaceCommand(behavior="STAND"), time=2.0)
    for entries in (later.events, later.requests):
        assert len(entries) == KEPT
        assert entries[-1].time == 2.0


def test_each_fault_is_logged_at_intervals_and_again_when_time_went_back(caplog):
    force = START
    times = ((5.0, 2), (5.5, 0), (6.0, 0), (7.0, 2), (0.5, 2), (0.5, 0))
    for count, (time, heard) in enumerate(times, 1):
        caplog.clear()
        before = force
        # The values may change: a fault is one of a field.
        gain, velocity = [-1.0 * count] * 28, [0.0] * count
        for fault in (AtlasCommand(kp_velocity=gain), AtlasCommand(velocity=velocity)):
            force, _ = apply(force, accept(fault, ROBOT), ROBOT, time)
        log_refusals(before, force)
        assert [record.levelno for record in caplog.records] == heard * [
            logging.WARNING
        ], time
