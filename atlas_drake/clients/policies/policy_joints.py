"""A policy's joints of a robot: what it observes, and the command of its action."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from atlas_drake.clients.policies.description import PolicyDescription
from atlas_drake.clients.policies.observation import Seen, Term
from atlas_drake.errors import RobotDescriptionError, ScenarioError
from atlas_drake.messages import AtlasCommand, AtlasState, Imu
from atlas_drake.messages.fields import K_EFFORT_MAX
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.robot import Robot

History = tuple[np.ndarray, ...]
"""Of each term of the observation the latest values, oldest first, shape (h, k)."""


class PolicyJoints:
    """Observation and action of a policy on a robot, the same in training and use.

    Attributes:
        description: What the policy's numbers mean.
        indices: Of its joints in message order, shape (m,).
    """

    def __init__(
        self, description: PolicyDescription, robot: Robot, terms: Sequence[Term]
    ):
        """Finds the joints.

        Args:
            description: What the policy's numbers mean.
            robot: The robot.
            terms: Computes each term of the observation.

        Raises:
            ScenarioError: If the robot lacks a joint of the policy.
        """
        self.description, self._terms = description, tuple(terms)
        try:
            self.indices = np.array([*map(robot.joint_index, description.joints)])
        except RobotDescriptionError as error:
            raise ScenarioError("joints", error.value, error.problem) from None
        self._position = np.array(description.position)
        self._action_scale = np.array(description.action_scale)

    def see(
        self,
        state: AtlasState,
        imu: Imu,
        action: np.ndarray,
        velocity: np.ndarray,
        actions: int,
        before: History,
    ) -> History:
        """Returns the latest values of each term, scaled.

        Args:
            state: Latest state of the joints.
            imu: Latest measurement at the pelvis.
            action: The last action, shape (m,).
            velocity: Desired: ahead, left [m/s], turn [rad/s], shape (3,).
            actions: Number of actions since the policy took its joints.
            before: What this returned for the last action; empty before the first.
        """
        description = self.description
        seen = Seen(
            imu=imu,
            position=np.asarray(state.position)[self.indices] - self._position,
            velocity=np.asarray(state.velocity)[self.indices],
            action=action,
            desired_velocity=velocity,
            time=actions * description.period,
            gait_period=description.gait_period,
        )
        here = []
        for index, (term, compute) in enumerate(
            zip(description.observation, self._terms, strict=True)
        ):
            value = np.asarray(term.scale) * compute(seen)
            past = before[index][1:] if before else [value] * (term.history - 1)
            here.append(np.array([*past, value]))
        return tuple(here)

    def command(
        self,
        action: np.ndarray,
        in_force: JointCommand,
        k_effort: int = K_EFFORT_MAX,
    ) -> AtlasCommand:
        """Makes the message of an action; other joints keep what is in force.

        Args:
            action: The action, shape (m,).
            in_force: The commands in force.
            k_effort: Share of the policy, 1 to 255.
        """
        description, mine = self.description, self.indices
        zero = np.zeros(len(mine))
        values: dict[str, Any] = {
            "position": self._position + self._action_scale * action,
            "velocity": zero,
            "effort": zero,
            "kp_position": description.kp,
            "ki_position": zero,
            "kd_position": zero,
            "kp_velocity": description.kd,
            "k_effort": np.full(len(mine), k_effort),
        }
        arrays = {}
        for name, given in values.items():
            array = getattr(in_force, name).copy()
            array[mine] = given
            arrays[name] = array
        arrays["k_effort"] = arrays["k_effort"].astype(int)
        return AtlasCommand(**arrays).freeze()


def observation_of(history: History) -> np.ndarray:
    """Joins the terms to what a network takes, shape (k,)."""
    return np.concatenate([values.ravel() for values in history])
