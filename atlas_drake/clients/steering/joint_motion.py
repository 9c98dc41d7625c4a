"""Who has which joint, and where the user's joints go.

The reports may be up to 0.1 s old. What was commanded since then is taken as done.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from atlas_drake.clients.steering.reports import Publish
from atlas_drake.errors import InvalidMessageError, did_you_mean
from atlas_drake.frozen import replace
from atlas_drake.messages import K_EFFORT_MAX, AtlasCommand
from atlas_drake.messages.checks import check_number
from atlas_drake.messages.joint_command import JointCommand

if TYPE_CHECKING:
    from atlas_drake.robot import Robot

SPEED = 1.0
"""Speed at which a set-point goes to where it was put, so that a click causes no jerk
[rad/s]."""
DAMPING = 20.0
"""``kp_velocity`` of a joint that the user takes [N·m·s/rad]: the initial gains have
little damping."""
STAND_PREP = "STAND_PREP"
"""The pose that every robot has."""
LONGEST_NAME = 40
"""Letters of a pose's name."""
SHOWN_WITHIN = 3
"""Number of reports after which a command must show; the first may be older."""


@dataclass(frozen=True, eq=False)
class JointFacts:
    """What is needed to know of a robot's joints; unlike a ``Robot`` it can be pickled.

    Attributes:
        joint_names: Names in message order.
        position_lower: Lower position limits [rad], shape (n,).
        position_upper: Upper position limits [rad], shape (n,).
        stand_prep: The stand-prep pose [rad], shape (n,).
        default_kp: Default position gains [N·m/rad], shape (n,).
        legs: True for joints of the legs, bool, shape (n,).
    """

    joint_names: tuple[str, ...]
    position_lower: np.ndarray
    position_upper: np.ndarray
    stand_prep: np.ndarray
    default_kp: np.ndarray
    legs: np.ndarray

    @classmethod
    def of(cls, robot: Robot) -> JointFacts:
        """Returns those of a robot."""
        return cls(
            robot.joint_names,
            robot.position_lower,
            robot.position_upper,
            robot.stand_prep,
            robot.default_kp,
            robot.limb("l_leg", "r_leg"),
        )


