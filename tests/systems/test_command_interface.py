"""The two command ports: optional, latched at once, refused whole and counted once."""

import numpy as np
import pytest
from pydrake.common.value import AbstractValue
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import NOTHING
from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.messages.commands import Sent
from atlas_drake.messages.event import REFUSAL
from atlas_drake.messages.joint_command import JOINT_FIELDS
from atlas_drake.systems.command_interface import CommandInterface

PERIOD = 0.002
"""Of the updates [s]."""

ATLAS, SIM = "atlas_command", "atlas_sim_interface_command"


class Sender:
    """A command interface on its own, and somebody who sends to it."""

    def __init__(self, robot):
        self.system = CommandInterface(robot, PERIOD, Behavior.STAND)
        self.simulator = Simulator(self.system)
        self.simulator.Initialize()

    def put(self, port, message):
        """Leaves a message on a port."""
        context = self.simulator.get_mutable_context()
        self.system.GetInputPort(port).FixValue(context, message)

    def tick(self, count=1):
        self.simulator.AdvanceTo(
            self.simulator.get_context().get_time() + count * PERIOD
        )

    def out(self, port="commands"):
        return self.system.GetOutputPort(port).Eval(self.simulator.get_context())


@pytest.fixture
def sender(robot):
    return Sender(robot)


def joint_command(**fields):
    return AtlasCommand(**{name: [value] * 28 for name, value in fields.items()})


def behavior_command(behavior, **fields):
    fields = {name: [value] * 28 for name, value in fields.items()}
    return AtlasSimInterfaceCommand(behavior=behavior, **fields)


def test_both_ports_may_stay_unconnected(sender, robot):
    for _ in range(2):
        np.testing.assert_array_equal(
            sender.out("joint_command").position, robot.stand_prep
        )
        np.testing.assert_array_equal(sender.out("k_effort"), np.zeros(28))
        assert sender.out().request.behavior is Behavior.STAND
        sender.tick(3)


def test_a_port_without_message_is_no_message(sender):
    before = sender.out()
    sender.put(ATLAS, NOTHING)
    sender.put(SIM, NOTHING)
    sender.tick(2)
    assert sender.out() is before


def test_a_message_is_in_force_at_the_instant_at_which_it_is_sent(sender):
    sender.put(ATLAS, joint_command(position=0.3, k_effort=100))
    np.testing.assert_array_equal(
        sender.out("joint_command").position, np.full(28, 0.3)
    )
    np.testing.assert_array_equal(sender.out("k_effort"), np.full(28, 100.0))
    sender.put(SIM, behavior_command("freeze"))
    assert sender.out().request.behavior is Behavior.FREEZE


def test_a_message_stays_in_force_when_it_leaves_the_port(sender):
    sender.put(ATLAS, joint_command(position=0.3, k_effort=100))
    sender.tick()
    sender.put(ATLAS, NOTHING)
    sender.tick()
    np.testing.assert_array_equal(
        sender.out("joint_command").position, np.full(28, 0.3)
    )
    np.testing.assert_array_equal(sender.out("k_effort"), np.full(28, 100.0))


def test_a_message_that_stays_on_the_port_is_taken_once(sender):
    message = behavior_command("STAND")
    sender.put(SIM, message)
    sender.tick(5)
    sender.put(SIM, message)
    sender.tick(5)
    # What left the door is the same message, and is not looked at again.
    sender.put(SIM, sender.out().request.command)
    sender.tick(5)
    assert sender.out().request.number == 1
    assert sender.out().request.command == message


def test_an_equal_message_is_taken_again_if_it_is_sent_again(sender):
    for number in (1, 2, 3):
        sender.put(SIM, Sent(behavior_command("STAND"), number))
        for _ in range(2):
            sender.tick(2)
            assert sender.out().request.number == number


class Stream(LeafSystem):
    """A commander who fills in the same message again and again."""

    def __init__(self, port, change):
        super().__init__()
        self.message = AtlasCommand() if port == ATLAS else behavior_command("STAND")
        self.change = change
        self.DeclareAbstractOutputPort(
            port, lambda: AbstractValue.Make(AtlasCommand()), self.calc
        )

    def calc(self, context, output):
        self.change(self.message, context.get_time())
        output.set_value(self.message)


def streamed(robot, port, change, seconds=0.02):
    """What is in force after a stream of messages, read 1000 times a second."""
    builder = DiagramBuilder()
    system = builder.AddSystem(CommandInterface(robot, PERIOD, Behavior.STAND))
    stream = builder.AddSystem(Stream(port, change))
    builder.Connect(stream.GetOutputPort(port), system.GetInputPort(port))
    simulator = Simulator(builder.Build())
    output = system.GetOutputPort("commands")
    for step in range(round(seconds / 0.001) + 1):
        simulator.AdvanceTo(0.001 * step)
        force = output.Eval(system.GetMyContextFromRoot(simulator.get_context()))
    return force


