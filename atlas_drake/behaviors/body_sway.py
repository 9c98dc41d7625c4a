"""How pelvis and arms swing with the feet of a walk.

The pelvis turns toward the leading foot, which lengthens the stride; each hand swings
ahead with the foot of the other side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from atlas_drake.config import Configuration, NotNegative, Positive
from atlas_drake.frozen import read_only
from atlas_drake.robot import Robot
from atlas_drake.units import Meters, RadiansPerMeter, Ratio

LEAST_LEVER = 0.2
"""Least lever of an arm's joints about its hand, in heights of the center of mass, with
which the hand keeps up [-]: a stretched arm cannot reach further ahead."""


@dataclass(frozen=True)
class BodySway(Configuration):
    """Swing of pelvis and arms."""

    pelvis: NotNegative[RadiansPerMeter] = 0.3
    """Turn of the pelvis toward the leading foot per distance by which it leads."""
    arms: NotNegative[Ratio] = 0.3
    """Way of a hand ahead per distance by which the foot of the other side leads."""
    most_lead: Positive[Meters] = 0.4
    """Distance by which a foot leads up to which both grow."""


def arm_swing(robot: Robot, arms: float) -> np.ndarray:
    """Computes the joints' way per lead of the left foot [rad/m], shape (n,).

    It is the least motion of each arm that moves its hand along the pelvis' x axis,
    from the stand-prep pose: the right hand by ``arms`` [-] ahead, the left one back,
    and less where that would take a large motion.
    """
    swing = np.zeros(robot.num_joints)
    plant: Any = robot.plant
    context, indices = robot.standing_context(), robot.indices(plant)
    pelvis = plant.GetFrameByName(robot.file.pelvis)
    for (hand, limb), way in zip(robot.arms.items(), (-arms, arms), strict=False):
        J = plant.CalcJacobianTranslationalVelocity(
            context,
            JacobianWrtVariable.kV,
            plant.GetFrameByName(hand),
            np.zeros(3),
            pelvis,
            pelvis,
        )
        ahead = np.where(robot.limb(limb), J[0, indices.v], 0.0)
        lever = LEAST_LEVER * robot.com_height
        swing += way * ahead / max(float(ahead @ ahead), lever**2)
    return read_only(swing)
