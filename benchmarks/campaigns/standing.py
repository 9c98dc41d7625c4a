"""A push on a robot that does not walk as a trial: in STAND, MANIPULATE or STEP.

Limits are in ``standing_pushes.yaml``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from atlas_drake import (
    AtlasBehaviorPelvisServoParams,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
)
from atlas_drake.messages import StepStatus, Vector3

STANDING = 1.5
"""Time in STAND before the push, and at the end [s]."""
PUSH_DURATION = 0.15
"""[s]"""
LONGEST = 15.0
"""A robot that does not stand again by then never will [s]."""
POLL = 0.25
"""Time between looks at the robot [s]."""
POSES = {
    "pelvis_height": (-0.12, 0.0),
    "pelvis_yaw": (-0.3, 0.3),
    "pelvis_roll": (-0.15, 0.15),
    "pelvis_pitch": (-0.1, 0.3),
    "com_v0": (-0.06, 0.06),
    "com_v1": (-0.04, 0.04),
}
"""What MANIPULATE is asked for, the height from that of standing [m], [rad]."""
IN_THE_AIR = StepStatus.SUBSTATE_STEPPING
BENDING = 3.0
"""Time for a pose [s]."""
STEP_AHEAD, STEP_ASIDE, STEP_LATER = (-0.1, 0.2), (-0.02, 0.1), (0.1, 0.8)
"""Where STEP puts a foot, from its place [m]; time from lift-off to the push [s]."""


def pushed(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, bool]:
    """A push on the chest of the robot in a behavior, at a pose or step of its seed.

    Args:
        sim: A robot that stands.
        parameters: ``behavior``; ``speed``, impulse over the robot's mass [m/s], and
            ``direction`` [rad], 0 along x of the world.

    Returns:
        Whether the robot stands in the end.
    """
    random = np.random.default_rng(sim.scenario.seed)
    behavior = Behavior[parameters["behavior"]]
    sim.advance(STANDING)
    if behavior is Behavior.MANIPULATE:
        _bend(sim, random)
    elif behavior is Behavior.STEP:
        _lift_a_foot(sim, random)
    force = float(parameters["speed"]) * sim.robot.mass / PUSH_DURATION
    direction = float(parameters["direction"])
    force_W = [force * math.cos(direction), force * math.sin(direction), 0.0]
    sim.apply_push("trunk", force_W, PUSH_DURATION)
    sim.advance(1.0)
    # A robot at the edge of its soles may stay there for a second before it steps.
    calm = 0.0
    while calm < STANDING and not sim.has_fallen and sim.time < LONGEST:
        sim.advance(POLL)
        calm = 0.0 if _is_busy(sim) else calm + POLL
    return {"stands": calm >= STANDING and not sim.has_fallen}


def _is_busy(sim: AtlasSimulation) -> bool:
    """Returns True while the robot walks, or has a foot in the air."""
    if sim.current_behavior is Behavior.STEP:
        flags = sim.atlas_sim_interface_state.step_feedback.status_flags
        return bool(flags == IN_THE_AIR)
    return sim.current_behavior is Behavior.WALK


def _bend(sim: AtlasSimulation, random: np.random.Generator) -> None:
    """Takes a pose of the pelvis."""
    command = AtlasSimInterfaceCommand(behavior=Behavior.MANIPULATE)
    command.manipulate_params.use_desired = True
    pose = {name: float(random.uniform(*ends)) for name, ends in POSES.items()}
    pose["pelvis_height"] += float(sim.pelvis_pose.translation()[2])
    command.manipulate_params.desired = AtlasBehaviorPelvisServoParams(**pose)
    sim.publish(command)
    sim.advance(BENDING)


def _lift_a_foot(sim: AtlasSimulation, random: np.random.Generator) -> None:
    """Begins a step, and is in the middle of it."""
    foot = int(random.integers(2))
    command = AtlasSimInterfaceCommand(behavior=Behavior.STEP)
    command.step_params.use_spec = True
    spec = command.step_params.desired_step_spec
    spec.step_index, spec.foot_index = 1, foot
    there = sim.atlas_sim_interface_state.foot_pos_est[foot].position
    ahead, aside = random.uniform(*STEP_AHEAD), random.uniform(*STEP_ASIDE)
    outward = aside if foot == 0 else -aside
    spec.foot.position = Vector3(there.x + ahead, there.y + outward, there.z)
    sim.publish(command)
    while not _is_busy(sim):
        sim.advance(0.01)
    sim.advance(float(random.uniform(*STEP_LATER)))
