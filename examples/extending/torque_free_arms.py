"""The shipped controller, changed: its efforts pass through your own system.

    python examples/extending/torque_free_arms.py

The arms get no torque; balance, QP and behaviors are the shipped ones. A diagram is a
System, too, and so fits the socket if its ports have the right names.
"""

from types import SimpleNamespace

import numpy as np
from pydrake.systems.framework import DiagramBuilder, LeafSystem

from atlas_drake import AtlasSimulation
from atlas_drake.diagrams.atlas_station import make_whole_body_controller


class TorqueFreeArms(LeafSystem):
    """Passes efforts on [N·m], but none to the arms."""

    def __init__(self, robot):
        super().__init__()
        self._arms = robot.limb("l_arm", "r_arm")
        self.DeclareVectorInputPort("ours", robot.num_joints)
        self.DeclareVectorOutputPort("effort", robot.num_joints, self._calc)

    def _calc(self, context, output):
        effort = self.GetInputPort("ours").Eval(context)
        output.SetFromVector(np.where(self._arms, 0.0, effort))


def make_controller(robot, scenario):
    """Wires the shipped controller and the system behind it; the station calls it."""
    builder = DiagramBuilder()
    ours = builder.AddNamedSystem("ours", make_whole_body_controller(robot, scenario))
    free = builder.AddNamedSystem("torque_free_arms", TorqueFreeArms(robot))
    builder.Connect(ours.GetOutputPort("behavior_effort"), free.GetInputPort("ours"))
    for index in range(ours.num_input_ports()):
        port = ours.get_input_port(index)
        builder.ExportInput(port, port.get_name())
    builder.ExportOutput(free.GetOutputPort("effort"), "behavior_effort")
    for name in ("controller_status", "planned_paths"):
        builder.ExportOutput(ours.GetOutputPort(name), name)
    return builder.Build()


controller = make_controller  # what --with takes from this file


def main():
    """Stands for three seconds, the arms hanging."""
    sim = AtlasSimulation(
        controller=controller, listeners=[SimpleNamespace(event=print)]
    )
    arms = sim.robot.limb("l_arm", "r_arm")
    sim.advance(3.0)
    effort = np.abs(sim.output("effort"))
    print(f"at most {effort[arms].max():.1f} N·m on the arms,", end=" ")
    print(f"{effort[~arms].max():.1f} N·m elsewhere")
    print("It fell." if sim.has_fallen else "It stands.")


if __name__ == "__main__":
    main()
