"""Shares of user control and set-points of joints: joint commands from sliders.

Pure functions: state, slider values and reports in, state and an optional message out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasCommand, AtlasState
from atlas_drake.robot import Robot

GROUPS = {
    "left arm": ("l_arm",),
    "right arm": ("r_arm",),
    "back": ("back",),
    "neck": ("neck",),
    "legs": ("l_leg", "r_leg"),
}
"""Groups that are handed over together, with their limbs of the robot's description."""
SPEED = 1.0
"""Speed at which a set-point follows its slider, so that a click causes no jerk
[rad/s]."""
DAMPING = 20.0
"""``kp_velocity`` of the user's joints [N·m·s/rad]: the initial gains have little
damping."""
SLIDER_STEP = 0.01
"""Resolution of the joints' sliders [rad]; smaller differences than half of it are
lost.
"""


@dataclass(frozen=True)
class Limbs:
    """The last command to the joint controllers.

    Attributes:
        shares: Shares of user control by group, 0 to 255.
        position: Set-points [rad], shape (n,).
    """

    shares: Mapping[str, int]
    position: np.ndarray


def group_of(robot: Robot) -> list[str]:
    """The group of each joint, in message order."""
    of_limb = {limb: name for name, limbs in GROUPS.items() for limb in limbs}
    return [of_limb[joint.limb] for joint in robot.file.joints]


def joint_shares(robot: Robot, shares: Mapping[str, int]) -> np.ndarray:
    """``k_effort`` of each joint, shape (n,)."""
    return np.array([shares[name] for name in group_of(robot)], dtype=int)


def hand_over(
    limbs: Limbs, shares: Mapping[str, int], state: AtlasState, robot: Robot
) -> tuple[Limbs, AtlasCommand | None]:
    """Hands limbs over to the user or back to the behavior, by shares of groups.

    A joint that the user gets keeps its position.
    """
    if dict(shares) == dict(limbs.shares):
        return limbs, None
    before = joint_shares(robot, limbs.shares)
    after = joint_shares(robot, shares)
    taken = (before == 0) & (after > 0)
    position = np.where(taken, np.array(state.position), limbs.position)
    limbs = Limbs(dict(shares), position)
    command = AtlasCommand()
    command.k_effort = after.tolist()
    command.position = position.tolist()
    command.kp_velocity = [DAMPING] * robot.num_joints
    return limbs, command


def move_joints(
    limbs: Limbs, targets: Mapping[int, float], dt: float
) -> tuple[Limbs, AtlasCommand | None]:
    """Moves set-points toward their targets [rad], by index, for ``dt`` [s]."""
    position = limbs.position.copy()
    for index, target in targets.items():
        way = target - position[index]
        if abs(way) <= 0.5 * SLIDER_STEP:
            continue
        position[index] += min(max(way, -SPEED * dt), SPEED * dt)
    if np.array_equal(position, limbs.position):
        return limbs, None
    command = AtlasCommand()
    command.position = position.tolist()
    return replace(limbs, position=position), command
