"""What an action of an environment means: joint targets, a velocity, or footsteps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from atlas_drake.clients.policies.policy_joints import PolicyJoints
from atlas_drake.messages.fields import K_EFFORT_MAX
from atlas_drake.planning.walk_at import (
    fastest,
    first_open_step,
    nearest_velocity,
    walk_at,
)
from atlas_drake.robot import Robot
from atlas_drake.simulation import AtlasSimulation

LOOK = 0.02
"""Time between two looks for the next footstep [s]."""
LONGEST_WAIT = 3.0
"""Time after which a footstep that does not come is waited for no longer [s]."""


class Action(Protocol):
    """What the numbers of an action do, each of them usually between -1 and 1."""

    def joints(self, robot: Robot) -> tuple[str, ...]:
        """Returns the joints that the observation is about, in its order."""

    def size(self, robot: Robot) -> int:
        """Returns how many numbers an action has."""

    def act(
        self,
        sim: AtlasSimulation,
        joints: PolicyJoints,
        action: np.ndarray,
        period: float,
    ) -> None:
        """Commands an action, and simulates until the next one.

        Args:
            sim: The simulation.
            joints: Those of the observation.
            action: The action, shape (m,).
            period: Usual time between two actions [s].
        """


class JointTargets:
    """Set-points of joints in user mode: the environment's default pose and scale."""

    def __init__(self, joints: Sequence[str], *, k_effort: int = K_EFFORT_MAX):
        """Commands joints.

        Args:
            joints: Their names.
            k_effort: Share of the user, 1 to 255; the rest is the behavior's.
        """
        self._joints, self._k_effort = tuple(joints), k_effort

    def joints(self, robot: Robot) -> tuple[str, ...]:
        """Returns the joints that are commanded."""
        return self._joints

    def size(self, robot: Robot) -> int:
        """Returns their number."""
        return len(self._joints)

    def act(
        self,
        sim: AtlasSimulation,
        joints: PolicyJoints,
        action: np.ndarray,
        period: float,
    ) -> None:
        """Commands set-points for a period."""
        in_force = sim.output("commands").joints
        sim.publish(joints.command(action, in_force, self._k_effort))
        sim.advance(period)


class WalkVelocity:
    """Velocity of WALK: ahead, left and turn, as shares of the robot's largest."""

    def joints(self, robot: Robot) -> tuple[str, ...]:
        """Returns all joints."""
        return robot.joint_names

    def size(self, robot: Robot) -> int:
        """Returns 3."""
        return 3

    def act(
        self,
        sim: AtlasSimulation,
        joints: PolicyJoints,
        action: np.ndarray,
        period: float,
    ) -> None:
        """Walks at a velocity for a period."""
        self._steer(sim, action)
        sim.advance(period)

    def _steer(self, sim: AtlasSimulation, action: np.ndarray) -> None:
        gait = sim.scenario.controller_config().gait()
        most = fastest(gait)
        ahead, left, turn = np.clip(action, -1.0, 1.0).tolist()
        velocity = nearest_velocity(
            ahead * (most.ahead if ahead > 0.0 else most.back),
            left * most.aside,
            turn * most.turn,
            gait,
        )
        sim.publish(walk_at(sim.atlas_sim_interface_state, *velocity, gait=gait))


class Footsteps(WalkVelocity):
    """The next footstep of WALK: as ``WalkVelocity``, one action for each step."""

    def act(
        self,
        sim: AtlasSimulation,
        joints: PolicyJoints,
        action: np.ndarray,
        period: float,
    ) -> None:
        """Commands a footstep, and simulates until the next one can be chosen."""
        self._steer(sim, action)
        begin, step = sim.time, first_open_step(sim.atlas_sim_interface_state)
        while sim.time < begin + LONGEST_WAIT and not sim.has_fallen:
            sim.advance(LOOK)
            if first_open_step(sim.atlas_sim_interface_state) != step:
                return
