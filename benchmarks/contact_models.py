"""Compares Drake's contact approximations.

All run the same trials from the same seeds, in turns: the walk and the tutorial of the
other benchmarks, standing with swinging arms, pushes (`contact_trials`). Speed is
measured in one process, in turns as well.
"""

from __future__ import annotations

import argparse
import multiprocessing
import statistics
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace

from contact_trials import DIRECTIONS, INCREMENT, PARTS, Trial, run_trial
from disturbed import Physics, disturbed_simulation, fresh_seed, robots_at_hand
from realtime import PIECE, BarePlant
from report import command_line, write_figures

from atlas_drake.robot import available_robots, load_robot
from atlas_drake.simulation.tutorial import DURATION

APPROXIMATIONS = ("lagged", "similar", "sap")
"""Drake's approximations except tamsi, which Drake no longer recommends."""
TICK = 2
"""Physics steps in a control period."""


def measure_speed(
    model: str, physics: Iterable[Physics], seed: int, duration: float
) -> dict[str, dict[str, float]]:
    """CPU time of tutorial and bare plant, all approximations in turns.

    Args:
        model: The robot's name.
        physics: Physics settings, one per approximation.
        seed: Seed of the robot's random variations.
        duration: Simulated part of the tutorial [s].

    Returns:
        By approximation, medians over the pieces of PIECE seconds.
    """
    sims, plants = {}, {}
    for entry in physics:
        sim = disturbed_simulation(
            seed, model=model, schedule="tutorial", duration=duration, physics=entry
        )
        sims[entry.contact] = sim
        plants[entry.contact] = BarePlant(load_robot(model), sim.scenario)
    closed: dict[str, list[float]] = {name: [] for name in sims}
    bare: dict[str, list[float]] = {name: [] for name in sims}
    pieces = round(duration / PIECE)
    for piece in range(pieces):
        # The order alternates, so that no approximation always finds the same caches.
        turn = list(sims)[piece % len(sims) :] + list(sims)[: piece % len(sims)]
        for name in turn:
            begin = time.process_time()
            sims[name].advance_to((piece + 1) * PIECE)
            middle = time.process_time()
            plants[name].advance(PIECE)
            closed[name].append(middle - begin)
            bare[name].append(time.process_time() - middle)
    first = next(iter(sims))

    def quotient(times: dict[str, list[float]], name: str) -> float:
        pairs = zip(times[name], times[first], strict=True)
        return statistics.median(a / b for a, b in pairs)

    steps = PIECE / sims[first].scenario.physics_step
    return {
        name: {
            "speed bare": statistics.median(bare[name]) / steps,
            "speed closed": statistics.median(closed[name]) / steps,
            "speed bare quotient": quotient(bare, name),
            "speed closed quotient": quotient(closed, name),
            "speed factor": PIECE / statistics.median(closed[name]),
        }
        for name in sims
    }


ROWS: tuple[tuple[str, str, Callable[[list[float]], float], float, str], ...] = (
    ("walk friction max", "friction / Coulomb's bound, walk, max", max, 1.0, ".2f"),
    ("walk friction p99.9", "the same, 99.9 % of contacts", max, 1.0, ".3f"),
    ("walk beyond", "contacts beyond the bound [%]", max, 1e2, ".3f"),
    ("walk slip", "sole's slip in single support, max [mm]", max, 1e3, ".2f"),
    ("walk landing", "landing error of 20 steps, max [mm]", max, 1e3, ".1f"),
    ("walk ok", "walks that succeed [%]", statistics.mean, 1e2, ".0f"),
    ("stand friction max", "friction / bound, arms swing, max", max, 1.0, ".2f"),
    ("stand slip", "sole's slip while arms swing 8 s [mm]", max, 1e3, ".2f"),
    ("stand ok", "stands that succeed [%]", statistics.mean, 1e2, ".0f"),
    ("tutorial ok", "tutorials that succeed [%]", statistics.mean, 1e2, ".0f"),
    ("tutorial landing", "landing error of the tutorial [mm]", max, 1e3, ".1f"),
    ("push ok", "push searches that end [%]", statistics.mean, 1e2, ".0f"),
    *(
        (
            f"push {posture} {direction}",
            f"push borne {posture}, {direction} [N·s]",
            statistics.mean,
            1.0,
            ".0f",
        )
        for posture in INCREMENT
        for direction in DIRECTIONS
    ),
    ("speed bare", "bare plant, CPU [ms per step]", statistics.mean, 1e3, ".3f"),
    ("speed bare quotient", "its quotient to the first", statistics.mean, 1.0, ".2f"),
    ("speed closed", "closed loop, CPU [ms per step]", statistics.mean, 1e3, ".3f"),
    ("speed closed quotient", "its quotient", statistics.mean, 1.0, ".2f"),
    ("speed factor", "real-time factor of CPU time", statistics.mean, 1.0, ".2f"),
)
"""Figure, its name in the table, statistic over all trials, scale and format."""


