"""Your own controller: joint PD with gravity compensation.

    python examples/extending/own_controller.py

Atlas stands on joint springs; the ground's reaction on each foot is taken from the
measured loads. A push at 2 s shows the limits of joint springs: they do not balance.
"""

import argparse
from types import SimpleNamespace

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import LeafSystem

from atlas_drake import AtlasSimulation


class GravityCompensatedPd(LeafSystem):
    """Holds the stand-prep pose: τ = kp (q₀ - q) - kd v + gravity - Jᵀ f."""

    def __init__(self, robot, scenario):
        """Takes the robot, and the station's settings, which are not used here."""
        super().__init__()
        self._robot = robot
        self._plant = robot.plant
        self._context = self._plant.CreateDefaultContext()
        self._indices = robot.indices(self._plant)
        # The station connects these by their names.
        self._state = self.DeclareVectorInputPort(
            "state", self._plant.num_multibody_states()
        )
        self._loads = self.DeclareVectorInputPort("foot_loads", 2)
        self.DeclareVectorOutputPort("behavior_effort", robot.num_joints, self._calc)

    def _calc(self, context, output):
        robot, plant = self._robot, self._plant
        plant.SetPositionsAndVelocities(self._context, self._state.Eval(context))
        forces = -plant.CalcGravityGeneralizedForces(self._context)
        for foot, load in zip(robot.file.feet, self._loads.Eval(context), strict=True):
            jacobian = plant.CalcJacobianTranslationalVelocity(
                self._context,
                JacobianWrtVariable.kV,
                plant.GetFrameByName(foot.sole_frame),
                np.zeros(3),
                plant.world_frame(),
                plant.world_frame(),
            )
            forces -= load * jacobian[2]
        q = plant.GetPositions(self._context)[self._indices.q]
        v = plant.GetVelocities(self._context)[self._indices.v]
        springs = robot.default_kp * (robot.stand_prep - q) - robot.default_kd * v
        output.SetFromVector(springs + forces[self._indices.v])


controller = GravityCompensatedPd  # what --with takes from this file


def main():
    """Stands for two seconds, and is pushed."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--push", type=float, default=200.0, help="of the chest [N]")
    options = parser.parse_args()
    sim = AtlasSimulation(
        controller=controller, listeners=[SimpleNamespace(event=print)]
    )
    sim.advance(2.0)
    sim.apply_push("trunk", [options.push, 0.0, 0.0], 0.1)
    sim.advance(3.0)
    print("It fell." if sim.has_fallen else "It stands.")


if __name__ == "__main__":
    main()
