"""``atlas-drake teleop``: serve the panel, print the keys, run until Ctrl-C.

Orders of the panel are in ``teleop.commander``; the loop's slice is in
``teleop.session``.
"""

from __future__ import annotations

import argparse
import sys
import threading

from atlas_drake.app import exit_status
from atlas_drake.app.interrupts import ctrl_c
from atlas_drake.app.parts import load_parts
from atlas_drake.app.progress import Progress
from atlas_drake.app.run import (
    INTERRUPTED,
    quiet_logs,
    scenario_of,
    verdict,
    with_options,
)
from atlas_drake.simulation import AtlasSimulation, SimulationError
from atlas_drake.teleop.controls import legend
from atlas_drake.teleop.panel import Panel
from atlas_drake.teleop.session import Session
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.viewer import interactive, open_on_desktop, start_meshcat


def run_teleop(options: argparse.Namespace) -> int:
    """Runs until Ctrl-C, or for ``options.duration`` [s]; returns the exit status.

    Raises:
        ScenarioError: If an option cannot be used; raised before the run.
    """
    scenario = with_options(scenario_of(options, "teleop"), options)
    quiet_logs()
    overlays = Overlays(options.show)
    parts = load_parts(options.parts)
    progress = Progress(sys.stdout, options.duration)
    meshcat = start_meshcat(options.host, options.port, progress.say)
    sim = AtlasSimulation(
        scenario,
        view=meshcat,
        on_event=progress.event,
        overlays=overlays,
        **parts,
    )
    panel = Panel(
        meshcat,
        sim.robot,
        overlays,
        sim.behaviors,
        progress.say,
        sim.scenario.controller_config(),
    )
    session = Session(sim, panel)
    with ctrl_c() as asked_to_stop:
        progress.say(
            f"Steer at {meshcat.web_url()} (Ctrl-C here ends it).\n\n"
            f"{legend(sim.robot, sim.behaviors)}\n"
        )
        if interactive():
            open_on_desktop(meshcat.web_url())
        failure = _steer(sim, session, progress, options.duration, asked_to_stop)
    summary = sim.summary()
    # Teleoperation has no goal to judge; only an error counts as a failure.
    summary["stopped"] = failure or INTERRUPTED
    progress.say(verdict(summary))
    return exit_status.OK if failure is None else exit_status.FAILED


def _steer(
    sim: AtlasSimulation,
    session: Session,
    progress: Progress,
    end: float,
    asked_to_stop: threading.Event,
) -> str | None:
    """Runs until the end or Ctrl-C; returns the error, if any."""
    fallen = False
    try:
        while sim.time < end and not asked_to_stop.is_set():
            session.advance()
            paused = " (paused)" if session.paused else ""
            progress.update(sim.time, sim.current_behavior.name + paused)
            if sim.has_fallen and not fallen:
                progress.say("The robot falls; r puts it back on its feet.")
            fallen = sim.has_fallen
    except SimulationError as error:
        return str(error)
    return None
