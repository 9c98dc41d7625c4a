"""What a campaign can measure: the functions that are shipped.

A metric is a function of a simulation at its end that returns figures by name: numbers,
words, or None where there is none. It may have an attribute ``extend``, called with
(builder, station, robot) before the diagram is built, to add what watches the run.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pydrake.math import RollPitchYaw

from atlas_drake.campaigns.energy import PORT, add_energy_meter
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.simulation.start import draw_variation

Figures = dict[str, Any]
AT_LIMIT = 0.999
"""A motor that did this share of its largest effort was at its limit [-]."""


def success(sim: AtlasSimulation) -> Figures:
    """Success of the run, and the time of a fall if there was one."""
    summary = sim.summary()
    falls = [event.time for event in sim.events if event.kind == "fall"]
    return {
        "success": summary["success"],
        "fell": summary["fell"],
        "fall_time_s": min(falls, default=None),
        "sim_time_s": sim.time,
        "final_behavior": summary["final_behavior"],
    }


def landing(sim: AtlasSimulation) -> Figures:
    """Distances of the feet from where they were sent."""
    errors = [step["error_m"] for step in sim.footsteps]
    return {
        "steps": len(errors),
        "landing_max_m": max(errors, default=None),
        "landing_mean_m": float(np.mean(errors)) if errors else None,
    }


def tilt(sim: AtlasSimulation) -> Figures:
    """Largest tilt and lowest height of the pelvis."""
    extremes = sim.output("extremes")
    return {"tilt_max_rad": extremes[-1], "pelvis_min_m": extremes[-2]}


def effort(sim: AtlasSimulation) -> Figures:
    """How near the motors came to their limits."""
    shares = sim.output("extremes")[:-2]
    return {
        "effort_max_share": float(np.max(shares)),
        "joints_at_limit": int(np.sum(shares >= AT_LIMIT)),
    }


def energy(sim: AtlasSimulation) -> Figures:
    """Mechanical work of the motors: done, and done on them."""
    done, taken = sim.output(PORT)
    return {"work_done_j": float(done), "work_taken_j": float(taken)}


energy.extend = add_energy_meter  # type: ignore[attr-defined]


def drift(sim: AtlasSimulation) -> Figures:
    """How far the pelvis is from where it began, and the estimate from the truth."""
    start = draw_variation(sim.scenario, sim.robot)
    X_WP = sim.pelvis_pose
    away = X_WP.translation()[:2] - start.position
    turned = RollPitchYaw(X_WP.rotation()).yaw_angle() - start.rpy[2]
    figures = {
        "drift_m": float(np.hypot(*away)),
        "drift_yaw_rad": float(abs((turned + np.pi) % (2.0 * np.pi) - np.pi)),
    }
    if sim.scenario.state == "estimated":
        largest = sim.summary()["estimator_drift"]["largest"]
        figures |= {f"estimate_{name}": value for name, value in largest.items()}
    return figures


def ticks(sim: AtlasSimulation) -> Figures:
    """Control ticks without a solution, and their wall times, which are the machine's.

    The only figures that are not the same in every run.
    """
    times = 1e3 * np.asarray(sim.tick_seconds)
    return {
        "unsolved_ticks": sim.output("controller_status").unsolved,
        "tick_median_ms": float(np.median(times)) if times.size else None,
        "tick_p99_ms": float(np.percentile(times, 99)) if times.size else None,
    }


METRICS: dict[str, Callable[[AtlasSimulation], Figures]] = {
    function.__name__: function
    for function in (success, landing, tilt, effort, energy, drift, ticks)
}
"""By name."""
