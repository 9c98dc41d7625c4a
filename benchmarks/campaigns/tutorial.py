"""The tutorial as a trial: where the user's joints come to rest.

A trial succeeds when all that the tutorial asks for was done: nobody fell, the feet
landed where they were sent, and the user's joints came to rest where their own gains
let them. The limits are in ``tutorial.yaml``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from atlas_drake import AtlasSimulation
from atlas_drake.simulation.tutorial import DURATION, USER_TARGETS

LOOKS = {"before": "Walking", "after": "home"}
"""By the look's name, a word of the command that ends the time to settle."""
MARGIN = 0.01
"""The joints are looked at this long before that command [s]."""


def settling_errors(sim: AtlasSimulation) -> dict[str, float]:
    """Distance of the user's joints from where gravity lets their gains hold them.

    A joint with no integral gain rests where kp·(set-point − q) carries the weight
    that hangs on it: that of the real masses, at the pose of this moment.

    Returns:
        By joint [rad].
    """
    plant, robot = sim.plant, sim.robot
    context = plant.GetMyContextFromRoot(sim.simulator.get_context())
    gravity = plant.CalcGravityGeneralizedForces(context)
    positions = plant.GetPositions(context)
    indices = robot.indices(plant)
    gains = sim.atlas_state.kp_position
    errors = {}
    for name, target in USER_TARGETS.items():
        joint = robot.joint_index(name)
        set_point = np.clip(
            target, robot.position_lower[joint], robot.position_upper[joint]
        )
        rest = set_point + gravity[indices.v[joint]] / gains[joint]
        errors[name] = float(abs(positions[indices.q[joint]] - rest))
    return errors


def tutorial(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, float]:
    """Simulates the tutorial to its end.

    Returns:
        The largest settling errors, before and after the walk [rad].
    """
    schedule = sim.diagram.GetSubsystemByName("scheduler").schedule
    worst = {}
    for look, word in LOOKS.items():
        command = next(entry for entry in schedule if word in entry.text)
        sim.advance_to(command.time - MARGIN)
        worst[f"settling_{look}_rad"] = max(settling_errors(sim).values())
    sim.advance_to(DURATION)
    return worst
