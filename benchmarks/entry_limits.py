"""Measures the states from which STAND recovers, to check its entry conditions.

The robot starts in STAND with its center of mass displaced or moving, or its arms
moving. It must survive more than the conditions allow.
"""

from __future__ import annotations

import argparse
import logging
import sys
from dataclasses import dataclass

import numpy as np
from parallel import run_in_processes
from report import command_line, write_figures

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
)
from atlas_drake.behaviors.entry_limits import EntryLimits
from atlas_drake.control.whole_body.model import WholeBodyModel

DIRECTIONS = {
    "forward": (1.0, 0.0),
    "backward": (-1.0, 0.0),
    "left": (0.0, 1.0),
    "right": (0.0, -1.0),
}
WATCHED = 2.0
"""Simulated time of a start [s]."""
REPLICATES = 2
"""Starts with other small disturbances, all of which must be survived."""
KINDS = {
    "position": ("center of mass aside", 0.03, 0.18, "m"),
    "velocity": ("center of mass moving", 0.1, 0.8, "m/s"),
    "joints": ("arm joints moving", 4.0, 16.0, "rad/s"),
}
"""By kind: description, increment, largest value tried, unit."""


@dataclass(frozen=True)
class Start:
    """One start."""

    model: str
    kind: str
    direction: tuple[float, float]
    amount: float
    seed: int


def survives(start: Start) -> bool:
    """Returns True if a robot that is already in STAND stands at the end."""
    sim = _begin(start, "STAND")
    sim.advance(WATCHED)
    return not sim.has_fallen


def lets_in(start: Start) -> bool:
    """Returns True if STAND can be entered from this start."""
    sim = _begin(start, "USER")
    stand = AtlasSimInterfaceCommand(behavior=Behavior.STAND)
    stand.k_effort = [0] * sim.robot.num_joints
    sim.publish(stand)
    sim.advance(2.0 * sim.scenario.control_period)
    return sim.current_behavior is Behavior.STAND


def _begin(start: Start, behavior: str) -> AtlasSimulation:
    for name in ("drake", "atlas_drake"):
        logging.getLogger(name).setLevel(logging.ERROR)
    sim = AtlasSimulation(
        Scenario(model=start.model, seed=start.seed, initial_behavior=behavior)
    )
    aim = start.amount * np.array(start.direction)
    _displace(sim, start, aim, np.random.default_rng(start.seed))
    return sim


def _displace(
    sim: AtlasSimulation, start: Start, aim: np.ndarray, random: np.random.Generator
) -> None:
    """Moves the CoM over planted feet, or sets it or the arms in motion."""
    robot, plant = sim.robot, sim.plant
    context = plant.GetMyMutableContextFromRoot(sim.context)
    model = WholeBodyModel(robot)
    scratch = model.create_context()
    order = robot.indices(plant).generalized
    state = plant.GetPositionsAndVelocities(context).copy()
    num_q = plant.num_positions()

    def motion(com_velocity: np.ndarray) -> np.ndarray:
        """Least generalized velocity of that CoM motion, feet and pelvis' tilt kept."""
        terms = model.evaluate(scratch, state)
        upright = np.eye(3, len(order))
        feet = [foot.J_WF for foot in terms.feet]
        rows = np.vstack([*feet, terms.M[3:6] / robot.mass, upright])
        wanted = np.concatenate([np.zeros(12), com_velocity, [0.0], np.zeros(3)])
        velocity = np.zeros(len(order))
        velocity[order] = np.linalg.lstsq(rows, wanted, rcond=None)[0]
        return velocity

    jitter = 0.005 * random.normal(size=2)
    steps = 20
    shift = (aim if start.kind == "position" else np.zeros(2)) + jitter
    for _ in range(steps):
        plant.SetPositionsAndVelocities(context, state)
        rate = plant.MapVelocityToQDot(context, motion(shift / steps))
        state[:num_q] += rate
        state[:4] /= np.linalg.norm(state[:4])
    if start.kind == "velocity":
        state[num_q:] = motion(aim)
    elif start.kind == "joints":
        arms = np.flatnonzero(robot.limb("l_arm", "r_arm"))
        signs = random.choice([-1.0, 1.0], len(arms))
        state[num_q + robot.indices(plant).v[arms]] = start.amount * signs
    plant.SetPositionsAndVelocities(context, state)
    sim.simulator.Initialize()


def largest(
    model: str, kind: str, direction: str, first_seed: int, jobs: int
) -> tuple[float, bool]:
    """Finds the largest amount up to which every start is survived; 0 if none is.

    Returns:
        That amount, and True if STAND can be entered from the next one.
    """
    _, increment, most, _ = KINDS[kind]
    too_much = False
    borne = 0.0
    while borne + increment <= most + 1e-9:
        amount = borne + increment
        starts = [
            Start(model, kind, DIRECTIONS[direction], amount, first_seed + k)
            for k in range(REPLICATES)
        ]
        outcomes = run_in_processes(survives, starts, jobs)
        if not all(outcome.result for outcome in outcomes):
            too_much = any(o.result for o in run_in_processes(lets_in, starts, jobs))
            break
        borne = amount
    return borne, too_much


def main() -> int:
    """The command line; status 1 when a condition lets in what is not survived."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--model", default="atlas")
    parser.add_argument("--seed", type=int, default=1, help="of the first start")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    options = command_line(parser)
    found: dict[str, dict[str, float]] = {}
    met = True
    for kind, (what, _, most, unit) in KINDS.items():
        names = list(DIRECTIONS) if kind != "joints" else ["forward"]
        found[kind] = {}
        for name in names:
            amount, too_much = largest(
                options.model, kind, name, options.seed, options.jobs
            )
            found[kind][name] = amount
            met = met and not too_much
            more = " and more" if amount >= most - 1e-9 else ""
            more += "; MORE IS LET IN" if too_much else ""
            where = f", {name}" if kind != "joints" else ""
            print(f"{what}{where}: {amount:.2f} {unit}{more}", flush=True)
    print(f"Conditions: {EntryLimits()}")
    print(f"goal: let in nothing that was not survived, {'NOT ' * (not met)}met")
    write_figures(options.json, {"largest_survived": found})
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
