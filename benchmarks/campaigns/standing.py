"""A push on the standing robot as a trial; limits are in ``standing_pushes.yaml``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from atlas_drake import AtlasSimulation, Behavior

STANDING = 1.5
"""Time in STAND before the push, and at the end [s]."""
PUSH_DURATION = 0.15
"""[s]"""
LONGEST = 15.0
"""A robot that does not stand again by then never will [s]."""
POLL = 0.25
"""Time between looks at the robot [s]."""


def pushed(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, bool]:
    """A push on the chest of the robot in STAND.

    Args:
        sim: A robot that stands.
        parameters: ``speed``, impulse over the robot's mass [m/s], and ``direction``
            [rad], 0 along x of the world.

    Returns:
        Whether the robot stands in the end.
    """
    sim.advance(STANDING)
    force = float(parameters["speed"]) * sim.robot.mass / PUSH_DURATION
    direction = float(parameters["direction"])
    force_W = [force * math.cos(direction), force * math.sin(direction), 0.0]
    sim.apply_push("trunk", force_W, PUSH_DURATION)
    sim.advance(1.0)
    while not sim.has_fallen and sim.time < LONGEST:
        if sim.current_behavior is Behavior.STAND:
            break
        sim.advance(POLL)
    if not sim.has_fallen:
        sim.advance(STANDING)
    return {"stands": not sim.has_fallen and sim.current_behavior is Behavior.STAND}
