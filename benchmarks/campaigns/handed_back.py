"""A robot that its user hands back in the middle of a stride, as a trial.

The user takes all joints of the walking robot and plays on what they would have done;
then STAND gets them back, perhaps with a push at the same moment. The moments are in
``handed_back.yaml``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    walk_at,
)

PERIOD = 0.02
"""Of the user's commands [s]."""
HELD = 0.2
"""Time for which the user has the joints [s]."""
STEERED = 0.1
"""Period of steering the walk before [s]."""
PUSH_DURATION = 0.1
"""[s]"""
WATCHED = 6.0
"""Time after which the robot should stand [s]."""
QUIET = 0.04
"""Largest speed of the CoM of a robot at rest [m/s]."""


def handed_back(
    sim: AtlasSimulation, parameters: Mapping[str, Any]
) -> dict[str, bool | float]:
    """Walks, lets the user have all joints, and gives them back to STAND.

    Returns:
        Whether the robot ``stands``, and the time until it is ``quiet`` [s] if it is.
    """
    moment, speed = float(parameters["moment"]), float(parameters["speed"])
    gait = sim.scenario.controller_config().gait()
    while sim.time < moment - 1e-9:
        sim.publish(walk_at(sim.atlas_sim_interface_state, forward=speed, gait=gait))
        sim.advance_to(min(sim.time + STEERED, moment))
    here, motion = sim.snapshot(), []
    while sim.time < moment + HELD - 1e-9:
        sim.advance(PERIOD)
        motion.append((sim.atlas_state.position, sim.atlas_state.velocity))
    sim.restore(here)
    sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.USER))
    for position, velocity in motion:
        sim.publish(
            AtlasCommand(
                position=position,
                velocity=velocity,
                kp_velocity=sim.robot.default_kd,
                k_effort=[255] * sim.robot.num_joints,
            )
        )
        sim.advance(PERIOD)
    none = [0] * sim.robot.num_joints
    sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND, k_effort=none))
    given = sim.time
    size = float(parameters["push"]) * sim.robot.mass / PUSH_DURATION
    angle = float(parameters["direction"])
    if size:
        force = [size * math.cos(angle), size * math.sin(angle), 0.0]
        sim.apply_push("trunk", force, PUSH_DURATION)
    result: dict[str, bool | float] = {}
    while sim.time < given + WATCHED and not sim.has_fallen:
        sim.advance(STEERED)
        speed = max(abs(v) for v in sim.record.balance.com_velocity)
        if sim.current_behavior is Behavior.STAND and speed < QUIET:
            result.setdefault("quiet", sim.time - given)
    stands = sim.current_behavior is Behavior.STAND and not sim.has_fallen
    return {"stands": stands, **result}
