"""The shipped metrics.

A metric is a function of a finished simulation. It returns figures by name: numbers,
text, or None for a missing value. Its optional attribute ``extend`` is called with
(builder, station, robot) before the diagram is built, to add systems that measure.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pydrake.math import RollPitchYaw
from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.robot import Robot
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.simulation.start import draw_variation
from atlas_drake.systems.departure_watch import DepartureWatch
from atlas_drake.systems.departures import NONE
from atlas_drake.systems.energy_meter import EnergyMeter

Figures = dict[str, Any]
AT_LIMIT = 0.999
"""Share of its largest effort from which a motor counts as at its limit [-]."""
METER_STEPS = 2
"""Physics steps between two samples of the motors' power."""
WATCH_PERIOD = 0.018
"""Time between two looks for departures; rounded to physics steps [s]."""
WORK = "motor_work"
"""Output port of the diagram with the motors' work."""
DEPARTURES = "departures"
"""Output port of the diagram with what departed from a good run."""
FIRST_CAUSE, FIRST_CAUSE_AT = "first_cause", "first_cause_at"
"""Figures of what happened first, and of the joint or foot concerned."""


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
    """Distances between the landed feet and their commanded poses."""
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
    """Largest efforts of the motors, as shares of their limits."""
    shares = sim.output("extremes")[:-2]
    return {
        "effort_max_share": float(np.max(shares)),
        "joints_at_limit": int(np.sum(shares >= AT_LIMIT)),
    }


def energy(sim: AtlasSimulation) -> Figures:
    """Mechanical work of the motors: work done, and work taken up."""
    done, taken = sim.output(WORK)
    return {"work_done_j": float(done), "work_taken_j": float(taken)}


def add_energy_meter(builder: DiagramBuilder, station: Diagram, robot: Robot) -> None:
    """Adds the meter of the motors' work, and exports its output."""
    plant: Any = station.GetSubsystemByName("plant")
    own = robot.instance(plant)
    velocities = plant.num_positions(own) + robot.indices(plant).v
    period = METER_STEPS * plant.time_step()
    meter = builder.AddNamedSystem(
        "energy_meter",
        EnergyMeter(velocities, plant.num_multibody_states(own), period),
    )
    for name in ("effort", "state"):
        builder.Connect(station.GetOutputPort(name), meter.GetInputPort(name))
    builder.ExportOutput(meter.GetOutputPort("work"), WORK)


energy.extend = add_energy_meter  # type: ignore[attr-defined]


def drift(sim: AtlasSimulation) -> Figures:
    """Drift of the pelvis from its start, and of the estimate from the true state."""
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
    """Number of control ticks without a solution, and wall times of the ticks.

    The wall times depend on the machine; all other figures are the same in every run.
    """
    times = 1e3 * np.asarray(sim.tick_seconds)
    return {
        "unsolved_ticks": sim.output("controller_status").unsolved,
        "tick_median_ms": float(np.median(times)) if times.size else None,
        "tick_p99_ms": float(np.percentile(times, 99)) if times.size else None,
    }


def first_cause(sim: AtlasSimulation) -> Figures:
    """What departed first from a good run, before a fall if there was one.

    Departures that follow each other within a second belong together; the figures are
    those of the first one of the last group.
    """
    first = sim.output(DEPARTURES).first
    return {
        FIRST_CAUSE: NONE if first is None else first.kind,
        FIRST_CAUSE_AT: None if first is None else first.place or None,
        "first_cause_time_s": None if first is None else first.time,
    }


def add_departure_watch(
    builder: DiagramBuilder, station: Diagram, robot: Robot
) -> None:
    """Adds the watch of departures, and exports its output."""
    plant: Any = station.GetSubsystemByName("plant")
    step = plant.time_step()
    period = max(round(WATCH_PERIOD / step), 1) * step
    watch = builder.AddNamedSystem(
        "departure_watch", DepartureWatch(robot, plant, period, step)
    )
    for index in range(watch.num_input_ports()):
        port = watch.get_input_port(index)
        builder.Connect(station.GetOutputPort(port.get_name()), port)
    builder.ExportOutput(watch.GetOutputPort(DEPARTURES), DEPARTURES)


first_cause.extend = add_departure_watch  # type: ignore[attr-defined]


METRICS: dict[str, Callable[[AtlasSimulation], Figures]] = {
    function.__name__: function
    for function in (
        success,
        landing,
        tilt,
        effort,
        energy,
        drift,
        ticks,
        first_cause,
    )
}
"""Metrics by name."""
