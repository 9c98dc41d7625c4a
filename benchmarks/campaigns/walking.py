"""Twenty steps as a trial, each time a little different.

Steps are streamed as a script would: four at a time, when the robot needs them. A walk
may be given a push, at a random moment of two steps. The limits are in
``walking.yaml`` and ``pushes.yaml``.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimulation,
    Behavior,
    StepStream,
)

NUM_STEPS = 20
STEP_LENGTH = 0.25
"""From one foot to the next; the last step puts the feet side by side [m]."""
STEP_DURATION = 0.63
"""[s]"""
SWING_HEIGHT = 0.1
"""[m]"""
STANDING = 1.0
"""Time in STAND before the first step, and after the last [s]."""
LONGEST = 25.0
"""A walk that is not over by then never will be [s]."""
POLL = 0.05
"""Time between looks at what the robot asks for [s]."""

PUSH_DURATION = 0.1
"""[s]"""
PUSH_EARLIEST = 6.0
"""A push begins somewhere within two steps from then on [s]."""
DIRECTIONS = {
    "forward": (1.0, 0.0),
    "backward": (-1.0, 0.0),
    "left": (0.0, 1.0),
    "right": (0.0, -1.0),
}
"""Of the pushes, in the frame in which the robot walks along x."""


@dataclass(frozen=True)
class Push:
    """A blow on the chest: its impulse [N·s] and its direction, one of DIRECTIONS.

    It comes within two steps after ``earliest`` [s].
    """

    impulse: float
    direction: str
    earliest: float = PUSH_EARLIEST


def plan(
    sim: AtlasSimulation,
    num_steps: int = NUM_STEPS,
    length: float = STEP_LENGTH,
    swing_height: float = SWING_HEIGHT,
) -> tuple[list[AtlasBehaviorStepData], float]:
    """Steps straight ahead of the feet, and the heading [rad]."""
    left, right = (
        pose.position.to_array()[:2]
        for pose in sim.atlas_sim_interface_state.foot_pos_est
    )
    # From the right foot to the left one is the robot's y.
    across = (left - right) / np.linalg.norm(left - right)
    ahead = np.array([across[1], -across[0]])
    heading = math.atan2(ahead[1], ahead[0])
    steps = []
    for i in range(num_steps):
        distance = length * min(i + 1, num_steps - 1)
        place = (left, right)[i % 2] + distance * ahead
        step = AtlasBehaviorStepData()
        step.step_index = i + 1
        step.foot_index = i % 2
        step.duration = STEP_DURATION
        step.swing_height = swing_height
        step.pose.position.x, step.pose.position.y = map(float, place)
        step.pose.orientation.z = math.sin(0.5 * heading)
        step.pose.orientation.w = math.cos(0.5 * heading)
        steps.append(step)
    return steps, heading


def walk(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, bool]:
    """A walk from STAND to STAND.

    Args:
        sim: A robot that stands.
        parameters: ``num_steps``, ``step_length`` and ``swing_height`` [m]; and for
            a push its ``impulse`` [N·s], ``direction`` and ``earliest`` time [s].

    Returns:
        Whether the robot stands in the end, and has taken all its steps.
    """
    num_steps = int(parameters.get("num_steps", NUM_STEPS))
    push = push_from(parameters)
    sim.advance(STANDING)
    length = float(parameters.get("step_length", STEP_LENGTH))
    height = float(parameters.get("swing_height", SWING_HEIGHT))
    steps, heading = plan(sim, num_steps, length, height)
    push_time = math.inf
    if push is not None:
        latest = push.earliest + 2.0 * STEP_DURATION
        moment = random.Random(sim.scenario.seed)
        push_time = moment.uniform(push.earliest, latest)
    stream = StepStream(steps)
    while not sim.has_fallen and sim.time < LONGEST:
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        target = sim.time + POLL
        if push is not None and sim.time < push_time <= target:
            sim.advance_to(push_time)
            strike(sim, push, heading)
            push_time = math.inf
        sim.advance_to(target)
        if stream.is_over(sim.atlas_sim_interface_state):
            break
    if not sim.has_fallen:
        sim.advance(STANDING)
    stands = not sim.has_fallen and sim.current_behavior is Behavior.STAND
    # A step that catches the balance repeats an index, or comes after the last one.
    taken = {step["index"] for step in sim.footsteps}
    return {"stands": stands, "all_steps": taken.issuperset(range(1, num_steps + 1))}


def push_from(parameters: Mapping[str, Any]) -> Push | None:
    """The push that the parameters name, if any."""
    if "impulse" not in parameters:
        return None
    earliest = float(parameters.get("earliest", PUSH_EARLIEST))
    return Push(float(parameters["impulse"]), str(parameters["direction"]), earliest)


def strike(sim: AtlasSimulation, push: Push, heading: float) -> None:
    """Gives the push now to a robot with that heading [rad]."""
    x, y = DIRECTIONS[push.direction]
    force = push.impulse / PUSH_DURATION
    c, s = math.cos(heading), math.sin(heading)
    force_W = [force * (c * x - s * y), force * (s * x + c * y), 0.0]
    sim.apply_push("trunk", force_W, PUSH_DURATION)
