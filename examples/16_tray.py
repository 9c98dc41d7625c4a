"""Two hands lift a tray with a glass of water and carry it for five meters.

The arms are yours and told where the palms have to be; WALK does the rest.
benchmarks/campaigns/tray.yaml repeats it with other glasses and places.
"""

import argparse
import math
import signal
import sys

import numpy as np

from atlas_drake import AtlasSimulation, HandGoal, HandWork, Scenario

SIDES = {"l_hand": 1.0, "r_hand": -1.0}
HALF = 0.25  # from the tray's middle to a palm [m]
SQUEEZE = 80.0  # force of each palm [N]
WEIGHT = 24.0  # of tray and glass [N]
X, Y, Z = np.eye(3)
UP = 0.12 * Z  # way of the lifted tray [m]
AHEAD = 0.46  # of the robot, where it takes the tray [m]
LEVEL = math.radians(5.0)  # that the tray may lean
FAR = 5.0  # the robot carries it to the left [m]


def beside(middle, gap=0.0, squeeze=0.0, lift=0.0):
    """Returns goals of the palms at both ends of the tray, the hands pointing ahead."""
    goals = []
    for hand, side in SIDES.items():
        place = middle + side * (HALF + gap) * Y
        goals.append(HandGoal(hand, place, X, [0.0, -side * squeeze, lift / 2]))
    return goals


def tilt(sim, name):
    """Returns how far a body leans from the vertical [rad]."""
    return math.acos(min(sim.frame_pose(name).rotation().matrix()[2, 2], 1.0))


def serve(sim, far=FAR):
    """Carries the tray; returns how far it leaned on the way at most [rad]."""
    work, firm, leaned = HandWork(sim), {"squeeze": SQUEEZE, "lift": WEIGHT}, [0.0]
    sim.advance(0.5)
    start = sim.frame_pose("tray").translation()
    work.walk_to(start[0] - AHEAD, start[1], 0.0)
    work.move(beside(start - 0.12 * X + 0.4 * UP, gap=0.15), 1.5)
    work.move(beside(start, gap=0.06), 1.5)
    work.move(beside(start, squeeze=SQUEEZE), 1.0)
    sim.hooks.append(lambda sim: leaned.append(tilt(sim, "tray")))
    work.move(beside(start + UP, **firm), 2.5)
    work.hold()
    work.walk_to(0.0, far, math.pi / 2)
    return max(leaned)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    parser.add_argument("--far", type=float, default=FAR, help="way of the tray [m]")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado
    sim = AtlasSimulation(Scenario(world="tray"), view=not options.headless)
    leaned = serve(sim, options.far)
    print(f"The tray leaned by {math.degrees(leaned):.1f} degrees at most.")
    stands = tilt(sim, "glass") < 0.1 and sim.frame_pose("glass").translation()[2] > 0.9
    served = stands and leaned < LEVEL
    print("The glass is served." if served else "Nobody would drink of it.")
    sys.exit(not served)
