"""Twenty steps on each robot, with random variations.

Steps are streamed as by a script: four at a time, on request of the robot. A walk may
have a push; ``pushes`` measures the largest one.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
from dataclasses import dataclass

import numpy as np
from disturbed import disturbed_simulation, falls, fresh_seed, robots_at_hand
from parallel import Outcome, run_in_processes
from report import command_line, write_figures

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
)
from atlas_drake.robot import available_robots

NUM_STEPS = 20
STEP_LENGTH = 0.25
"""Distance from one footprint to the next; the last step puts the feet side by side
[m]."""
STEP_DURATION = 0.63
"""[s]"""
SWING_HEIGHT = 0.1
"""[m]"""
QUEUE = 4
"""Steps per message."""
STANDING = 1.0
"""Time in STAND before the first step, and after the last [s]."""
LONGEST = 25.0
"""Longest time of a walk [s]."""
POLL = 0.05
"""Time between checks for a request of the robot [s]."""
LANDING_GOAL = 0.02
"""Goal: largest landing error of a foot [m]."""

PUSH_DURATION = 0.1
"""[s]"""
PUSH_EARLIEST = 6.0
"""Earliest time of a push, which begins within two steps after it [s]."""
DIRECTIONS = {
    "forward": (1.0, 0.0),
    "backward": (-1.0, 0.0),
    "left": (0.0, 1.0),
    "right": (0.0, -1.0),
}
"""Directions of the pushes, in the frame in which the robot walks along x."""


@dataclass(frozen=True)
class Push:
    """A push on the chest: its impulse [N·s] and its direction, one of DIRECTIONS.

    It begins within two steps after ``earliest`` [s].
    """

    impulse: float
    direction: str
    earliest: float = PUSH_EARLIEST


@dataclass(frozen=True)
class Job:
    """One walk: the robot's name, the seed, and an optional push."""

    model: str
    seed: int
    push: Push | None = None
    num_steps: int = NUM_STEPS


