"""Finds the largest push on the chest that the walking robots withstand.

A threshold from a single walk is random: every impulse is tried at several phases of
the step, and only counts if all smaller impulses pass.
"""

from __future__ import annotations

import argparse
import sys

from disturbed import fresh_seed, robots_at_hand
from parallel import run_in_processes
from report import command_line, write_figures
from walking import DIRECTIONS, Job, Push, as_record, walk_once

from atlas_drake.robot import available_robots

INCREMENT = 10.0
"""Increment of the impulse [N·s]."""
TRIALS = 5
PASSES = 4
"""Walks out of TRIALS that must not end in a fall."""


def largest_push(model: str, direction: str, seeds: range, jobs: int) -> float:
    """Finds the largest impulse up to which all pass [N·s]; 0 if none does."""
    borne = 0.0
    while True:
        impulse = borne + INCREMENT
        work = [Job(model, seed, Push(impulse, direction)) for seed in seeds]
        passes = fails = 0
        for outcome in run_in_processes(walk_once, work, jobs):
            ok = as_record(outcome)["ok"]
            passes, fails = passes + ok, fails + (not ok)
            # The rest cannot change the verdict.
            if passes >= PASSES or fails > TRIALS - PASSES:
                break
        verdict = "borne" if passes >= PASSES else "too much"
        print(f"{model:8} {direction:8} {impulse:3.0f} N·s  {verdict}", flush=True)
        if passes < PASSES:
            return borne
        borne = impulse


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seed", type=int, help="of the first walk, then counted up (default: fresh)"
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    parser.add_argument(
        "--model", choices=available_robots(), help="one robot (default: all at hand)"
    )
    parser.add_argument(
        "--direction", choices=DIRECTIONS, help="one direction (default: all)"
    )
    options = command_line(parser)
    models = [options.model] if options.model else robots_at_hand()
    directions = [options.direction] if options.direction else list(DIRECTIONS)
    first = fresh_seed() if options.seed is None else options.seed
    print(f"Seeds from {first}; again with --seed {first}.", flush=True)
    seeds = range(first, first + TRIALS)
    borne: dict[str, dict[str, float]] = {model: {} for model in models}
    try:
        for model in models:
            for direction in directions:
                borne[model][direction] = largest_push(
                    model, direction, seeds, options.jobs
                )
    except KeyboardInterrupt:
        print("Interrupted; what was done counts.")
    for model, impulses in borne.items():
        text = ", ".join(f"{name} {value:.0f}" for name, value in impulses.items())
        print(f"{model}: {text or 'nothing done'} [N·s]")
    write_figures(options.json, {"first_seed": first, "largest_impulse_ns": borne})
    return 0


if __name__ == "__main__":
    sys.exit(main())
