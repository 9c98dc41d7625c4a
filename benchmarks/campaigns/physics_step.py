"""What the physics step decides as trials: stiff gains of the user, and a crate.

A longer step is faster, and a joint controller in it acts later. The other figures that
a step may change are those of ``push_moments.yaml``, ``bricks.yaml``, ``stairs.yaml``
and ``tutorial.yaml`` with ``--set physics_step=...``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from walking import walk

from atlas_drake import K_EFFORT_MAX, AtlasCommand, AtlasSimulation
from atlas_drake.simulation.tutorial import USER_TARGETS

SWING, SWING_TIME, SWINGS = 0.3, 1.0, 6
"""The user's set-points jump by SWING [rad] to both sides, every SWING_TIME [s]."""


def stiff_arms(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Stands while the user moves the arms with several times the tutorial's gains.

    Args:
        sim: A robot that stands.
        parameters: ``gain``, the factor of the tutorial's gains.

    Returns:
        Whether the robot stands, and the largest speed of the user's joints at the end
        of a swing [rad/s].
    """
    gain, robot = float(parameters["gain"]), sim.robot
    joints = np.array([robot.joint_index(name) for name in USER_TARGETS])
    state = sim.atlas_state
    factor = np.ones(robot.num_joints)
    factor[joints] = gain
    share = np.zeros(robot.num_joints)
    share[joints] = K_EFFORT_MAX
    speed = 0.0
    for swing in range(SWINGS):
        jump = np.where(share > 0.0, SWING if swing % 2 else -SWING, 0.0)
        command = AtlasCommand()
        command.position = list(np.array(state.position) + jump)
        command.kp_position = list(factor * state.kp_position)
        command.kp_velocity = list(factor * state.kp_velocity)
        command.kd_position = list(factor * state.kd_position)
        command.k_effort = [int(k) for k in share]
        sim.publish(command)
        sim.advance(SWING_TIME)
        if sim.has_fallen:
            break
        speed = max(speed, float(np.abs(sim.atlas_state.velocity)[joints].max()))
    return {"stands": not sim.has_fallen, "user_speed": speed}


def push_crate(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Walks into a crate, and pushes it along.

    Returns:
        What the walk returns, and how far the crate has gone [m].
    """
    crate = sim.plant.GetBodyByName("crate")
    context = sim.plant.GetMyContextFromRoot(sim.simulator.get_context())

    def place() -> float:
        return float(crate.EvalPoseInWorld(context).translation()[0])

    before = place()
    return {**walk(sim, parameters), "pushed": place() - before}
