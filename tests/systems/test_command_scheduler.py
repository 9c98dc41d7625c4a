"""The command scheduler: order, times, and commands made from feedback."""

import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.frozen import NOTHING
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    AtlasState,
    Behavior,
    Imu,
)
from atlas_drake.messages.commands import Sent
from atlas_drake.systems.command_scheduler import CommandScheduler, ScheduledCommand

PERIOD = 0.01
"""Of the looks at the clock [s]."""

ATLAS, SIM = "atlas_command", "atlas_sim_interface_command"


def joint_command(effort):
    return AtlasCommand(effort=[effort])


def behavior_command(behavior):
    return AtlasSimInterfaceCommand(behavior=behavior)


class Run:
    """A scheduler on its own with feedback that the test sets."""

    def __init__(self, *schedule):
        self.system = CommandScheduler(
            [ScheduledCommand(*entry) for entry in schedule], PERIOD
        )
        self.simulator = Simulator(self.system)
        self.feed(AtlasSimInterfaceState())

    def put(self, port, value):
        context = self.simulator.get_mutable_context()
        self.system.GetInputPort(port).FixValue(context, value)

    def feed(self, state):
        self.put("atlas_state", AtlasState())
        self.put("atlas_sim_interface_state", state)
        self.put("imu", Imu())

    def to(self, time):
        self.simulator.AdvanceTo(time)

    def out(self, port):
        """Value of a port; of a command, the message that was sent."""
        value = self.system.GetOutputPort(port).Eval(self.simulator.get_context())
        return value.message if isinstance(value, Sent) else value


def test_entries_are_sent_on_time_and_in_the_order_of_their_times():
    run = Run(
        (0.3, joint_command(3.0)),
        (0.1, joint_command(1.0)),
        (0.2, behavior_command(Behavior.STAND)),
    )
    run.to(0.095)
    assert (run.out("sent"), run.out(ATLAS), run.out(SIM)) == (0, NOTHING, NOTHING)
    run.to(0.105)
    assert (run.out("sent"), run.out(ATLAS)) == (1, joint_command(1.0))
    assert run.out(SIM) is NOTHING
    run.to(0.205)
    assert run.out("sent") == 2
    # What was sent stays on its port.
    assert run.out(ATLAS) == joint_command(1.0)
    assert run.out(SIM) == behavior_command(Behavior.STAND)
    run.to(0.305)
    assert (run.out("sent"), run.out(ATLAS)) == (3, joint_command(3.0))
    message = run.out(ATLAS)
    run.to(1.0)
    assert run.out("sent") == 3
    # The same object: the command interface takes it for one message.
    assert run.out(ATLAS) is message


def test_times_that_are_sums_of_rounded_periods_are_not_a_tick_late():
    run = Run(*((PERIOD * k, joint_command(float(k))) for k in range(1, 60)))
    for k in range(1, 60):
        run.to(PERIOD * k + 0.5 * PERIOD)
        assert run.out(ATLAS) == joint_command(float(k))


def test_several_entries_at_one_time_are_all_sent_one_in_each_tick():
    run = Run(
        (0.05, joint_command(1.0)),
        (0.05, joint_command(2.0)),
        (0.05, behavior_command(Behavior.FREEZE)),
    )
    ports = []
    for tick in range(3):
        run.to(0.05 + (tick + 0.5) * PERIOD)
        ports.append((run.out("sent"), run.out(ATLAS), run.out(SIM)))
    freeze = behavior_command(Behavior.FREEZE)
    assert ports == [
        (1, joint_command(1.0), NOTHING),
        (2, joint_command(2.0), NOTHING),
        (3, joint_command(2.0), freeze),
    ]


def test_a_function_sees_the_feedback_of_the_moment_of_sending():
    times = []

    def reply(feedback):
        times.append(feedback.time)
        return joint_command(feedback.atlas_sim_interface_state.pos_est.position.x)

    run = Run((0.1, reply), (0.2, reply))
    for time, x in ((0.095, 1.0), (0.155, 2.0)):
        run.to(time)
        state = AtlasSimInterfaceState()
        state.pos_est.position.x = x
        run.feed(state)
        run.to(time + 0.05)
        assert run.out(ATLAS) == joint_command(x)
    assert times == pytest.approx([0.1, 0.2])


def test_a_text_without_command_is_counted_and_sends_nothing():
    run = Run((0.1, None, "Look!"))
    run.to(0.2)
    assert (run.out("sent"), run.out(ATLAS), run.out(SIM)) == (1, NOTHING, NOTHING)


def test_a_sent_command_is_a_copy():
    message = joint_command(1.0)
    run = Run((0.1, message))
    run.to(0.15)
    message.effort = [2.0]
    run.to(0.25)
    assert run.out(ATLAS) == joint_command(1.0)
