"""Whose joints are whose, and where the user's joints go: joint commands from sliders.

Pure: memory, wishes and state in, memory and perhaps a message out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from atlas_drake.frozen import replace
from atlas_drake.messages import K_EFFORT_MAX, AtlasCommand, AtlasState
from atlas_drake.robot import Robot

GROUPS = {
    "left arm": ("l_arm",),
    "right arm": ("r_arm",),
    "back": ("back",),
    "neck": ("neck",),
    "legs": ("l_leg", "r_leg"),
}
"""What is handed over as one, and the limbs of the robot's description in it."""
SPEED = 1.0
"""At which a set-point follows its slider, so that no click makes a jerk [rad/s]."""
DAMPING = 20.0
"""``kp_velocity`` of the user's joints [N·m·s/rad]: the gains in force at the start
hardly damp."""
SLIDER_STEP = 0.01
"""Of the joints' sliders [rad]; what differs by less than half of it they cannot say.
"""
ALL_USER = dict.fromkeys(GROUPS, K_EFFORT_MAX)
ALL_BEHAVIOR = dict.fromkeys(GROUPS, 0)


@dataclass(frozen=True)
class Limbs:
    """What the joint controllers were told last.

    Attributes:
        shares: Of user control by group, 0 to 255.
        position: Set-points [rad], shape (n,).
    """

    shares: Mapping[str, int]
    position: np.ndarray


def limbs_at_start(robot: Robot, shares: Mapping[str, int]) -> Limbs:
    """As the robot begins: set-points are those of the stand-prep pose."""
    return Limbs(dict(shares), robot.stand_prep.copy())


def group_of(robot: Robot) -> list[str]:
    """The group of each joint, in message order."""
    of_limb = {limb: name for name, limbs in GROUPS.items() for limb in limbs}
    return [of_limb[joint.limb] for joint in robot.file.joints]


def joint_shares(robot: Robot, shares: Mapping[str, int]) -> np.ndarray:
    """``k_effort`` of each joint, shape (n,)."""
    return np.array([shares[name] for name in group_of(robot)], dtype=int)


def users_joints(robot: Robot, shares: Mapping[str, int]) -> list[int]:
    """Indices of the joints of which the user has a share."""
    return np.flatnonzero(joint_shares(robot, shares)).tolist()


def hand_over(
    limbs: Limbs, shares: Mapping[str, int], state: AtlasState, robot: Robot
) -> tuple[Limbs, AtlasCommand | None]:
    """Gives limbs to the user or back.

    A joint that the user gets stays where it is.

    Args:
        limbs: As told last.
        shares: By group, 0 to 255.
        state: The latest one.
        robot: Whose limbs.
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
    """Moves set-points on towards their targets.

    Args:
        limbs: As told last.
        targets: Of the user's joints by index [rad].
        dt: Time that passes until the next look [s].
    """
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
