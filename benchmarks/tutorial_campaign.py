"""Repeats the tutorial with robots that differ from the controller's model.

A run succeeds if the robot did not fall, the feet landed at the commanded places, and
the user's joints came to rest at the equilibrium of their gains.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable

import numpy as np
from disturbed import disturbed_simulation, falls, fresh_seed
from parallel import Outcome, run_in_processes
from report import command_line, write_figures

from atlas_drake import AtlasSimulation
from atlas_drake.simulation.tutorial import DURATION, USER_TARGETS

LANDING_GOAL = 0.02
"""Goal: largest landing error of a foot [m]."""
SETTLING_GOAL = 0.05
"""Goal: largest distance of a user's joint from the equilibrium of its gains [rad]."""
LOOKS = {"before": "Walking", "after": "home"}
"""By name of the check, a word of the command that ends the time to settle."""
MARGIN = 0.01
"""Time before that command at which the joints are checked [s]."""


def settling_errors(sim: AtlasSimulation) -> dict[str, float]:
    """Computes the distance of the user's joints from the equilibrium of their gains.

    A joint without integral gain rests where kp·(set-point − q) balances the torque of
    gravity, with the real masses, in the present pose.

    Returns:
        Distance by joint [rad].
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


def run_once(job: tuple[int, str]) -> dict:
    """One tutorial; the job is its seed and the robot's name."""
    seed, model = job
    sim = disturbed_simulation(
        seed, model=model, programme="tutorial", duration=DURATION
    )
    return follow(sim, seed)


def follow(sim: AtlasSimulation, seed: int) -> dict:
    """Runs the tutorial of a robot drawn from ``seed``; returns its record."""
    programme = sim.diagram.GetSubsystemByName("scheduler").programme
    settling = {}
    for look, word in LOOKS.items():
        command = next(entry for entry in programme if word in entry.text)
        sim.advance_to(command.time - MARGIN)
        settling[look] = settling_errors(sim)
    sim.advance_to(DURATION)
    summary = sim.summary()
    landing = max((step["error_m"] for step in summary["footsteps"]), default=None)
    worst = {look: max(errors.values()) for look, errors in settling.items()}
    problems = falls(sim)
    if not summary["success"] and not problems:
        problems.append("did not do all that it was told")
    if landing is not None and landing > LANDING_GOAL:
        problems.append(f"foot landed {1e3 * landing:.1f} mm off")
    for look, errors in settling.items():
        for name, error in errors.items():
            if error > SETTLING_GOAL:
                problems.append(f"{name} {error:.3f} rad off {look} the walk")
    return {
        "seed": seed,
        "ok": not problems,
        "problems": problems,
        "landing_error_m": landing,
        "settling_error_rad": worst,
        "settling_errors_rad": settling,
        "max_pelvis_tilt_rad": summary["max_pelvis_tilt_rad"],
        "min_pelvis_height": summary["min_pelvis_height"],
        "num_footsteps": len(summary["footsteps"]),
        "real_time_factor": summary["real_time_factor"],
    }


def as_record(outcome: Outcome) -> dict:
    """Makes the record of a run, also of a crashed run."""
    if outcome.error is None:
        return outcome.result
    return {"seed": outcome.item[0], "ok": False, "problems": [outcome.error]}


def describe(record: dict) -> str:
    """One line."""
    if "num_footsteps" not in record:
        return f"seed {record['seed']}  FAILED: {record['problems'][0]}"
    landing = record["landing_error_m"]
    feet = "no step" if landing is None else f"feet {1e3 * landing:4.1f} mm"
    settling = record["settling_error_rad"]
    verdict = "ok" if record["ok"] else "FAILED: " + "; ".join(record["problems"])
    return (
        f"seed {record['seed']}  {feet}, joints {settling['before']:.3f} and"
        f" {settling['after']:.3f} rad, tilt {record['max_pelvis_tilt_rad']:.2f} rad"
        f"  {verdict}"
    )


def worst_figures(records: list[dict]) -> dict:
    """Computes the worst of each figure over the completed runs."""
    whole = [record for record in records if "num_footsteps" in record]

    def worst(figure: Callable[[dict], float | None]) -> float:
        return max((figure(record) or 0.0 for record in whole), default=0.0)

    return {
        "landing_error_m": worst(lambda r: r["landing_error_m"]),
        "settling_error_before_rad": worst(lambda r: r["settling_error_rad"]["before"]),
        "settling_error_after_rad": worst(lambda r: r["settling_error_rad"]["after"]),
        "max_pelvis_tilt_rad": worst(lambda r: r["max_pelvis_tilt_rad"]),
    }


def main() -> int:
    """The command line; status 1 when a run failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument(
        "--seed", type=int, help="of the first run, then counted up (default: fresh)"
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    parser.add_argument("--model", default="atlas", help="robot (default: atlas)")
    options = command_line(parser)
    first = fresh_seed() if options.seed is None else options.seed
    seeds = range(first, first + options.runs)
    print(f"Seeds {seeds[0]} to {seeds[-1]}; again with --seed {first}.", flush=True)
    begin = time.monotonic()
    records: list[dict] = []
    try:
        jobs = [(seed, options.model) for seed in seeds]
        for outcome in run_in_processes(run_once, jobs, options.jobs):
            records.append(as_record(outcome))
            elapsed = time.monotonic() - begin
            print(
                f"{len(records):3}/{options.runs} {elapsed:5.0f} s "
                f" {describe(records[-1])}",
                flush=True,
            )
    except KeyboardInterrupt:
        print("Interrupted; what was done counts.")

    failed = sorted(record["seed"] for record in records if not record["ok"])
    worst = worst_figures(records)
    print(f"{len(records) - len(failed)} of {len(records)} succeeded.")
    if failed:
        print("Failing seeds: " + ", ".join(map(str, failed)))
    print(
        f"Worst: feet {1e3 * worst['landing_error_m']:.1f} mm, user's joints"
        f" {worst['settling_error_before_rad']:.3f} rad before and"
        f" {worst['settling_error_after_rad']:.3f} rad after the walk,"
        f" pelvis tilt {worst['max_pelvis_tilt_rad']:.2f} rad."
    )
    result = {
        "model": options.model,
        "first_seed": first,
        "runs_wanted": options.runs,
        "runs": len(records),
        "successes": len(records) - len(failed),
        "failing_seeds": failed,
        "worst": worst,
        "records": sorted(records, key=lambda record: record["seed"]),
    }
    write_figures(options.json, result)
    return 0 if len(records) == options.runs and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
