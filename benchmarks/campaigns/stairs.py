"""Stairs foot over foot as a trial, up or down; ``stairs.yaml`` repeats it.

Every tread takes one foot, and the last one both. The robot sees no ground: it is told
where the treads are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimulation,
    Behavior,
    StepStream,
)
from atlas_drake.control.feet.footstep import outward
from atlas_drake.messages.footstep import LEFT
from atlas_drake.worlds.obstacles import Stairs

HALF_WIDTH = 0.12
"""Distance of each foot from the middle of the stairs [m]."""
SWING_HEIGHT = 0.1
"""Of steps on level ground; WALK lifts a foot higher where it climbs [m]."""
STANDING = 1.0
"""Time in STAND before the first step, and after the last [s]."""
POLL = 0.1
"""Time between looks at what the robot asks for [s]."""


def climb(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Climbs the stairs of the world, up from their foot or down from their landing.

    Args:
        sim: A robot that stands before the stairs, or on their landing.
        parameters: ``step_duration`` [s]; WALK takes longer where it has to.

    Returns:
        Whether the robot stands in the end, and has taken all steps, each once.
    """
    sim.advance(STANDING)
    stairs = sim.scenario.world.stairs
    steps = steps_over(stairs, float(parameters["step_duration"]))
    stream = StepStream(steps)
    while not sim.has_fallen and not stream.is_over(sim.atlas_sim_interface_state):
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance(POLL)
    if not sim.has_fallen:
        sim.advance(STANDING)
    taken = [footstep["index"] for footstep in sim.footsteps]
    knees = [leg.knee for leg in sim.robot.legs]
    return {
        "stands": not sim.has_fallen and sim.current_behavior is Behavior.STAND,
        "all_steps": taken == [step.step_index for step in steps],
        "knee_peak_share": float(sim.output("peaks")[knees].max()),
    }


def steps_over(stairs: Stairs, duration: float) -> list[AtlasBehaviorStepData]:
    """Makes the steps, left foot first.

    Stairs that lead down have the robot on their landing, and their yaw is π.
    """
    down = math.cos(stairs.yaw) < 0.0
    levels = list(range(stairs.number + 1))
    levels = levels[-2::-1] if down else levels[1:]
    ahead = -1.0 if down else 1.0
    steps = []
    for index, level in enumerate([*levels, levels[-1]], 1):
        step = AtlasBehaviorStepData(
            index, (LEFT + index - 1) % 2, duration=duration, swing_height=SWING_HEIGHT
        )
        x = stairs.position[0] + ahead * (level - 0.5) * stairs.run
        y = outward(step.foot_index) * HALF_WIDTH
        step.pose.position.x, step.pose.position.y = x, y
        step.pose.position.z = level * stairs.rise
        steps.append(step)
    return steps