def table(figures: dict[str, dict[str, list[float]]]) -> list[str]:
    """A table in Markdown: a row per figure, a column per approximation."""
    names = list(figures)
    lines = ["| | " + " | ".join(names) + " |", "| --- |" + " --- |" * len(names)]
    for key, label, reduce, scale, form in ROWS:
        if not any(key in figures[name] for name in names):
            continue
        cells = []
        for name in names:
            values = figures[name].get(key, [])
            cells.append(format(scale * reduce(values), form) if values else "–")
        lines.append(f"| {label} | " + " | ".join(cells) + " |")
    return lines


def compare(
    model: str, physics: list[Physics], parts: list[str], seeds: range, jobs: int
) -> tuple[dict[str, dict[str, list[float]]], bool]:
    """Runs all trials of one robot; after an interruption completed trials count.

    Returns:
        By approximation and figure, a value per seed; and whether all trials were run.
    """
    figures: dict[str, dict[str, list[float]]] = {p.contact: {} for p in physics}

    def add(name: str, values: dict[str, float]) -> None:
        for key, value in values.items():
            figures[name].setdefault(key, []).append(value)

    work = [
        Trial(part, entry, model, seed)
        for part in parts
        if part in PARTS
        for seed in seeds
        for entry in physics
    ]
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"))
    try:
        futures = {pool.submit(run_trial, trial): trial for trial in work}
        for future in as_completed(futures):
            trial = futures[future]
            try:
                values = future.result()
            except Exception as error:  # Of the trial, or of the pool if it died.
                values, text = {f"{trial.part} ok": 0.0}, repr(error)
            else:
                text = ", ".join(f"{k} {v:.4g}" for k, v in values.items())
            add(trial.physics.contact, values)
            print(
                f"{model} {trial.physics.contact:8} seed {trial.seed}  {text}",
                flush=True,
            )
        if "speed" in parts:
            speeds = measure_speed(model, physics, seeds[0], DURATION)
            for name, values in speeds.items():
                add(name, values)
    except KeyboardInterrupt:
        print("Interrupted; what was done counts.")
        return figures, False
    finally:
        pool.shutdown(cancel_futures=True)
    return figures, True


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--runs", type=int, default=3, help="of each part and robot (default: 3)"
    )
    parser.add_argument(
        "--seed", type=int, help="of the first run, then counted up (default: fresh)"
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    parser.add_argument(
        "--model", choices=available_robots(), help="one robot (default: all at hand)"
    )
    parser.add_argument(
        "--physics-step",
        type=float,
        default=Physics.step,
        help=f"[s]; a control period is {TICK} of them (default: %(default)s)",
    )
    parser.add_argument(
        "--parts",
        nargs="+",
        choices=[*PARTS, "speed"],
        default=[*PARTS, "speed"],
        help="what to compare (default: all)",
    )
    options = command_line(parser)
    models = [options.model] if options.model else robots_at_hand()
    first = fresh_seed() if options.seed is None else options.seed
    print(f"Seeds from {first}; again with --seed {first}.", flush=True)
    seeds = range(first, first + options.runs)
    step = options.physics_step
    every = Physics(step=step, period=TICK * step)
    physics = [replace(every, contact=name) for name in APPROXIMATIONS]
    found = {}
    for model in models:
        found[model], complete = compare(
            model, physics, options.parts, seeds, options.jobs
        )
        print(f"\n{model}, physics step {1e3 * step:g} ms")
        print("\n".join(table(found[model])) + "\n", flush=True)
        if not complete:
            break
    write_figures(
        options.json, {"first_seed": first, "physics_step": step, "figures": found}
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
