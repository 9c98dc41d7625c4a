"""Environments that Gymnasium knows by name, registered when this is imported.

gymnasium.make("atlas_drake.clients.learning.tasks:AtlasDrake/Balance-v0")
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np

from atlas_drake.clients.learning.actions import JointTargets, WalkVelocity
from atlas_drake.clients.learning.environment import AtlasEnv
from atlas_drake.records import TickRecord
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation

BALANCE, WALK = "AtlasDrake/Balance-v0", "AtlasDrake/Walk-v0"
"""Their names."""
BALANCE_JOINTS = tuple(
    f"{side}_leg_{joint}" for side in "lr" for joint in ("hpx", "hpy", "aky", "akx")
)
"""Hips and ankles of Atlas, but for their yaw."""
PUSH_DURATION = 0.1
"""[s]"""
WALK_PERIOD = 0.1
"""Time between two velocities [s]."""


def balance(push: tuple[float, float] = (0.2, 0.4), **changes: Any) -> AtlasEnv:
    """Atlas in user mode, pushed, has to keep its balance with hips and ankles.

    No behavior helps. The reward of an action is 1, less the speed of the CoM.

    Args:
        push: Least and greatest change of the robot's velocity [m/s].
        **changes: Other arguments of ``AtlasEnv``.
    """

    def begin(sim: AtlasSimulation, random: np.random.Generator) -> None:
        angle, size = random.uniform(-math.pi, math.pi), random.uniform(*push)
        force = size * sim.robot.mass / PUSH_DURATION
        force_W = [force * math.cos(angle), force * math.sin(angle), 0.0]
        sim.apply_push("trunk", force_W, PUSH_DURATION)

    def reward(record: TickRecord) -> float:
        return 1.0 - min(float(np.linalg.norm(record.balance.com_velocity)), 1.0)

    observation: list[Mapping[str, Any]] = [
        {"name": "base_ang_vel", "scale": [0.3]},
        {"name": "projected_gravity", "scale": [3.0, 3.0, 0.1]},
        {"name": "joint_pos", "scale": [1.0]},
        {"name": "joint_vel", "scale": [0.1]},
    ]
    usual: dict[str, Any] = {
        "scenario": Scenario(initial_behavior="USER"),
        "action": JointTargets(BALANCE_JOINTS),
        "observation": observation,
        "reward": reward,
        "begin": begin,
        "duration": 3.0,
    }
    return AtlasEnv(**usual | changes)


def walk(**changes: Any) -> AtlasEnv:
    """Atlas walks by WALK; the action is its velocity, the reward its speed ahead.

    Args:
        **changes: Other arguments of ``AtlasEnv``.
    """
    usual: dict[str, Any] = {
        "action": WalkVelocity(),
        "observation": ["base_ang_vel", "projected_gravity"],
        "reward": lambda record: float(record.balance.com_velocity[0]),
        "period": WALK_PERIOD,
    }
    return AtlasEnv(**usual | changes)


for _name, _make in ((BALANCE, balance), (WALK, walk)):
    if _name not in gymnasium.registry:
        # Episodes end by their own time, which the observation does not need to tell.
        gymnasium.register(_name, f"{__name__}:{_make.__name__}")
