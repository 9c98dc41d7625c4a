"""The shipped trial functions and metrics.

A trial function gets a simulation at its start and the parameters of the trial,
advances the simulation, and may return figures. A metric is a function of a finished
simulation, or a class that is fed records: it is made with (robot), its ``update`` gets
every record, and its ``result`` the finished simulation. Figures are numbers, words or
None by name. The optional attribute ``extend`` of a metric is called with (builder,
station, robot) before the diagram is built, to add systems that measure at every
physics step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from pydrake.math import RollPitchYaw
from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.clients.campaigns.energy_meter import EnergyMeter
from atlas_drake.clients.logs.failure_modes import NONE, FailureWatch
from atlas_drake.clients.steering.step_stream import StepStream
from atlas_drake.messages import Behavior
from atlas_drake.planning.footstep_planner import steps_ahead
from atlas_drake.robot import Robot
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.simulation.beginning import draw_variation

Figures = dict[str, Any]
PIECE = 0.1
"""Simulated time between two checks of the robot [s]."""
DISTANCE = 2.0
"""Default distance of ``walk`` [m]."""
GAIT_PARAMETERS = {
    "stride": "stride",
    "step_duration": "duration",
    "swing_height": "swing_height",
}
"""Fields of a ``Gait`` by the parameter of ``walk``."""
STANDING = 1.0
"""Time for which ``walk`` stands before its first step [s]."""
AT_LIMIT = 0.999
"""Share of its largest effort from which a motor counts as at its limit [-]."""
METER_STEPS = 2
"""Physics steps between two samples of the motors' power."""
WORK = "motor_work"
"""Output port of the diagram with the motors' work."""
FIRST_FAILURE, FIRST_FAILURE_AT = "first_failure", "first_failure_at"
"""Figures of what failed first, and of the joint or foot concerned."""


def run(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> None:
    """Simulates until the scenario's duration ends or the robot falls."""
    _until(sim, sim.scenario.duration)


def walk(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Walks straight ahead, and stands until the duration ends.

    Args:
        sim: A robot that stands.
        parameters: ``distance`` [m], ``speed`` [m/s], and of the gait ``stride`` [m],
            ``step_duration`` [s] and ``swing_height`` [m]; the scenario's usual steps
            for those left out.

    Returns:
        ``walk_ended``: True if the robot stands again.
    """
    desired = {
        field: float(parameters[name])
        for name, field in GAIT_PARAMETERS.items()
        if name in parameters
    }
    gait = sim.scenario.controller_config().gait(**desired)
    _until(sim, STANDING)
    distance = float(parameters.get("distance", DISTANCE))
    speed = float(parameters["speed"]) if "speed" in parameters else None
    report = sim.atlas_sim_interface_state
    steps = StepStream(steps_ahead(report, distance, gait, speed))
    while not (sim.has_fallen or steps.is_over(sim.atlas_sim_interface_state)):
        if sim.time >= sim.scenario.duration - 1e-9:
            break
        sim.publish(steps.next_command(sim.atlas_sim_interface_state))
        sim.advance_to(min(sim.time + PIECE, sim.scenario.duration))
    _until(sim, sim.scenario.duration)
    return {"walk_ended": sim.current_behavior is Behavior.STAND}


def _until(sim: AtlasSimulation, end: float) -> None:
    while sim.time < end - 1e-9 and not sim.has_fallen:
        sim.advance_to(min(sim.time + PIECE, end))


TRIALS: dict[str, Callable[..., Any]] = {"run": run, "walk": walk}
"""Trial functions by name."""


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
    peaks = sim.output("peaks")
    return {"tilt_max_rad": peaks[-1], "pelvis_min_m": peaks[-2]}


def effort(sim: AtlasSimulation) -> Figures:
    """Largest efforts of the motors, as shares of their limits."""
    shares = sim.output("peaks")[:-2]
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


class FirstFailure(FailureWatch):
    """What failed first in a run, before a fall if there was one.

    Failures that follow each other within half a second belong together; the figures
    are those of the first one of the last group.
    """

    def result(self, sim: AtlasSimulation) -> Figures:
        """Returns kind, place and time of the failure."""
        first = self.first
        return {
            FIRST_FAILURE: NONE if first is None else first.kind,
            FIRST_FAILURE_AT: None if first is None else first.place or None,
            "first_failure_time_s": None if first is None else first.time,
        }


METRICS: dict[str, Callable[..., Any]] = {
    **{
        function.__name__: function
        for function in (success, landing, tilt, effort, energy, drift, ticks)
    },
    FIRST_FAILURE: FirstFailure,
}
"""Metrics by name."""
