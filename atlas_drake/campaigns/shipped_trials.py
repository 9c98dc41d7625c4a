"""The shipped trial functions.

A trial function receives a simulation at its start, and the parameters of the trial. It
advances the simulation, and may return figures.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from atlas_drake.messages import Behavior
from atlas_drake.planning.footstep_planner import steps_ahead
from atlas_drake.planning.step_stream import StepStream
from atlas_drake.simulation import AtlasSimulation

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
    wanted = {
        field: float(parameters[name])
        for name, field in GAIT_PARAMETERS.items()
        if name in parameters
    }
    gait = sim.scenario.controller_config().gait(**wanted)
    _until(sim, STANDING)
    distance = float(parameters.get("distance", DISTANCE))
    speed = float(parameters["speed"]) if "speed" in parameters else None
    report = sim.atlas_sim_interface_state
    steps = StepStream(steps_ahead(report, distance, gait, speed))
    while not (sim.has_fallen or steps.is_over(sim.atlas_sim_interface_state)):
        if sim.time >= sim.scenario.duration - 1e-9:
            break
        command = steps.next_command(sim.atlas_sim_interface_state)
        if command is not None:
            sim.publish(command)
        sim.advance_to(min(sim.time + PIECE, sim.scenario.duration))
    _until(sim, sim.scenario.duration)
    return {"walk_ended": sim.current_behavior is Behavior.STAND}


def _until(sim: AtlasSimulation, end: float) -> None:
    while sim.time < end - 1e-9 and not sim.has_fallen:
        sim.advance_to(min(sim.time + PIECE, end))


TRIALS: dict[str, Callable[..., Any]] = {"run": run, "walk": walk}
"""Trial functions by name."""
