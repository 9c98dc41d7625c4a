"""The commands in force: merged by field, refused as a whole, the later one wins."""

import copy
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
    ActiveCommand,
    Sent,
    commands_at_start,
    latch,
    log_refusals,
    receive,
)
from atlas_drake.messages.event import MESSAGE, REFUSAL
from atlas_drake.messages.joint_command import JOINT_FIELDS
from atlas_drake.robot import load_robot

ARRAYS = [
    (kind, name)
    for kind in (AtlasCommand, AtlasSimInterfaceCommand)
    for name in JOINT_FIELDS
    if hasattr(kind, name)
]


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture
def start(robot):
    return commands_at_start(robot, Behavior.STAND)


@pytest.fixture
def everything(robot):
    """A joint command with all arrays, each with numbers of its own, within bounds."""
    command = AtlasCommand()
    for number, name in enumerate(JOINT_FIELDS):
        setattr(command, name, [number + 0.01 * j for j in range(28)])
    command.k_effort = list(range(28))
    assert robot.num_joints == 28
    return command


def sent(force, robot, atlas=None, sim=None, time=1.0):
    """What is in force after the messages given."""
    number = force.received + 1
    ports = [NOTHING if one is None else Sent(one, number) for one in (atlas, sim)]
    return latch(force, *ports, robot, time)


def refusals(force):
    """The events of the refused messages."""
    return [event for event in force.events if event.kind == REFUSAL]


def assert_in_force(force, command):
    for name in JOINT_FIELDS:
        np.testing.assert_array_equal(
            getattr(force.joints, name), getattr(command, name), err_msg=name
        )


def assert_only_the_error_is_new(after, before):
    """Everything that acts on the robot is as it was."""
    assert after.joints is before.joints
    assert after.request is before.request
    np.testing.assert_array_equal(after.k_effort, before.k_effort)
    assert (after.atlas_stamp, after.sim_stamp) == (
        before.atlas_stamp,
        before.sim_stamp,
    )


def test_at_start_the_stand_prep_pose_and_default_gains_are_in_force(robot, start):
    joints = start.joints
    np.testing.assert_array_equal(joints.position, robot.stand_prep)
    np.testing.assert_array_equal(joints.kp_position, robot.default_kp)
    np.testing.assert_array_equal(joints.kd_position, robot.default_kd)
    for name in set(JOINT_FIELDS) - {"position", "kp_position", "kd_position"}:
        np.testing.assert_array_equal(getattr(joints, name), np.zeros(28))
    assert start.error_code is ErrorCode.NO_ERRORS


@pytest.mark.parametrize("behavior", Behavior)
def test_at_start_joints_are_the_users_only_without_behavior(robot, behavior):
    start = commands_at_start(robot, behavior)
    users = behavior in (Behavior.USER, Behavior.NONE)
    np.testing.assert_array_equal(start.k_effort, np.full(28, 255.0 * users))
    assert start.request.behavior is behavior
    assert start.request.number == 0


@pytest.mark.parametrize("kind", [AtlasCommand, AtlasSimInterfaceCommand])
def test_velocity_gains_come_into_force_within_their_bound(robot, start, kind):
    bound = 50.0 * robot.effort_limit / robot.velocity_limit
    command = kind()
    command.kp_velocity = np.where(np.arange(28) % 2, 1e6, 0.9 * bound)
    port = "sim" if kind is AtlasSimInterfaceCommand else "atlas"
    after = sent(start, robot, **{port: command})
    expected = np.where(np.arange(28) % 2, bound, 0.9 * bound)
    np.testing.assert_allclose(after.joints.kp_velocity, expected)


@pytest.mark.parametrize(("kind", "field"), ARRAYS)
def test_an_array_comes_into_force_and_leaves_the_others(
    robot, start, everything, kind, field
):
    before = sent(start, robot, everything)
    assert_in_force(before, everything)
    np.testing.assert_array_equal(before.k_effort, range(28))
    # Between the integral bounds in force, so that it may be either of them.
    values = np.full(28, 7.5) if field.startswith("i_effort") else np.full(28, 7.0)
    command = kind()
    setattr(command, field, values)
    port = "sim" if kind is AtlasSimInterfaceCommand else "atlas"
    after = sent(before, robot, **{port: command})
    assert after.error_code is ErrorCode.NO_ERRORS, refusals(after)
    assert after.request.number == (after.received if port == "sim" else 0)
    expected = copy.deepcopy(everything)
    setattr(expected, field, values)
    assert_in_force(after, expected)
    # The later message counts.
    assert_in_force(sent(after, robot, everything), everything)


