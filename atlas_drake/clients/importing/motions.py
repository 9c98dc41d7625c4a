"""What a robot is let do in the trials of an import: stand, and walk ahead."""

from __future__ import annotations

from contextlib import suppress

from atlas_drake.clients.steering.step_stream import StepStream
from atlas_drake.errors import WaitTimeoutError
from atlas_drake.messages import Behavior
from atlas_drake.planning.footstep_planner import steps_ahead
from atlas_drake.simulation import AtlasSimulation

STEPS = 6
"""Number of steps of a walk."""
SETTLES = 1.5
"""Time in which a robot stands before a trial, and after a push [s]."""
LONGEST = 12.0
"""A robot that does not stand again by then never will [s]."""
ASTRAY = 0.5
"""Distance of a landed foot from its place, in lengths of the sole, from which a robot
catches itself rather than walks [-]."""
PIECE = 0.05
"""Simulated time between two looks at a walk [s]."""


def advance(sim: AtlasSimulation, seconds: float) -> None:
    """Simulates for some time [s], or until the robot falls."""
    with suppress(WaitTimeoutError):
        sim.wait_until(lambda sim: sim.has_fallen, seconds)


def stands(sim: AtlasSimulation) -> bool:
    """Returns whether the robot is in STAND, on its feet."""
    return sim.current_behavior is Behavior.STAND and not sim.has_fallen


def walk(sim: AtlasSimulation) -> bool:
    """Walks; returns whether the robot took all steps, to their places, and stands."""
    gait = sim.scenario.controller_config().gait()
    report = sim.atlas_sim_interface_state
    before = len(sim.footsteps)
    stream = StepStream(steps_ahead(report, gait.stride * (STEPS - 1), gait))
    end = sim.time + LONGEST
    while not (sim.has_fallen or stream.is_over(sim.atlas_sim_interface_state)):
        if sim.time > end:
            return False
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance(PIECE)
    landed = sim.footsteps[before:]
    astray = ASTRAY * sim.robot.file.sole.length
    return (
        stands(sim)
        and len(landed) >= STEPS
        and all(step["error_m"] < astray for step in landed)
    )
