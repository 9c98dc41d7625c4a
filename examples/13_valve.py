"""The left hand turns the wheel of a valve by a quarter, and lets go.

The arm is yours: it reaches between two spokes and pushes one of them round the middle.
benchmarks/campaigns/valve.yaml repeats it with other places.
"""

import argparse
import math
import signal
import sys

import numpy as np

from atlas_drake import AtlasSimulation, HandGoal, HandWork, Scenario

X = [1.0, 0.0, 0.0]
RADIUS = 0.14  # of the fist's way round the wheel's middle [m]
AHEAD, ASIDE = 0.42, 0.1  # from the robot to the wheel, which is to the left [m]
FREE, TOUCH = math.radians(30.0), math.radians(62.0)  # between spokes, and at the upper
QUARTER, PIECES = math.radians(100.0), 8  # the way of the fist from there on
BEFORE = 0.15  # from the wheel to where the fist comes from and goes [m]


def grip(sim, angle, ahead=0.0):
    """Returns the goal of the fist at an angle [rad] of the wheel, from the left on."""
    ray = [ahead, RADIUS * math.cos(angle), RADIUS * math.sin(angle)]
    middle = sim.frame_pose("wheel").translation()
    return [HandGoal("l_hand", middle + ray, X)]


def turned(sim):
    """Returns how far the wheel is turned, over to the right [rad]."""
    return sim.plant.GetJointByName("turn").get_angle(sim.part("plant")[1])


def turn(sim, ahead=0.0, left=0.0):
    """Turns the wheel, from a place that is off by this [m]."""
    work = HandWork(sim)
    sim.advance(0.5)
    x, y, _ = sim.frame_pose("wheel").translation()
    work.walk_to(x - AHEAD + ahead, y - ASIDE + left, 0.0)
    work.move(grip(sim, FREE, ahead=-BEFORE), 1.5)
    work.move(grip(sim, FREE), 1.0)
    for angle in np.linspace(TOUCH, TOUCH + QUARTER, PIECES):
        work.move(grip(sim, angle), 0.8)
    last = TOUCH + QUARTER - 0.2
    work.move(grip(sim, last), 0.5)
    work.move(grip(sim, last, ahead=-BEFORE), 1.0)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado
    sim = AtlasSimulation(Scenario(world="valve"), view=not options.headless)
    turn(sim)
    done = turned(sim) > math.radians(90.0) and not sim.has_fallen
    print("The valve is open." if done else "The valve is not open.")
    sys.exit(not done)