def test_an_empty_command_changes_nothing_but_is_accepted(robot, start):
    after = sent(start, robot, sim=AtlasSimInterfaceCommand(behavior=Behavior.STAND))
    assert after.joints is start.joints
    after = sent(after, robot, AtlasCommand(), time=3.0)
    assert_in_force(after, start.joints)
    assert (after.atlas_stamp, after.refused) == (3.0, 0)


@pytest.mark.parametrize("field", JOINT_FIELDS)
def test_a_bad_array_refuses_the_whole_command(robot, start, everything, field):
    before = sent(start, robot, everything)
    command = everything
    command.position = [0.5] * 28  # Good, and yet it must not be applied.
    setattr(command, field, [1.0] * 27)
    after = sent(before, robot, command, time=4.0)
    assert_only_the_error_is_new(after, before)
    assert after.error_code is ErrorCode.VALUE_OUT_OF_RANGE
    assert after.refused == 1
    (refusal,) = refusals(after)
    assert refusal.time == 4.0
    assert field in refusal.text
    assert refusal.data == {
        "number": after.received,
        "command": "AtlasCommand",
        "field": field,
    }


def test_integral_bounds_must_not_cross_those_in_force(robot, start):
    both = AtlasCommand()
    both.i_effort_min, both.i_effort_max = [-2.0] * 28, [3.0] * 28
    before = sent(start, robot, both)
    for field, value in (("i_effort_min", 3.5), ("i_effort_max", -2.5)):
        one = AtlasCommand()
        values = [0.0] * 28
        values[5] = value
        setattr(one, field, values)
        after = sent(before, robot, one)
        assert_only_the_error_is_new(after, before)
        assert after.error_code is ErrorCode.VALUE_OUT_OF_RANGE
        # The message is told of its own field and of the joint.
        assert f"{field}[5]" in after.events[-1].text
        assert robot.joint_names[5] in after.events[-1].text


def test_both_integral_bounds_may_pass_the_ones_in_force(robot, start):
    first, second = AtlasCommand(), AtlasCommand()
    first.i_effort_min, first.i_effort_max = [-2.0] * 28, [-1.0] * 28
    second.i_effort_min, second.i_effort_max = [4.0] * 28, [5.0] * 28
    after = sent(sent(start, robot, first), robot, second)
    assert after.error_code is ErrorCode.NO_ERRORS
    np.testing.assert_array_equal(after.joints.i_effort_min, np.full(28, 4.0))


def test_a_bad_behavior_or_step_refuses_the_whole_command(robot, start):
    unknown = AtlasSimInterfaceCommand(behavior="moonwalk", k_effort=[255] * 28)
    walk = AtlasSimInterfaceCommand(behavior=Behavior.WALK, k_effort=[3] * 28)
    walk.walk_params.step_queue[0].step_index = 0
    for command, code in (
        (unknown, ErrorCode.NO_SUCH_BEHAVIOR),
        (walk, ErrorCode.INVALID_INDEX),
    ):
        after = sent(start, robot, sim=command)
        assert_only_the_error_is_new(after, start)
        assert after.error_code is code


@pytest.mark.parametrize("shares", [[], [0] * 28])
def test_user_gives_every_joint_to_the_user_with_any_k_effort(robot, start, shares):
    command = AtlasSimInterfaceCommand(behavior=Behavior.USER, k_effort=shares)
    after = sent(start, robot, sim=command)
    np.testing.assert_array_equal(after.k_effort, np.full(28, 255.0))


def test_the_request_is_an_immutable_copy_of_the_command(robot, start):
    command = AtlasSimInterfaceCommand(behavior=Behavior.MANIPULATE)
    command.manipulate_params.desired.pelvis_height = 0.77
    after = sent(start, robot, sim=command)
    command.manipulate_params.desired.pelvis_height = 0.1
    kept = after.request.command.manipulate_params.desired
    assert kept.pelvis_height == 0.77
    with pytest.raises(AttributeError):
        kept.pelvis_height = 0.2


def test_the_later_message_wins_the_shares(robot, start):
    shares_of_7 = AtlasCommand(k_effort=[7] * 28)
    shares_of_9 = AtlasSimInterfaceCommand(behavior=Behavior.STAND, k_effort=[9] * 28)
    after = sent(sent(start, robot, shares_of_7), robot, sim=shares_of_9)
    np.testing.assert_array_equal(after.k_effort, np.full(28, 9.0))
    after = sent(sent(start, robot, sim=shares_of_9), robot, shares_of_7)
    np.testing.assert_array_equal(after.k_effort, np.full(28, 7.0))
    silent = AtlasSimInterfaceCommand(behavior=Behavior.STAND)
    after = sent(after, robot, sim=silent)
    np.testing.assert_array_equal(after.k_effort, np.full(28, 7.0))


