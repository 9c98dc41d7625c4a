"""The cockpit: steer Atlas from a page in the browser, or by the same functions here.

The command `atlas-drake teleop` opens the page with more options. With --headless a
script uses the pilot that the page has.
"""

import argparse
import sys

from atlas_drake import AtlasSimulation, Behavior
from atlas_drake.clients.cli.interrupts import ctrl_c
from atlas_drake.clients.cockpit.cockpit import open_cockpit
from atlas_drake.clients.steering.pilot import pilot_of

PIECE = 0.02  # between two looks at Ctrl+C [s]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no page, a script")
options = parser.parse_args()

if options.headless:
    sim = AtlasSimulation()
    pilot = pilot_of(sim)
    script = {
        0.5: lambda: pilot.walk(forward=1.0),
        3.5: lambda: pilot.walk(forward=1.0, turn=1.0),
        6.0: pilot.stop,
    }

    def act(sim):
        """Steers at the times of the script; called every 20 ms."""
        for due in [time for time in script if time <= sim.time]:
            script.pop(due)()

    sim.hooks.append(act)
    sim.advance_to(9.0)
    done = sim.current_behavior is Behavior.STAND and not sim.has_fallen
    steps = len(sim.footsteps)
    print(f"Atlas stands after {steps} steps." if done else "Atlas did not make it.")
    sys.exit(not done)

with ctrl_c() as asked_to_stop:
    sim, cockpit = open_cockpit()  # Prints the address of the page.
    cockpit.asked_to_stop = asked_to_stop.is_set
    while not asked_to_stop.is_set():
        sim.advance(PIECE)
print(f"Stopped after {sim.time:.1f} s and {len(sim.footsteps)} steps.")
