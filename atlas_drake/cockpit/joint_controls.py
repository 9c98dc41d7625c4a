"""Who has which joint, and where the user's joints go."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from atlas_drake.errors import InvalidMessageError, did_you_mean
from atlas_drake.messages import K_EFFORT_MAX, AtlasCommand
from atlas_drake.messages.checks import check_number
from atlas_drake.messages.joint_command import JointCommand

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

SPEED = 1.0
"""Speed at which a set-point goes to where it was put, so that a click causes no jerk
[rad/s]."""
DAMPING = 20.0
"""``kp_velocity`` of a joint that the user takes [N·m·s/rad]: the initial gains have
little damping."""
STAND_PREP = "STAND_PREP"
"""The pose that every robot has."""


class JointControls:
    """Shares, set-points and gains of joints.

    A joint that the user gets keeps its position; set-points move at ``SPEED``.
    """

    def __init__(self, sim: AtlasSimulation) -> None:
        """Takes what is in force."""
        self._sim = sim
        self._targets: dict[int, float] = {}
        self._poses = {STAND_PREP: sim.robot.stand_prep}

    @property
    def poses(self) -> tuple[str, ...]:
        """Names of the poses that the joints can go to."""
        return tuple(self._poses)

    def share(self, joints: Sequence[str], k_effort: float) -> None:
        """Gives joints to the user or back to the behavior, fully or in part.

        Args:
            joints: Names of the joints.
            k_effort: The user's share, 0 to 255.
        """
        share = check_number(k_effort, "k_effort", 0, K_EFFORT_MAX, whole=True)
        chosen = self._indices(joints)
        shares = self._in_force.k_effort.astype(int)
        shares[chosen] = int(share)
        self.set_shares(shares)

    def set_shares(self, shares: np.ndarray) -> None:
        """Sets the user's share of every joint.

        Args:
            shares: 0 to 255, shape (n,).
        """
        before = self._in_force
        taken = (before.k_effort == 0) & (shares > 0)
        command = AtlasCommand(k_effort=shares.astype(int).tolist())
        position = np.where(taken, self._measured, before.position)
        damping = np.where(
            taken, np.maximum(before.kp_velocity, DAMPING), before.kp_velocity
        )
        command.position, command.kp_velocity = position.tolist(), damping.tolist()
        for index in np.flatnonzero(taken):
            self._targets.pop(int(index), None)
        self._sim.publish(command)

    def move(self, joint: str, position: float) -> None:
        """Moves the set-point of a joint, at ``SPEED``.

        Args:
            joint: Name of the joint.
            position: Where to [rad], within the joint's limits.
        """
        (index,) = self._indices([joint])
        robot = self._sim.robot
        low, high = robot.position_lower[index], robot.position_upper[index]
        self._targets[index] = check_number(position, joint, float(low), float(high))

    def gains(self, joint: str, **gains: float) -> None:
        """Changes gains of the user's controller of a joint.

        Args:
            joint: Name of the joint.
            **gains: Of kp_position, ki_position, kd_position and kp_velocity, in the
                units of ``AtlasCommand``.
        """
        (index,) = self._indices([joint])
        command = AtlasCommand()
        for name, value in gains.items():
            if name not in GAINS:
                raise InvalidMessageError(name, value, f"there are {', '.join(GAINS)}")
            values = np.array(getattr(self._in_force, name))
            values[index] = check_number(value, name, 0.0)
            setattr(command, name, values.tolist())
        self._sim.publish(command)

    def stay(self) -> None:
        """Leaves all set-points where they are."""
        self._targets.clear()

    def hold(self) -> None:
        """Holds the user's joints where they are, with the robot's gains."""
        robot = self._sim.robot
        mine = self._in_force.k_effort > 0
        self._targets.clear()
        self._publish(
            mine,
            position=self._measured,
            kp_position=robot.default_kp,
            kp_velocity=np.full(robot.num_joints, DAMPING),
        )

    def go_limp(self) -> None:
        """Lets the user's joints go: no position gains, damping alone."""
        nothing = np.zeros(self._sim.robot.num_joints)
        self._targets.clear()
        mine = self._in_force.k_effort > 0
        self._publish(mine, kp_position=nothing, ki_position=nothing)

    def save_pose(self, name: str) -> None:
        """Keeps the present positions under a name."""
        if not isinstance(name, str) or not name.strip() or len(name) > LONGEST_NAME:
            raise InvalidMessageError("name", name, "a pose needs a name")
        self._poses[name.strip()] = self._measured

    def go_to_pose(self, name: str) -> None:
        """Moves the user's joints to a saved pose."""
        if name not in self._poses:
            hint = did_you_mean(str(name), self._poses)
            raise InvalidMessageError("name", name, f"there is no such pose.{hint}")
        robot = self._sim.robot
        pose = np.clip(self._poses[name], robot.position_lower, robot.position_upper)
        for index in np.flatnonzero(self._in_force.k_effort):
            self._targets[int(index)] = float(pose[index])

    def update(self, dt: float) -> None:
        """Moves set-points towards where they were put, for ``dt`` [s]."""
        if not self._targets or dt <= 0.0:
            return
        position = np.array(self._in_force.position)
        for index, target in list(self._targets.items()):
            way = target - position[index]
            position[index] += min(max(way, -SPEED * dt), SPEED * dt)
            if abs(way) <= SPEED * dt:
                del self._targets[index]
        self._sim.publish(AtlasCommand(position=position.tolist()))

    @property
    def _in_force(self) -> JointCommand:
        joints: JointCommand = self._sim.output("commands").joints
        return joints

    @property
    def _measured(self) -> np.ndarray:
        return np.array(self._sim.atlas_state.position)

    def _publish(self, chosen: np.ndarray, **values: np.ndarray) -> None:
        """Changes fields of the joints that are chosen."""
        command = AtlasCommand()
        for name, value in values.items():
            before = getattr(self._in_force, name)
            setattr(command, name, np.where(chosen, value, before).tolist())
        self._sim.publish(command)

    def _indices(self, joints: Sequence[str]) -> list[int]:
        names = self._sim.robot.joint_names
        if isinstance(joints, str) or not isinstance(joints, Sequence):
            raise InvalidMessageError("joints", joints, "must be names of joints")
        for name in joints:
            if name not in names:
                hint = did_you_mean(str(name), names)
                raise InvalidMessageError("joint", name, f"there is none.{hint}")
        return [names.index(name) for name in joints]


GAINS = ("kp_position", "ki_position", "kd_position", "kp_velocity")
"""The gains that a page shows."""
LONGEST_NAME = 40
"""Letters of a pose's name."""