@pytest.mark.parametrize(
    ("atlas_stamp", "sim_stamp", "winner"),
    [
        (2.0, 1.0, 7.0),
        (np.float32(2.0), 1, 7.0),
        (1.0, 2.0, 9.0),
        (0.0, 0.0, 9.0),
        (1.5, 1.5, 9.0),
    ],
)
def test_at_one_instant_the_stamps_decide(robot, start, atlas_stamp, sim_stamp, winner):
    atlas = AtlasCommand(Header(atlas_stamp), k_effort=[7] * 28)
    sim = AtlasSimInterfaceCommand(
        Header(sim_stamp), behavior=Behavior.STAND, k_effort=[9] * 28
    )
    after = sent(start, robot, atlas, sim, time=2.0)
    np.testing.assert_array_equal(after.k_effort, np.full(28, winner))
    assert after.error_code is ErrorCode.NO_ERRORS


def test_one_refused_message_does_not_take_the_other_with_it(robot, start):
    bad = AtlasCommand(position=[0.0])
    good = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    after = sent(start, robot, bad, good)
    assert after.request.behavior is Behavior.WALK
    assert after.refused == 1
    assert after.joints is start.joints


def test_a_message_seen_before_is_not_new(robot, start):
    bad = AtlasCommand(position=[0.0])
    good = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    once = latch(start, bad, good, robot, 1.0)
    assert latch(once, bad, good, robot, 2.0) is once
    # A message that leaves its port stays in force.
    assert latch(once, NOTHING, NOTHING, robot, 2.0) is once
    assert once.refused == 1
    assert once.request.number == once.received == 2


def test_an_equal_message_is_new_only_with_another_stamp_or_if_sent_again(robot, start):
    def walk(stamp=0.0, gain=(0.0,) * 28):
        header = Header(stamp)
        return AtlasSimInterfaceCommand(header, behavior="WALK", kp_position=gain)

    again = Sent(walk(), 1)
    force = start
    for message, number in (
        (walk(), 1),
        (walk(gain=[0] * 28), 1),
        (walk(gain=np.zeros(28)), 1),
        (accept(walk(), robot).message, 1),
        (again, 2),
        (again, 2),
        (walk(), 2),
        (Sent(walk(), 2), 3),
        (walk(stamp=1.5), 4),
        (walk(stamp=1.5), 4),
    ):
        force = latch(force, NOTHING, message, robot, 1.0)
        assert force.request.number == number
        assert force.received == number
    assert force.requests[1].command == force.requests[2].command


def test_a_message_passed_directly_is_always_new(robot, start):
    message = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    force = latch(start, NOTHING, message, robot, 1.0)
    force, refusal = receive(force, accept(message, robot), robot, 1.0)
    assert refusal is None
    assert [request.number for request in force.requests] == [0, 1, 2]
    # What is on the port has been received already, and so counts no second time.
    assert latch(force, NOTHING, message, robot, 1.0) is force
    outcome = accept(AtlasCommand(k_effort=[300]), robot)
    refused, refusal = receive(force, outcome, robot, 2.0)
    assert refusal == outcome
    assert (refused.received, refused.refused) == (3, 1)
    assert refused.request is force.request


def test_a_message_that_changes_on_its_port_is_new(robot, start):
    command = AtlasCommand(position=[0.0] * 28)
    force = latch(start, command, NOTHING, robot, 1.0)
    command.position[3] = 0.5
    force = latch(force, command, NOTHING, robot, 2.0)
    assert force.received == 2
    assert force.joints.position[3] == 0.5
    assert force.events[0].data["message"].position[3] == 0.0


def test_time_must_not_run_backward_for_either_kind(robot, start):
    force = sent(start, robot, AtlasCommand(Header(5.0)))
    # The two kinds have clocks of their own.
    sim = AtlasSimInterfaceCommand(Header(4.0), behavior=Behavior.STAND)
    force = sent(force, robot, sim=sim)
    assert force.error_code is ErrorCode.NO_ERRORS
    for message in (
        AtlasCommand(Header(4.9), position=[0.0] * 28),
        AtlasSimInterfaceCommand(Header(3.9), behavior=Behavior.WALK),
    ):
        # The door knows nothing of the time; what is in force refuses the message.
        late, refusal = receive(force, accept(message, robot), robot, 1.0)
        assert_only_the_error_is_new(late, force)
        assert late.error_code is refusal.error_code is ErrorCode.TIME_RAN_BACKWARD
        assert refusal.field == "header.stamp"


