"""Detects a fall from the true state, for any controller of the robot.

A controller may detect the fall earlier, by the same signs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context, State

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.fall import Posture, sign_of_fall
from atlas_drake.frozen import NOTHING, Frozen
from atlas_drake.robot import Robot
from atlas_drake.systems.collectable_system import CollectableSystem

TICKS = 2
"""Interval between two looks at the posture [control periods]."""


@dataclass(frozen=True)
class Fall(Frozen):
    """Time [s] and sign of a fall, such as the tilt of the pelvis."""

    time: float
    sign: str


class FallMonitor(CollectableSystem):
    """State of the robot in, its fall out.

    Input ports:
        state: Positions and velocities of the robot.

    Output ports:
        fall: ``Fall``; NOTHING until the robot falls.
    """

    __slots__ = ()

    def __init__(
        self,
        robot: Robot,
        plant: MultibodyPlant,
        config: ControllerConfig,
        period: float,
    ) -> None:
        """Looks at ``robot`` in ``plant`` every ``TICKS`` control periods [s]."""
        super().__init__()
        self._plant: Any = plant
        self._limits = config.fall
        self._instance = own = robot.instance(plant)
        self._up = robot.indices(plant).pelvis.orientation
        self._soles = robot.soles(plant)
        self._nominal_height = robot.com_height - config.stance.com_drop
        self._state_input = self.DeclareVectorInputPort(
            "state", plant.num_multibody_states(own)
        )
        self._scratch = self.declare_scratch_context(plant.CreateDefaultContext)
        self._fall = self.declare_value_state(NOTHING, "fall")
        self.DeclarePeriodicUnrestrictedUpdateEvent(TICKS * period, 0.0, self._update)

    def reset(self, context: Context) -> None:
        """Forgets a fall."""
        self._fall.set(context, NOTHING)

    def _update(self, context: Context, state: State) -> None:
        if self._fall.get(context) is not NOTHING:
            return
        values = self._state_input.Eval(context)
        scratch = self._scratch.Eval(context)
        self._plant.SetPositionsAndVelocities(scratch, self._instance, values)
        _, qx, qy, _ = values[self._up].tolist()
        upright = 1.0 - 2.0 * (qx * qx + qy * qy)
        posture = Posture(upright, self._com_height(scratch))
        sign = sign_of_fall(posture, self._nominal_height, self._limits)
        if sign:
            fall = Fall(context.get_time(), sign)
            self._fall.set(state, fall)

    def _com_height(self, context: Context) -> float:
        """Computes the height of the center of mass above the lower sole [m]."""
        plant = self._plant
        com = plant.CalcCenterOfMassPositionInWorld(context, [self._instance])
        soles = [
            plant.get_frame(sole).CalcPoseInWorld(context).translation()[2]
            for sole in self._soles
        ]
        return float(com[2] - min(soles))
