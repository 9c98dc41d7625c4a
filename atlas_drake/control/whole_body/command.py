"""What a behaviour asks of the whole-body QP in one control tick.

Plain values in terms of accelerations; how they are weighed against each other is
in the gains, how they are met in the QP.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

TOES = 0.03
"""Length of the strip at the front that a foot on its toes stands on [m]."""


class Pressure(Enum):
    """Part of a sole that its centre of pressure is kept to."""

    SOLE = "all of it but a margin"
    MIDDLE = "its middle: a foot that stands on an edge is turned flat"
    TOES = "its front edge, while the heel is up"


@dataclass(frozen=True)
class FootCommand:
    """What one foot shall do.

    Attributes:
        acceleration: Desired spatial acceleration of the sole in W
            [rad/s²; m/s²], shape (6,).
        max_normal_force: Largest normal force the ground may be asked for [N]; 0
            for a foot in the air.
        min_normal_force: Smallest normal force [N].
        pressure: Where on the sole the ground may push.
    """

    acceleration: np.ndarray
    max_normal_force: float
    min_normal_force: float = 0.0
    pressure: Pressure = Pressure.SOLE

    @property
    def in_contact(self) -> bool:
        """Whether the ground may push on this foot at all."""
        return self.max_normal_force > 0.0


@dataclass(frozen=True)
class WholeBodyCommand:
    """Desired accelerations of one tick; n joints in message order.

    Attributes:
        com_acceleration: Of the centre of mass in W [m/s²], shape (3,).
        pendulum_base: Point that the ground's force on the whole robot shall pass
            through, below the centre of mass, in W [m], shape (3,).
        pelvis_angular_acceleration: In W [rad/s²], shape (3,).
        chest_angular_acceleration: In W [rad/s²], shape (3,).
        feet: Left and right foot.
        joint_acceleration: Posture [rad/s²], shape (n,).
        joint_weight: Weight of each joint's posture, shape (n,), positive.
        balance: False where there is nothing to balance with: the task weights of
            the centre of mass, pendulum, pelvis and chest are then dropped.
    """

    com_acceleration: np.ndarray
    pendulum_base: np.ndarray
    pelvis_angular_acceleration: np.ndarray
    chest_angular_acceleration: np.ndarray
    feet: tuple[FootCommand, FootCommand]
    joint_acceleration: np.ndarray
    joint_weight: np.ndarray
    balance: bool = True


@dataclass(frozen=True)
class EffortBounds:
    """What each joint's effort can be this tick, in message order.

    A joint that the behaviour commands alone ranges over its limits; one under
    user control has its user's effort as both bounds; a blend lies between.

    Attributes:
        lower: Least total effort [N·m], shape (n,).
        upper: Greatest total effort [N·m], shape (n,).
        user_held: Joints whose effort the user decides alone, bool, shape (n,).
        added_inertia: By how much the bounds fall per acceleration of the joint,
            because the user's law resists it [kg·m²], shape (n,); None for nowhere.
        authority: The behaviour's share of each joint, 0 to 1, shape (n,); None for 1
            everywhere.
    """

    lower: np.ndarray
    upper: np.ndarray
    user_held: np.ndarray
    added_inertia: np.ndarray | None = None
    authority: np.ndarray | None = None
