"""Measures the time from a fresh process to the first simulated step.

Counts the interpreter's own start, the import and the building of the diagram.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time

from report import command_line, write_figures

RUNS = 5
GOAL = 0.5
"""[s]"""
# The monotonic clock is the same in both processes.
CHILD = """
import sys, time
begin = time.monotonic()
import atlas_drake
imported = time.monotonic()
sim = atlas_drake.AtlasSimulation()
sim.advance(sim.scenario.physics_step)
stepped = time.monotonic()
start = float(sys.argv[1])
print(begin - start, imported - begin, stepped - imported, stepped - start)
"""
PARTS = ("interpreter", "import", "first_step", "total")


def measure_once() -> dict[str, float]:
    """One fresh process; times of its parts [s]."""
    command = [sys.executable, "-c", CHILD, repr(time.monotonic())]
    answer = subprocess.run(command, check=True, capture_output=True, text=True)
    return dict(zip(PARTS, map(float, answer.stdout.split()), strict=True))


def main() -> int:
    """The command line; status 1 when the goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=RUNS)
    options = command_line(parser)
    runs = [measure_once() for _ in range(options.runs)]
    median = {part: statistics.median(run[part] for run in runs) for part in PARTS}
    met = median["total"] <= GOAL
    for part in PARTS:
        print(f"{part.replace('_', ' '):12} {median[part]:5.2f} s")
    print(f"goal <= {GOAL:g} s: {'met' if met else 'NOT MET'}")
    write_figures(options.json, {"median_s": median, "runs_s": runs})
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
