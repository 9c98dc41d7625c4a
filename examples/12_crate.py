"""Two hands squeeze a crate of 10 kg, carry it to another table and put it down.

The arms are yours and told where the palms have to be; STAND and WALK do the rest.
benchmarks/campaigns/carry.yaml repeats it with other masses and places.
"""

import argparse
import math
import signal
import sys

import numpy as np

from atlas_drake import AtlasSimulation, HandGoal, HandWork, Scenario

SIDES = {"l_hand": 1.0, "r_hand": -1.0}
HALF, ABOVE = 0.25, 0.03  # from the crate's middle to a palm, aside and up [m]
SQUEEZE = 200.0  # force of each palm [N]
UP = np.array([0.0, 0.0, 0.13])  # way of the lifted crate [m]
NEARER = 0.1  # way of the lifted crate towards the body [m]
AHEAD = 0.46  # of the robot, where it takes the crate and puts it down [m]
ROBOT, CRATE = (0.0, 2.0, math.pi / 2), np.array([0.0, 2.0 + AHEAD, 0.975])
X, Y = np.eye(3)[:2]


def beside(middle, ahead, gap=0.0, squeeze=0.0, lift=0.0):
    """Returns goals of the palms at both sides of a point, the hands pointing ahead."""
    goals = []
    for hand, side in SIDES.items():
        out = side * np.cross([0.0, 0.0, 1.0], ahead)
        force = [0.0, 0.0, lift / 2] - squeeze * out
        place = middle + (HALF + gap) * out + [0.0, 0.0, ABOVE]
        goals.append(HandGoal(hand, place, ahead, force))
    return goals


def carry(sim, mass):
    """Carries a crate of a mass [kg] over; returns how far it was lifted [m]."""
    work, firm = HandWork(sim), {"squeeze": SQUEEZE, "lift": 9.81 * mass}

    def crate():
        return sim.frame_pose("crate").translation()

    sim.advance(0.5)
    start = crate()
    work.walk_to(start[0] - AHEAD, start[1], 0.0)
    work.move(beside(start - 0.12 * X + 0.4 * UP, X, gap=0.15), 1.5)
    work.move(beside(start, X, gap=0.06), 1.5)
    work.move(beside(start, X, squeeze=SQUEEZE), 1.0)
    work.move(beside(start + UP, X, **firm), 2.5)
    lifted = crate()[2] - start[2]
    work.move(beside(start + UP - NEARER * X, X, **firm), 1.0)
    work.hold()
    work.walk_to(*ROBOT)
    work.move(beside(CRATE + UP, Y, **firm), 2.0)
    grip = CRATE + UP - crate()  # hands from the crate
    work.move(beside(CRATE + grip, Y, **firm), 1.5)
    work.move(beside(CRATE + grip, Y), 0.5)
    work.move(beside(CRATE + grip, Y, gap=0.08), 1.0)
    return lifted


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado
    sim = AtlasSimulation(Scenario(world="tables"), view=not options.headless)
    carry(sim, 10.0)
    there = np.linalg.norm(sim.frame_pose("crate").translation() - CRATE) < 0.03
    print("The crate is on the other table." if there else "The crate is elsewhere.")
    sys.exit(not there)