def test_a_message_object_is_read_again_when_it_changes(robot):
    def change(message, time):
        message.position = [0.1 * time] * 28

    force = streamed(robot, ATLAS, change)
    np.testing.assert_allclose(force.joints.position, 0.1 * 0.02)
    # Each tick from 0 s to 0.018 s, and the one now.
    assert force.received == 11


@pytest.mark.parametrize("port", [ATLAS, SIM])
@pytest.mark.parametrize("fresh", [False, True])
def test_a_stream_of_the_same_is_one_message(robot, port, fresh):
    def change(message, time):
        message.position = [0.5] * 28 if fresh else message.position

    force = streamed(robot, port, change)
    assert force.received == 1
    assert force.request.number == (port == SIM)


def test_a_stream_of_what_cannot_be_used_is_refused_and_logged_once(
    robot, caplog, poison
):
    def change(message, time):
        message.position = poison()

    force = streamed(robot, ATLAS, change, seconds=0.006)
    assert force.refused == force.received == 1
    assert len(caplog.records) == 1


def test_the_later_message_sets_the_shares(sender):
    sender.put(ATLAS, joint_command(k_effort=10))
    sender.tick()
    sender.put(SIM, behavior_command("STAND", k_effort=20))
    sender.tick()
    np.testing.assert_array_equal(sender.out("k_effort"), np.full(28, 20.0))
    sender.put(ATLAS, joint_command(k_effort=30))
    np.testing.assert_array_equal(sender.out("k_effort"), np.full(28, 30.0))


def test_user_gives_every_joint_to_the_user(sender):
    sender.put(SIM, behavior_command("user", k_effort=0))
    np.testing.assert_array_equal(sender.out("k_effort"), np.full(28, 255.0))


def steps_out_of_order():
    command = behavior_command("WALK", k_effort=7)
    for place, index in ((0, 2), (1, 1)):
        step = AtlasBehaviorStepData(step_index=index, duration=0.63)
        command.walk_params.step_queue[place] = step
    return command


OUT_OF_RANGE = ErrorCode.VALUE_OUT_OF_RANGE
INDEX = "walk_params.step_queue[1].step_index"
GOOD = {"position": [0.1] * 28, "k_effort": [7] * 28}
"""Fields that must not be taken from a faulty message either."""
FAULTS = {
    "length": (
        AtlasCommand(**GOOD, kp_position=[1.0] * 27),
        OUT_OF_RANGE,
        "kp_position",
    ),
    "nan": (
        AtlasCommand(**GOOD, velocity=[0.0] * 27 + [np.nan]),
        OUT_OF_RANGE,
        "velocity[27]",
    ),
    "share": (
        AtlasCommand(**GOOD | {"k_effort": [0] * 27 + [256]}),
        OUT_OF_RANGE,
        "k_effort[27]",
    ),
    "behavior": (
        behavior_command("DANCE", k_effort=7),
        ErrorCode.NO_SUCH_BEHAVIOR,
        "behavior",
    ),
    "steps": (steps_out_of_order(), ErrorCode.INVALID_INDEX, INDEX),
    "share length": (
        AtlasSimInterfaceCommand(behavior="WALK", k_effort=[0] * 30),
        OUT_OF_RANGE,
        "k_effort",
    ),
}


@pytest.mark.parametrize(("message", "code", "field"), FAULTS.values(), ids=FAULTS)
def test_a_refusal_changes_nothing_but_the_error_and_is_counted_once(
    sender, message, code, field
):
    sender.put(ATLAS, joint_command(position=0.2, ki_position=3.0))
    sender.put(SIM, behavior_command("STAND", k_effort=50))
    sender.tick()
    before = sender.out()
    sender.put(ATLAS if isinstance(message, AtlasCommand) else SIM, message)
    # At once, and after as many ticks as it stays on the port.
    for _ in range(3):
        after = sender.out()
        for name in JOINT_FIELDS:
            np.testing.assert_array_equal(
                getattr(after.joints, name), getattr(before.joints, name)
            )
        np.testing.assert_array_equal(after.k_effort, before.k_effort)
        assert after.request is before.request
        assert after.error_code is code
        assert after.refused == 1
        assert [e.data["field"] for e in after.events if e.kind == REFUSAL] == [field]
        sender.tick(2)


def test_a_stamp_before_the_last_one_is_refused(sender):
    for number, stamp in enumerate((5.0, 4.0), 1):
        command = behavior_command("STAND")
        command.header.stamp = stamp
        sender.put(SIM, command)
        sender.tick()
        assert sender.out().request.number == 1
        assert sender.out().refused == number - 1
    assert sender.out().error_code is ErrorCode.TIME_RAN_BACKWARD


def test_the_next_good_message_clears_the_error_but_not_the_count(sender):
    for number in (1, 2):
        sender.put(SIM, Sent(behavior_command("DANCE"), number))
        sender.tick()
        assert sender.out().refused == number
    sender.put(SIM, behavior_command("STAND"))
    sender.tick()
    assert sender.out().error_code is ErrorCode.NO_ERRORS
    assert sender.out().refused == 2
    first = sender.out().events[0]
    assert (first.kind, first.data["field"], first.time) == (REFUSAL, "behavior", 0.0)
