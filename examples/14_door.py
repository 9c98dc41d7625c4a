"""The left hand pushes a door open, and the robot walks through.

The arm is yours and stays where it is at the pelvis; WALK does the rest.
benchmarks/campaigns/door.yaml repeats it with other places.
"""

import argparse
import math
import signal
import sys

from atlas_drake import AtlasSimulation, HandGoal, HandWork, Scenario

PLACE = [0.45, 0.25, 0.25]  # of the fist, from the pelvis [m]
BEYOND = 1.2  # how far the robot goes beyond the door [m]


def opened(sim):
    """Returns how far the door is open [rad]."""
    return sim.plant.GetJointByName("hinge").get_angle(sim.part("plant")[1])


def walk_through(sim):
    """Opens the door on the way through it."""
    work, door = HandWork(sim), sim.frame_pose("post").translation()
    sim.advance(0.5)
    work.move([HandGoal("l_hand", PLACE, [1.0, 0.0, 0.0], frame="pelvis")], 1.5)
    work.walk_to(door[0] + BEYOND, door[1] - 0.55, 0.0)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado
    sim = AtlasSimulation(Scenario(world="door"), view=not options.headless)
    walk_through(sim)
    x = sim.pelvis_pose.translation()[0] - sim.frame_pose("post").translation()[0]
    done = opened(sim) > math.radians(60.0) and x > 1.0 and not sim.has_fallen
    print("Atlas is through the door." if done else "Atlas is not through.")
    sys.exit(not done)
