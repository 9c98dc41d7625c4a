"""The two command ports: optional, latched at once, and counted once."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.frozen import NOTHING
from atlas_drake.messages import AtlasCommand, AtlasSimInterfaceCommand, Behavior
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


def test_both_ports_may_stay_unconnected(sender, robot):
    before = sender.out()
    sender.tick(3)
    np.testing.assert_array_equal(
        sender.out("joint_command").position, robot.stand_prep
    )
    np.testing.assert_array_equal(sender.out("k"), np.zeros(28))
    sender.put(ATLAS, NOTHING)
    sender.put(SIM, NOTHING)
    assert sender.out() is before


def test_a_message_is_in_force_at_once_and_stays_so_when_it_leaves_the_port(sender):
    sender.put(ATLAS, AtlasCommand(position=[0.3] * 28, k_effort=[100] * 28))
    sender.put(SIM, AtlasSimInterfaceCommand(behavior="freeze"))
    for _ in range(2):
        assert sender.out("joint_command").position.tolist() == [0.3] * 28
        assert sender.out("k").tolist() == [100.0 * (1.0 / 255.0)] * 28
        assert sender.out().request.behavior is Behavior.FREEZE
        sender.tick()
        sender.put(ATLAS, NOTHING)
        sender.put(SIM, NOTHING)


def test_a_stream_of_nan_is_refused_and_logged_once(sender, caplog):
    for _ in range(4):
        sender.put(ATLAS, AtlasCommand(position=[float("nan")] * 28))
        sender.tick()
    assert sender.out().refused == sender.out().received == 1
    assert len(caplog.records) == 1


def test_a_reset_restores_the_start_and_counts_no_message_again(sender):
    sender.put(ATLAS, AtlasCommand(position=[0.3] * 28))
    sender.put(SIM, AtlasSimInterfaceCommand(behavior="WALK"))
    sender.tick()
    sender.system.reset(sender.simulator.get_mutable_context(), Behavior.USER)
    sender.tick()
    after = sender.out()
    assert (after.request.behavior, after.received) == (Behavior.USER, 2)
    assert sender.out("k").tolist() == [1.0] * 28
    assert sender.out("joint_command").position[0] != 0.3
