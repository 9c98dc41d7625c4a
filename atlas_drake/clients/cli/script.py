"""``atlas-drake script``: runs a program that was written for DRCSim.

The program runs in ``ros_scripts``; views, output files and verdict are in ``run``.
"""

from __future__ import annotations

import argparse
import math
import sys
import threading
from contextlib import redirect_stdout
from typing import Any, TextIO

from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.progress import Progress
from atlas_drake.clients.cli.run import (
    PIECE,
    end_after_fall,
    run_scenario,
    scenario_of,
)
from atlas_drake.clients.ros_scripts.program import Program, unfinished
from atlas_drake.simulation import AtlasSimulation


def run_script(options: argparse.Namespace) -> int:
    """Runs a program on the robot of a scenario; returns the exit status."""
    scenario = scenario_of(options, options.file.stem)
    program = Program(options.file, options.arguments)

    def simulate(
        sim: AtlasSimulation, progress: Progress, asked_to_stop: threading.Event
    ) -> str | None:
        return _simulate(sim, progress, asked_to_stop, program, options.duration)

    end = math.inf if options.duration is None else options.duration
    status = run_scenario(
        scenario, options, simulate, end, lambda: not program.simulating
    )
    if status == exit_status.FAILED and program.at_fault:
        return exit_status.BAD_INPUT
    return status


def _simulate(
    sim: AtlasSimulation,
    progress: Progress,
    asked_to_stop: threading.Event,
    program: Program,
    duration: float | None,
) -> str | None:
    """Runs the program, then simulates until ``duration`` [s] if it is given."""
    shown = -math.inf

    def ended() -> bool:
        nonlocal shown
        if sim.time >= shown + PIECE - 1e-9:
            shown = sim.time
            progress.update(sim.time, sim.current_behavior.name)
        return asked_to_stop.is_set() or sim.time >= end_after_fall(sim)

    def complain(text: str) -> None:
        progress.clear()
        print(text, file=sys.stderr)

    output: Any = _SharedOutput(sys.stdout, progress)
    end = math.inf if duration is None else duration
    with redirect_stdout(output):
        try:
            problem = program.run(sim, ended, end, progress.say_lines, complain)
            if problem is None and duration is not None:
                problem = program.finish()
        except KeyboardInterrupt:
            return None
    if asked_to_stop.is_set():
        return None
    left = unfinished(sim)
    if problem is None and left and not sim.has_fallen:
        progress.say(
            f"! The run ended with {' and '.join(left)} not completed; a longer "
            "--duration lets Atlas go on."
        )
    elif problem is None and program.last_command >= sim.time:
        progress.say(
            f"{program.path.name} ended when it had sent its last command; --duration "
            "lets Atlas go on."
        )
    return problem


class _SharedOutput:
    """Standard output that clears the line of progress before each text."""

    def __init__(self, stream: TextIO, progress: Progress) -> None:
        self._stream, self._progress = stream, progress

    def write(self, text: str) -> int:
        self._progress.clear()
        return self._stream.write(text)

    def __getattr__(self, name: str) -> object:
        return getattr(self._stream, name)