class JointMotion:
    """Shares and set-points of joints."""

    def __init__(
        self,
        joints: JointFacts,
        publish: Publish,
        command: JointCommand,
        position: np.ndarray,
    ) -> None:
        """Knows the stand-prep pose."""
        self._joints, self._publish = joints, publish
        self._poses = {STAND_PREP: joints.stand_prep}
        self._targets: dict[int, float]
        # Fields that do not show yet, each with the reports in which it has to.
        self._unseen: dict[str, tuple[np.ndarray, int]]
        self.forget_joints()
        self.see_joints(command, position)

    @property
    def poses(self) -> tuple[str, ...]:
        """Names of the poses that the joints can go to."""
        return tuple(self._poses)

    @property
    def shares(self) -> np.ndarray:
        """The user's share of each joint, 0 to 255, shape (n,)."""
        return self._in_force.k_effort

    def share(self, joints: Sequence[str], k_effort: float) -> None:
        """Gives joints to the user or back to the behavior, fully or in part.

        A joint that the user gets keeps its position.

        Args:
            joints: Names of the joints.
            k_effort: The user's share, 0 to 255.
        """
        share = check_number(k_effort, "k_effort", 0, K_EFFORT_MAX, whole=True)
        shares = self.shares.copy()
        shares[[self._index(name) for name in joints]] = share
        self.set_shares(shares)

    def set_shares(self, shares: np.ndarray) -> None:
        """Sets the user's share of every joint, 0 to 255, shape (n,)."""
        before = self._in_force
        taken = (before.k_effort == 0) & (shares > 0)
        for index in np.flatnonzero(taken):
            self._targets.pop(int(index), None)
        damped = np.maximum(before.kp_velocity, DAMPING)
        self._command(
            k_effort=shares,
            position=np.where(taken, self._measured, before.position),
            kp_velocity=np.where(taken, damped, before.kp_velocity),
        )

    def move(self, joint: str, position: float) -> None:
        """Moves the set-point of a joint, at ``SPEED``.

        Args:
            joint: Name of the joint.
            position: Where to [rad], within the joint's limits.
        """
        index, facts = self._index(joint), self._joints
        low, high = facts.position_lower[index], facts.position_upper[index]
        self._targets[index] = check_number(position, joint, float(low), float(high))

    def hold(self) -> None:
        """Holds the user's joints where they are, with the robot's gains."""
        self._targets.clear()
        self._command_users(
            position=self._measured,
            velocity=np.zeros(len(self._measured)),
            kp_position=self._joints.default_kp,
            kp_velocity=np.full(len(self._measured), DAMPING),
        )

    def go_limp(self) -> None:
        """Lets the user's joints go: damping alone."""
        self._targets.clear()
        nothing = np.zeros(len(self._measured))
        self._command_users(
            velocity=nothing, effort=nothing, kp_position=nothing, ki_position=nothing
        )

    def save_pose(self, name: str) -> None:
        """Keeps the present positions of the joints under a name."""
        if not name.strip() or len(name) > LONGEST_NAME:
            raise InvalidMessageError("name", name, "a pose needs a name")
        self._poses[name.strip()] = self._measured

    def go_to_pose(self, name: str) -> None:
        """Moves the user's joints to a saved pose, at ``SPEED``."""
        if name not in self._poses:
            hint = did_you_mean(name, self._poses)
            raise InvalidMessageError("name", name, f"there is no such pose.{hint}")
        facts = self._joints
        pose = np.clip(self._poses[name], facts.position_lower, facts.position_upper)
        for index in np.flatnonzero(self.shares):
            self._targets[int(index)] = float(pose[index])

    # ---- as time goes on -----------------------------------------------------

    def see_joints(self, command: JointCommand, position: np.ndarray) -> None:
        """Takes the latest commands in force and measured positions."""
        for name, (values, reports) in list(self._unseen.items()):
            if reports <= 1 or np.array_equal(getattr(command, name), values):
                del self._unseen[name]
            else:
                self._unseen[name] = values, reports - 1
        unseen = {name: values for name, (values, _) in self._unseen.items()}
        self._in_force, self._measured = replace(command, **unseen), position

    def forget_joints(self) -> None:
        """Leaves all set-points where they are, and forgets what was commanded."""
        self._targets, self._unseen = {}, {}

    def move_on(self, dt: float) -> None:
        """Moves set-points on for ``dt`` [s]."""
        if not self._targets or dt <= 0.0:
            return
        position = self._in_force.position.copy()
        for index, target in list(self._targets.items()):
            way = target - position[index]
            position[index] += min(max(way, -SPEED * dt), SPEED * dt)
            if abs(way) <= SPEED * dt:
                del self._targets[index]
        self._command(position=position)

    def _command_users(self, **values: np.ndarray) -> None:
        """Commands fields of the user's joints."""
        mine, before = self.shares > 0, self._in_force
        self._command(
            **{
                name: np.where(mine, value, getattr(before, name))
                for name, value in values.items()
            }
        )

    def _command(self, **values: np.ndarray) -> None:
        """Commands fields of all joints, which counts from now on."""
        self._in_force = replace(self._in_force, **values)
        self._unseen |= {name: (value, SHOWN_WITHIN) for name, value in values.items()}
        lists: dict[str, Any] = {name: value.tolist() for name, value in values.items()}
        if "k_effort" in values:
            lists["k_effort"] = values["k_effort"].astype(int).tolist()
        self._publish(AtlasCommand(**lists))

    def _index(self, joint: str) -> int:
        names = self._joints.joint_names
        if joint not in names:
            hint = did_you_mean(str(joint), names)
            raise InvalidMessageError("joint", joint, f"there is none.{hint}")
        return names.index(joint)
