"""The summary of a run as plain data, ready for JSON.

Reads the simulation, and computes a few derived figures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from atlas_drake.behaviors.footsteps import landed_elsewhere
from atlas_drake.config import as_plain
from atlas_drake.messages.event import STEPS_LEFT
from atlas_drake.parts.estimation.estimation_error import error_sizes

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

UPRIGHT_TILT = 0.4
"""Tilt of the pelvis below which the robot is upright [rad]."""


def make_summary(sim: AtlasSimulation, wall_time: float) -> dict[str, Any]:
    """Makes the summary of a run."""
    ticks = 1e3 * np.asarray(sim.tick_seconds)
    peaks = sim.output("peaks")
    X_WP = sim.pelvis_pose
    tilt = float(np.arccos(np.clip(X_WP.rotation().matrix()[2, 2], -1.0, 1.0)))
    quaternion = X_WP.rotation().ToQuaternion().wxyz()
    fell = any(event.kind == "fall" for event in sim.events)
    upright = tilt < UPRIGHT_TILT
    summary = {
        "success": not fell and upright and _did_it_all(sim),
        "fell": fell,
        "upright": upright,
        "scenario": sim.scenario.name,
        "model": sim.scenario.model,
        "seed": sim.scenario.seed,
        "sim_time": sim.time,
        "wall_time": wall_time,
        "real_time_factor": sim.time / wall_time if wall_time > 0.0 else None,
        "physics_step": sim.scenario.physics_step,
        "control_period": sim.scenario.control_period,
        "unsolved_ticks": sim.output("controller_status").unsolved,
        "controller_tick_ms": {
            "median": float(np.median(ticks)),
            "p99": float(np.percentile(ticks, 99)),
            "max": float(ticks.max()),
        }
        if ticks.size
        else {"median": None, "p99": None, "max": None},
        "min_pelvis_height": _finite(peaks[-2]),
        "max_pelvis_tilt_rad": _finite(peaks[-1]),
        "final_behavior": sim.current_behavior.name,
        "final_pelvis_pose": {
            "position": X_WP.translation().tolist(),
            "quaternion_wxyz": quaternion.tolist(),
        },
        "footsteps": list(sim.footsteps),
        "peak_effort_fraction": dict(
            zip(sim.robot.joint_names, map(float, peaks[:-2]), strict=True)
        ),
        "configuration": as_plain(sim.scenario),
        "events": [
            {"time": e.time, "kind": e.kind, "text": e.text} for e in sim.events
        ],
    }
    if sim.scenario.state == "estimated":
        summary["estimator_drift"] = _estimator_drift(
            sim.output("estimation_error"), sim.output("largest_estimation_error")
        )
    return summary


def _estimator_drift(
    error: np.ndarray, largest: np.ndarray
) -> dict[str, dict[str, float]]:
    """Names the final and the largest errors of the state estimator."""
    names = ("position_m", "velocity_m_s", "tilt_rad", "yaw_rad")
    final = map(float, error_sizes(error))
    return {
        "final": dict(zip(names, final, strict=True)),
        "largest": dict(zip(names, map(float, largest), strict=True)),
    }


def _did_it_all(sim: AtlasSimulation) -> bool:
    """Returns True if no command was refused, and no step missing or far off."""
    return not any(
        event.kind in ("refusal", STEPS_LEFT) or landed_elsewhere(event)
        for event in sim.events
    )


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