def plan(
    sim: AtlasSimulation, num_steps: int = NUM_STEPS
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
        distance = STEP_LENGTH * min(i + 1, num_steps - 1)
        place = (left, right)[i % 2] + distance * ahead
        step = AtlasBehaviorStepData()
        step.step_index = i + 1
        step.foot_index = i % 2
        step.duration = STEP_DURATION
        step.swing_height = SWING_HEIGHT
        step.pose.position.x, step.pose.position.y = map(float, place)
        step.pose.orientation.z = math.sin(0.5 * heading)
        step.pose.orientation.w = math.cos(0.5 * heading)
        steps.append(step)
    return steps, heading


def walk_once(job: Job) -> dict:
    """One walk from STAND to STAND."""
    return walk(disturbed_simulation(job.seed, model=job.model), job)


def walk(sim: AtlasSimulation, job: Job) -> dict:
    """The walk of a robot that stands; its record."""
    sim.advance(STANDING)
    steps, heading = plan(sim, job.num_steps)
    push_time = math.inf
    if job.push is not None:
        latest = job.push.earliest + 2.0 * STEP_DURATION
        push_time = random.Random(job.seed).uniform(job.push.earliest, latest)
    sent = 0
    while not sim.has_fallen and sim.time < LONGEST:
        feedback = sim.atlas_sim_interface_state.walk_feedback
        needed = feedback.next_step_index_needed if sent else 1
        # Send no steps while the robot has enough of them.
        if sent < job.num_steps and needed - feedback.current_step_index <= QUEUE:
            queue = steps[needed - 1 : needed - 1 + QUEUE]
            command = AtlasSimInterfaceCommand()
            command.behavior = command.WALK
            for place, step in enumerate(queue):
                command.walk_params.step_queue[place] = step
            sim.publish(command)
            sent = queue[-1].step_index
        target = sim.time + POLL
        if sim.time < push_time <= target:
            sim.advance_to(push_time)
            strike(sim, job.push, heading)
            push_time = math.inf
        sim.advance_to(target)
        if sent == job.num_steps and sim.current_behavior is Behavior.STAND:
            break
    if not sim.has_fallen:
        sim.advance(STANDING)
    landed = [step["error_m"] for step in sim.footsteps]
    problems = falls(sim)
    if not problems and sim.current_behavior is not Behavior.STAND:
        problems.append(f"ended in {sim.current_behavior.name}")
    if len(landed) != job.num_steps:
        problems.append(f"{len(landed)} steps taken")
    # After a push the robot may change the landing place to keep its balance.
    if job.push is None and max(landed, default=0.0) > LANDING_GOAL:
        problems.append(f"foot landed {1e3 * max(landed):.1f} mm off")
    return {
        "model": job.model,
        "seed": job.seed,
        "ok": not problems,
        "problems": problems,
        "steps": len(landed),
        "landing_error_m": max(landed, default=None),
        "max_pelvis_tilt_rad": sim.summary()["max_pelvis_tilt_rad"],
    }


def strike(sim: AtlasSimulation, push: Push, heading: float) -> None:
    """Gives the push now to a robot with that heading [rad]."""
    x, y = DIRECTIONS[push.direction]
    force = push.impulse / PUSH_DURATION
    c, s = math.cos(heading), math.sin(heading)
    force_W = [force * (c * x - s * y), force * (s * x + c * y), 0.0]
    sim.apply_push(sim.robot.file.chest, force_W, PUSH_DURATION)


def as_record(outcome: Outcome) -> dict:
    """Makes the record of a walk, also of a crashed one."""
    if outcome.error is None:
        return outcome.result
    job = outcome.item
    return {
        "model": job.model,
        "seed": job.seed,
        "ok": False,
        "problems": [outcome.error],
        "landing_error_m": None,
    }


def walk_all(models: list[str], seeds: range, jobs: int) -> list[dict]:
    """Runs walks without pushes; after an interruption completed walks count."""
    records: list[dict] = []
    work = [Job(model, seed) for model in models for seed in seeds]
    try:
        for outcome in run_in_processes(walk_once, work, jobs):
            record = as_record(outcome)
            records.append(record)
            verdict = (
                "ok" if record["ok"] else "FAILED: " + "; ".join(record["problems"])
            )
            error = record["landing_error_m"]
            feet = "" if error is None else f"feet {1e3 * error:4.1f} mm  "
            print(
                f"{len(records):3}/{len(work)}  {record['model']:8} seed"
                f" {record['seed']}  {feet}{verdict}",
                flush=True,
            )
    except KeyboardInterrupt:
        print("Interrupted; what was done counts.")
    return records


def main() -> int:
    """The command line; status 1 when a walk failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=20, help="per robot (default: 20)")
    parser.add_argument(
        "--seed", type=int, help="of the first run, then counted up (default: fresh)"
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    parser.add_argument(
        "--model", choices=available_robots(), help="one robot (default: all at hand)"
    )
    options = command_line(parser)
    models = [options.model] if options.model else robots_at_hand()
    first = fresh_seed() if options.seed is None else options.seed
    print(f"Seeds from {first}; again with --seed {first}.", flush=True)
    seeds = range(first, first + options.runs)
    records = walk_all(models, seeds, options.jobs)
    result = {"first_seed": first, "records": records}
    for model in models:
        mine = [record for record in records if record["model"] == model]
        good = sum(record["ok"] for record in mine)
        errors = [r["landing_error_m"] for r in mine if r["landing_error_m"]]
        print(
            f"{model}: {good} of {len(mine)} walks, feet at most"
            f" {1e3 * max(errors, default=0.0):.1f} mm off"
        )
        failed = [str(record["seed"]) for record in mine if not record["ok"]]
        if failed:
            print("  failing seeds: " + ", ".join(failed))
    complete = len(records) == len(models) * options.runs and all(
        record["ok"] for record in records
    )
    write_figures(options.json, result)
    return 0 if complete else 1


if __name__ == "__main__":
    sys.exit(main())
