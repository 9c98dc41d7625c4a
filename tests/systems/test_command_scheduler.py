"""The command scheduler: order, times, and commands made from feedback."""

import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.frozen import NOTHING
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    AtlasState,
    Imu,
)
from atlas_drake.systems.command_scheduler import CommandScheduler, ScheduledCommand

PERIOD = 0.01
"""Of the looks at the clock [s]."""
STAND = AtlasSimInterfaceCommand(behavior="STAND")


def joint_command(effort):
    return AtlasCommand(effort=[effort])


class Run:
    """A scheduler on its own with feedback that the test sets."""

    def __init__(self, *schedule):
        self.system = CommandScheduler(
            [ScheduledCommand(*entry) for entry in schedule], PERIOD
        )
        self.simulator = Simulator(self.system)
        self.feed(AtlasSimInterfaceState())

    def feed(self, report):
        context = self.simulator.get_mutable_context()
        for name, value in (
            ("atlas_state", AtlasState()),
            ("atlas_sim_interface_state", report),
            ("imu", Imu()),
        ):
            self.system.GetInputPort(name).FixValue(context, value)

    def at(self, time):
        """Number of sent entries, joint and behavior command on the ports then."""
        self.simulator.AdvanceTo(time)
        context = self.simulator.get_context()
        values = [
            self.system.GetOutputPort(name).Eval(context)
            for name in ("sent", "atlas_command", "atlas_sim_interface_command")
        ]
        return tuple(values)


def test_entries_are_sent_on_time_and_in_the_order_of_their_times():
    first, second = joint_command(1.0), joint_command(3.0)
    run = Run((0.3, second), (0.1, first), (0.2, STAND), (0.25, None, "Look!"))
    assert run.at(0.095) == (0, NOTHING, NOTHING)
    assert run.at(0.105) == (1, first, NOTHING)
    # What was sent stays on its port.
    assert run.at(0.205) == (2, first, STAND)
    assert run.at(0.255) == (3, first, STAND)
    first.effort = [9.0]  # It was sent as a copy.
    assert run.at(0.305)[:2] == (4, second)
    message = run.at(0.4)[1]
    # The same object: the command interface takes it for one message.
    assert run.at(1.0)[1] is message


def test_times_that_are_sums_of_rounded_periods_are_not_a_tick_late():
    run = Run(*((PERIOD * k, joint_command(float(k))) for k in range(1, 60)))
    for k in range(1, 60):
        assert run.at(PERIOD * k + 0.5 * PERIOD)[1] == joint_command(float(k))


def test_several_entries_at_one_time_are_all_sent_one_in_each_tick():
    commands = [joint_command(1.0), joint_command(2.0), STAND]
    run = Run(*((0.05, command) for command in commands))
    assert [run.at(0.05 + (tick + 0.5) * PERIOD) for tick in range(3)] == [
        (1, commands[0], NOTHING),
        (2, commands[1], NOTHING),
        (3, commands[1], STAND),
    ]


def test_a_function_sees_the_feedback_of_the_moment_of_sending():
    times = []

    def reply(feedback):
        times.append(feedback.time)
        return joint_command(feedback.atlas_sim_interface_state.pos_est.position.x)

    run = Run((0.1, reply), (0.2, reply))
    for time, x in ((0.095, 1.0), (0.155, 2.0)):
        run.at(time)
        report = AtlasSimInterfaceState()
        report.pos_est.position.x = x
        run.feed(report)
        assert run.at(time + 0.05)[1] == joint_command(x)
    assert times == pytest.approx([0.1, 0.2])
