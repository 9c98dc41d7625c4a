"""Imported robots: twenty steps, pushes, and speed.

The limits are in ``robots.yaml``, ``robot_pushes.yaml`` and ``robot_speeds.yaml``.

    python benchmarks/campaigns/robots.py

imports them into ``build/robots`` first. They come with
``pip install "atlas-drake[robots]"``.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from atlas_drake import AtlasSimulation, Behavior, StepStream, steps_ahead
from atlas_drake.behaviors.scaling import ATLAS
from atlas_drake.clients.cli.main import main
from atlas_drake.units import GRAVITY

ROBOTS = ("talos", "g1", "icub", "romeo", "jvrc", "alexander")
FOLDER = Path(__file__).parents[2] / "build" / "robots"

NUM_STEPS = 20
STRIDE = 0.25
"""Of a robot of Atlas' height, from one foot to the next [m]."""
STANDING = 1.5
"""Time in STAND before the first step or push, and at the end [s]."""
PUSH_DURATION = 0.1
"""[s]"""
FAST_WAY, FAST_FROM, FAST_TO = 7.0, 2.5, 5.0
"""Way of a fast walk, and the part of it in which its speed is measured, in heights of
the center of mass [-]."""
PUSHED_WALK = 8
"""Steps of a walk with a push, which comes somewhere in two steps after the third."""
LONGEST = 30.0
"""What is not over by then never will be [s]."""
POLL = 0.05
DIRECTIONS = {"forward": 0.0, "left": 0.5, "backward": 1.0, "right": 1.5}
"""Of the pushes, in half turns from ahead [-]."""


def trial(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Walks, or stands, and is pushed.

    Args:
        sim: A robot that stands.
        parameters: ``walks``; and for a push its ``speed``, impulse over the robot's
            mass [m/s], and ``direction``.

    Returns:
        Whether the robot stands in the end, and has taken all its steps.
    """
    sim.advance(STANDING)
    pushed, walks = "speed" in parameters, bool(parameters["walks"])
    steps = (PUSHED_WALK if pushed else NUM_STEPS) if walks else 0
    gait = sim.scenario.controller_config().gait()
    push_time = sim.time if pushed else math.inf
    end = sim.time
    stream = None
    if walks:
        longest = gait.longest_stride
        stride = min(STRIDE * sim.robot.com_height / ATLAS.height, longest)
        gait = sim.scenario.controller_config().gait(stride=stride)
        report = sim.atlas_sim_interface_state
        stream = StepStream(steps_ahead(report, stride * (steps - 1), gait))
        if pushed:
            moment = random.Random(sim.scenario.seed).uniform(4.0, 6.0)
            push_time = sim.time + moment * gait.duration
    while not sim.has_fallen and sim.time < LONGEST:
        if sim.time >= push_time:
            angle = math.pi * DIRECTIONS[str(parameters["direction"])]
            force = float(parameters["speed"]) * sim.robot.mass / PUSH_DURATION
            force_W = [force * math.cos(angle), force * math.sin(angle), 0.0]
            sim.apply_push("trunk", force_W, PUSH_DURATION)
            push_time, end = math.inf, sim.time + STANDING
        over = stream is None or stream.is_over(sim.atlas_sim_interface_state)
        if over and push_time == math.inf and sim.time >= end and _stands(sim):
            break
        if stream is not None:
            sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance_to(min(sim.time + POLL, max(push_time, sim.time + 1e-6)))
    if not sim.has_fallen:
        sim.advance(STANDING)
    taken = {step["index"] for step in sim.footsteps}
    return {
        "stands": _stands(sim),
        "all_steps": taken.issuperset(range(1, steps + 1)),
    }


def speed(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Walks ahead at a speed of a ``froude`` number v²/(g·h).

    Args:
        sim: A robot that stands.
        parameters: ``froude`` [-].

    Returns:
        Whether the robot stands in the end, the ``speed`` [m/s] of the middle of the
        walk, and its ``froude_number`` [-].
    """
    sim.advance(STANDING)
    h, gait = sim.robot.com_height, sim.scenario.controller_config().gait()
    desired = math.sqrt(float(parameters["froude"]) * GRAVITY * h)
    report = sim.atlas_sim_interface_state
    stream = StepStream(steps_ahead(report, FAST_WAY * h, gait, desired))
    begin = float(sim.pelvis_pose.translation()[0])
    passed: list[tuple[float, float]] = []
    while not (sim.has_fallen or stream.is_over(sim.atlas_sim_interface_state)):
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance(POLL)
        way = float(sim.pelvis_pose.translation()[0]) - begin
        if FAST_FROM * h < way < FAST_TO * h:
            passed.append((sim.time, way))
    reached = 0.0
    if len(passed) > 1:
        (t0, x0), (t1, x1) = passed[0], passed[-1]
        reached = (x1 - x0) / (t1 - t0)
    return {
        "stands": _stands(sim),
        "speed": reached,
        "froude_number": reached**2 / (GRAVITY * h),
    }


def _stands(sim: AtlasSimulation) -> bool:
    return sim.current_behavior is Behavior.STAND and not sim.has_fallen


def import_all() -> None:
    """Imports the robots that are not there yet."""
    for name in ROBOTS:
        if not (FOLDER / name / "robot.yaml").exists():
            main(["import", name, "--out", str(FOLDER / name), "--no-trial"])


if __name__ == "__main__":
    import_all()
