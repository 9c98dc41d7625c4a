"""A message source of your own: a system that commands Atlas in your own diagram.

    python examples/extending/message_source.py

No AtlasSimulation: the station is an ordinary diagram with two command ports.
"""

from math import pi, sin

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from atlas_drake import AtlasCommand, AtlasSimInterfaceCommand, AtlasSimInterfaceState
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.robot import load_robot

DISTANCE, RISE, PERIOD = 0.4, 1.0, 0.8  # of walk [m], of raising and waving [s]


class WavingWalker(LeafSystem):
    """Sends both kinds of message: Atlas waves, walks, and stops."""

    def __init__(self, robot):
        super().__init__()
        self._robot, self._arm = robot, robot.limb("r_arm")
        self._raise, self._wag = map(robot.joint_index, ("r_arm_shx", "r_arm_elx"))
        model = AbstractValue.Make(AtlasSimInterfaceState())
        self._report = self.DeclareAbstractInputPort("report", model)
        # The input of the source goes through a state: a diagram allows no algebraic
        # loop from messages to the report and back.
        walks = self.DeclareDiscreteState(1)
        self.DeclarePeriodicDiscreteUpdateEvent(0.1, 0.0, self._look)
        self._declare("atlas_command", AtlasCommand, self._wave, self.time_ticket())
        name, seen = "atlas_sim_interface_command", self.discrete_state_ticket(walks)
        self._declare(name, AtlasSimInterfaceCommand, self._walk, seen)

    def _declare(self, name, kind, calc, source):
        blank = AbstractValue.Make(kind())
        self.DeclareAbstractOutputPort(name, blank.Clone, calc, {source})

    def _look(self, context, state):
        x = self._report.Eval(context).pos_est.position.x
        state.set_value([context.get_time() >= RISE and x < DISTANCE])

    def _wave(self, context, output):
        time, command = context.get_time(), AtlasCommand()
        command.position = self._robot.stand_prep.copy()  # [rad]
        command.position[self._raise] -= 1.2 * min(time / RISE, 1.0)
        command.position[self._wag] += 0.5 * sin(2.0 * pi * time / PERIOD)
        command.kp_position = self._robot.default_kp
        command.kd_position = self._robot.default_kd
        command.k_effort = np.where(self._arm, 255, 0)  # that arm is the user's
        output.set_value(command)

    def _walk(self, context, output):
        walks = context.get_discrete_state_vector()[0] > 0.0
        command = AtlasSimInterfaceCommand(behavior="WALK" if walks else "STAND")
        command.walk_params.use_demo_walk = True
        output.set_value(command)


def main():
    """Wires station and source, and simulates."""
    builder, robot = DiagramBuilder(), load_robot("atlas")
    station = builder.AddNamedSystem("station", make_atlas_station(robot))
    source = builder.AddNamedSystem("source", WavingWalker(robot))
    for name in ("atlas_command", "atlas_sim_interface_command"):
        builder.Connect(source.GetOutputPort(name), station.GetInputPort(name))
    reporter = station.GetOutputPort("atlas_sim_interface_state")
    builder.Connect(reporter, source.GetInputPort("report"))
    simulator = Simulator(builder.Build())
    simulator.AdvanceTo(6.0)
    report = reporter.Eval(station.GetMyContextFromRoot(simulator.get_context()))
    print(f"{report.current_behavior.name} after {report.pos_est.position.x:.2f} m.")


if __name__ == "__main__":
    main()