def test_a_message_without_stamp_was_sent_now(robot, start):
    after = sent(start, robot, AtlasCommand(), time=2.5)
    refused = sent(after, robot, AtlasCommand(Header(2.4)), time=2.6)
    assert refused.error_code is ErrorCode.TIME_RAN_BACKWARD


def test_each_message_is_an_event_and_a_good_one_clears_the_error_alone(robot, start):
    bad, good = AtlasCommand(position=[0.0]), AtlasCommand(position=[0.1] * 28)
    stand = AtlasSimInterfaceCommand(behavior=Behavior.STAND)
    force = sent(start, robot, bad, time=1.0)
    assert force.error_code is not ErrorCode.NO_ERRORS
    for time, message in ((1.0, good), (2.0, stand)):
        kind = "sim" if message is stand else "atlas"
        force = sent(force, robot, **{kind: message}, time=time)
    assert force.error_code is ErrorCode.NO_ERRORS
    assert (force.received, force.refused) == (3, 1)
    assert [(event.kind, event.time) for event in force.events] == [
        (REFUSAL, 1.0),
        (MESSAGE, 1.0),
        (MESSAGE, 2.0),
    ]
    assert [event.data["number"] for event in force.events] == [1, 2, 3]
    kept = [event.data.get("message") for event in force.events]
    assert kept == [None, accept(good, robot).message, accept(stand, robot).message]


def test_entries_of_the_last_moments_are_all_kept_and_older_ones_dropped(robot, start):
    force = start
    for number in range(6 * KEPT):
        behavior = "WALLK" if number % 2 else "STAND"
        command = AtlasSimInterfaceCommand(behavior=behavior)
        force = sent(force, robot, sim=command, time=1.0)
    assert force.refused == len(refusals(force)) == 3 * KEPT
    assert force.received == len(force.events) == 6 * KEPT
    assert len(force.requests) >= 3 * KEPT
    stand = AtlasSimInterfaceCommand(behavior=Behavior.STAND)
    later = sent(force, robot, sim=stand, time=2.0)
    for entries in (later.events, later.requests):
        assert len(entries) == KEPT
        assert entries[-1].time == 2.0


def test_each_fault_is_logged_at_intervals_and_again_when_time_went_back(
    robot, start, caplog
):
    force = start
    times = ((5.0, 2), (5.5, 0), (6.0, 0), (7.0, 2), (0.5, 2), (0.5, 0))
    for count, (time, heard) in enumerate(times, 1):
        caplog.clear()
        before = force
        # The values may change: a fault is one of a field.
        gain, velocity = [-1.0 * count] * 28, [0.0] * count
        for fault in (AtlasCommand(kp_velocity=gain), AtlasCommand(velocity=velocity)):
            force, _ = receive(force, accept(fault, robot), robot, time)
        log_refusals(before, force)
        assert len(caplog.records) == heard, time
        names = ("kp_velocity", "velocity")
        for record, name in zip(caplog.records, names, strict=False):
            assert record.levelno == logging.WARNING
            assert record.getMessage().startswith(f"t = {time:.3f} s: refused: {name}")


@pytest.mark.parametrize("thing", ["stand", 4, [1, 2]])
def test_a_port_value_that_is_no_message_is_refused(robot, start, thing):
    for arguments in ((thing, NOTHING), (NOTHING, thing)):
        after = latch(start, *arguments, robot, 1.0)
        assert_only_the_error_is_new(after, start)
        assert after.refused == 1


def test_arrays_in_force_are_not_the_senders(robot, start):
    positions = np.full(28, 0.25)
    shares = np.full(28, 17)
    after = latch(
        start, AtlasCommand(position=positions, k_effort=shares), NOTHING, robot, 1.0
    )
    positions[:] = 9.0
    shares[:] = 0
    np.testing.assert_array_equal(after.joints.position, np.full(28, 0.25))
    np.testing.assert_array_equal(after.k_effort, np.full(28, 17.0))


def test_values_are_their_own_copies(start):
    for value in (start, start.joints, start.request):
        assert copy.deepcopy(value) is value
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(value, dataclasses.fields(value)[0].name, None)
    assert isinstance(start, ActiveCommand)
    with pytest.raises(ValueError, match="read-only"):
        start.joints.share[0] = 1.0
