"""Teleoperation: steer Atlas with keys, sliders or a gamepad.

The command `atlas-drake teleop` does the same with more options. With --headless a
script presses the keys.
"""

import argparse
import signal
import sys

from atlas_drake import AtlasSimulation, Behavior
from atlas_drake.app.interrupts import ctrl_c
from atlas_drake.teleop.controls import Action, Controls, legend
from atlas_drake.teleop.panel import Panel
from atlas_drake.teleop.session import Session
from atlas_drake.visualization.overlays import Overlays

KEYS = {0.5: Action.FORWARD, 3.5: Action.ARC_LEFT, 6.0: Action.STOP}  # when [s]
END = 9.0  # of the script [s]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view, a script")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado


class Script:
    """Replaces the panel: returns the keys that are pressed."""

    def __init__(self, sim: AtlasSimulation) -> None:
        self.sim, self.keys = sim, dict(KEYS)

    def read(self) -> Controls:
        """Returns the keys that are due."""
        due = [time for time in self.keys if time <= self.sim.time]
        return Controls(clicks=tuple(self.keys.pop(time) for time in due))

    def set(self, slider: object, value: float) -> None:
        """Does nothing: there are no sliders."""

    def show_joints(self, positions: object) -> None:
        """Does nothing: there are no sliders."""

    def show_paused(self, paused: bool) -> None:
        """Does nothing: there is no view."""


if options.headless:
    sim = AtlasSimulation()
    session = Session(sim, Script(sim), real_time=False)
    while sim.time < END:
        session.advance()
    done = sim.current_behavior is Behavior.STAND and not sim.has_fallen
    steps = len(sim.footsteps)
    print(f"Atlas stands after {steps} steps." if done else "Atlas did not make it.")
    sys.exit(not done)

overlays = Overlays(["com", "dcm", "cop", "support", "swing", "follow"])
with ctrl_c() as asked_to_stop:
    sim = AtlasSimulation(view=True, overlays=overlays)
    session = Session(sim, Panel(sim.meshcat, sim.robot, overlays, sim.behaviors))
    print(f"Steer there (Ctrl-C here ends it).\n\n{legend(sim.robot)}")
    while not asked_to_stop.is_set():
        session.advance()
print(f"Stopped after {sim.time:.1f} s and {len(sim.footsteps)} steps.")
