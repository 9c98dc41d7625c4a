"""``atlas-drake replay --cockpit``: serve the cockpit over a log until Ctrl-C."""

from __future__ import annotations

import argparse
import math
import sys
import time

from pydrake.math import RigidTransform

from atlas_drake.app import exit_status
from atlas_drake.app.interrupts import ctrl_c
from atlas_drake.app.outputs import quiet_logs, shown_of_log
from atlas_drake.app.progress import Progress
from atlas_drake.cockpit.cockpit import Cockpit
from atlas_drake.cockpit.log_playback import LogPlayback
from atlas_drake.cockpit.log_state import card_of_log
from atlas_drake.diagrams.replay import make_replay, make_replay_beside
from atlas_drake.logs import Log
from atlas_drake.visualization import FRAME_RATE
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.viewer import interactive, open_on_desktop

BESIDE_PATH = "/atlas_drake/beside"
"""Where the 3D view has the robot of the second log."""
ASIDE = 1.5
"""How far to the left of its own place the robot of the second log is drawn [m]."""


def play_in_cockpit(log: Log, beside: Log | None, options: argparse.Namespace) -> int:
    """Shows a log, and one beside it, until Ctrl-C; returns the exit status."""
    quiet_logs()
    progress = Progress(sys.stdout, math.inf)
    overlays = Overlays(shown_of_log(options.show, log, progress))
    cockpit = Cockpit(options.host, options.port, overlays)
    diagrams = [make_replay(log, cockpit.meshcat, overlays)]
    if beside is not None:
        diagrams.append(make_replay_beside(beside, cockpit.meshcat, BESIDE_PATH))
    playback = LogPlayback(log, diagrams, cockpit.meshcat, overlays, beside)
    # The begin of the playback has drawn everything anew.
    cockpit.meshcat.SetTransform(BESIDE_PATH, RigidTransform([0.0, ASIDE, 0.0]))
    if options.realtime_rate is not None:
        playback.pace(options.realtime_rate)
    cockpit.present(playback, playback, card_of_log(log, cockpit.meshcat.port()))
    with ctrl_c() as asked_to_stop:
        progress.say(f"Watch at {cockpit.web_url()} (Ctrl-C here ends it).")
        if interactive():
            open_on_desktop(cockpit.web_url())
        before = time.perf_counter()
        while not asked_to_stop.wait(1.0 / FRAME_RATE):
            now = time.perf_counter()
            if cockpit.GetNumActiveConnections():  # A log does not play to nobody.
                playback.advance(now - before)
            cockpit.look()
            before = now
    return exit_status.OK
