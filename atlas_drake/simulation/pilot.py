"""Joins a pilot to a simulation, for scripts that steer by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from atlas_drake.planning.joint_motion import JointFacts
from atlas_drake.planning.pilot import Pilot
from atlas_drake.planning.reports import Reports

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation


def pilot_of(sim: AtlasSimulation) -> Pilot:
    """Returns a pilot of a simulation, which calls it from now on.

    Args:
        sim: The simulation; one of its ``hooks`` updates the pilot.
    """
    gait = sim.scenario.controller_config().gait()
    pilot = Pilot(JointFacts.of(sim.robot), gait, sim.publish, reports_of(sim))
    time, beginning = sim.time, sim.beginning

    def attend(sim: AtlasSimulation) -> None:
        nonlocal time, beginning
        passed = sim.time - time
        jumped = passed < 0.0 or sim.beginning is not beginning
        time, beginning = sim.time, sim.beginning
        pilot.see(reports_of(sim), jumped=jumped)
        pilot.update(passed)

    sim.hooks.append(attend)
    return pilot


def reports_of(sim: AtlasSimulation) -> Reports:
    """Returns what a pilot sees of a simulation."""
    return Reports(
        sim.atlas_sim_interface_state,
        sim.output("commands").joints,
        np.array(sim.atlas_state.position),
    )
