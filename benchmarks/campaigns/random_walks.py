"""A walk over random legal steps as a trial; limits are in ``random_walks.yaml``.

A walk is made of legs of a few steps that are alike: ahead, back, aside, round a bend,
narrow or wide, quick or slow. Every step is within the limits of the robot's
configuration, whatever they are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimulation,
    Behavior,
    StepStream,
)
from atlas_drake.control.feet.footstep import limit_duration, outward, saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep
from atlas_drake.planning.footholds import foothold
from atlas_drake.rotations import rotation_z

NUM_STEPS = 25
SLOWEST = 1.5
"""Longest duration of a step, if the limits allow it [s]."""
LEG = (1, 6)
"""Fewest and most steps of a leg."""
STANDING = 1.0
"""Time in STAND before the first step, and after the last [s]."""
POLL = 0.1
"""Time between looks at what the robot asks for [s]."""


@dataclass(frozen=True)
class Leg:
    """What the steps of a leg have in common.

    Attributes:
        ahead: Place of a foot ahead of the stance foot [m].
        widths: Distance of the left and of the right foot from the stance foot [m].
        turn: Turn of each step to the left [rad].
        duration: Duration of a step, if the feet are near enough [s].
        swing_height: Apex of a swing [m].
    """

    ahead: float
    widths: tuple[float, float]
    turn: float
    duration: float
    swing_height: float


def random_leg(
    limits: StepLimits, random: np.random.Generator, slowest: float = SLOWEST
) -> Leg:
    """Draws a leg from all that the limits allow."""
    quickest, longest = limits.duration
    durations = np.log([quickest, max(min(slowest, longest), quickest)])
    return Leg(
        ahead=float(random.uniform(-limits.backward, limits.forward)),
        widths=(
            float(random.uniform(*limits.width)),
            float(random.uniform(*limits.width)),
        ),
        turn=float(random.uniform(-limits.toe_in, limits.toe_in)),
        duration=float(np.exp(random.uniform(*durations))),
        swing_height=float(random.uniform(*limits.swing_height)),
    )


def random_steps(
    feet: Sequence[FootPose],
    limits: StepLimits,
    random: np.random.Generator,
    num_steps: int = NUM_STEPS,
    slowest: float = SLOWEST,
    closes: bool = True,
) -> list[Footstep]:
    """Draws steps within the limits, from these poses of the soles.

    The last step puts the feet side by side, as far apart as they were, if it
    ``closes`` the walk.
    """
    now, apart = list(feet), float(np.hypot(*(feet[0].p_WF - feet[1].p_WF)[:2]))
    foot, left = int(random.choice([LEFT, RIGHT])), 0
    steps: list[Footstep] = []
    while len(steps) < num_steps:
        if left == 0:
            leg = random_leg(limits, random, slowest)
            left = int(random.integers(LEG[0], LEG[1] + 1))
        left -= 1
        start, stance = now[foot], now[1 - foot]
        place, turn = [leg.ahead, outward(foot) * leg.widths[foot], 0.0], leg.turn
        if closes and len(steps) == num_steps - 1:
            place, turn = [0.0, outward(foot) * apart, 0.0], 0.0
        step = Footstep(
            index=len(steps) + 1,
            foot=foot,
            p_WF=stance.p_WF + rotation_z(stance.yaw) @ place,
            yaw=stance.yaw + turn,
            duration=leg.duration,
            swing_height=leg.swing_height,
        )
        step = limit_duration(saturate(step, stance, limits), start, stance, limits)
        steps.append(step)
        now[foot] = step.pose
        foot = 1 - foot
    return steps


def walk(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """A walk over random steps, which follow from the trial's seed.

    Args:
        sim: A robot that stands.
        parameters: ``num_steps``, and ``slowest``, the longest duration of a step [s].

    Returns:
        Whether the robot stands in the end, and has taken all its steps; and the last
        step that began, relative to its stance foot, which tells what felled the robot.
    """
    sim.advance(STANDING)
    limits = sim.scenario.controller_config().walk.limits
    random = np.random.default_rng(sim.scenario.seed)
    num_steps = int(parameters.get("num_steps", NUM_STEPS))
    slowest = float(parameters.get("slowest", SLOWEST))
    feet = feet_of(sim)
    steps = random_steps(feet, limits, random, num_steps, slowest)
    stream = StepStream([message_of(step) for step in steps])
    begun = 0
    while not sim.has_fallen:
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance(POLL)
        report = sim.atlas_sim_interface_state
        begun = min(max(begun, report.walk_feedback.current_step_index), num_steps)
        if stream.is_over(report):
            sim.advance(STANDING)
            break
    stands = not sim.has_fallen and sim.current_behavior is Behavior.STAND
    taken = {footstep["index"] for footstep in sim.footsteps}
    all_steps = taken >= {step.index for step in steps}
    return {"stands": stands, "all_steps": all_steps, **_last(feet, steps, begun)}


def _last(
    feet: Sequence[FootPose], steps: Sequence[Footstep], begun: int
) -> dict[str, float]:
    """Figures of the last step that began, from the pose of its stance foot."""
    if begun == 0:
        return {}
    step = steps[begun - 1]
    stance = steps[begun - 2].pose if begun > 1 else feet[1 - step.foot]
    ahead, left, _ = rotation_z(stance.yaw).T @ (step.p_WF - stance.p_WF)
    return {
        "last_index": begun,
        "last_ahead_m": float(ahead),
        "last_width_m": float(outward(step.foot) * left),
        "last_turn_out_rad": outward(step.foot) * (step.yaw - stance.yaw),
        "last_duration_s": step.duration,
        "last_swing_height_m": step.swing_height,
    }


def feet_of(sim: AtlasSimulation) -> list[FootPose]:
    """Poses of the soles on level ground."""
    places = map(foothold, sim.atlas_sim_interface_state.foot_pos_est)
    return [FootPose(np.array([x, y, 0.0]), rotation_z(yaw)) for x, y, yaw in places]


def message_of(step: Footstep) -> AtlasBehaviorStepData:
    """The message of a step on level ground."""
    message = AtlasBehaviorStepData(
        step_index=step.index,
        foot_index=step.foot,
        duration=step.duration,
        swing_height=step.swing_height,
    )
    message.pose.position.x, message.pose.position.y = map(float, step.p_WF[:2])
    message.pose.orientation.z = math.sin(0.5 * step.yaw)
    message.pose.orientation.w = math.cos(0.5 * step.yaw)
    return message
