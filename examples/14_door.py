"""The right hand presses a door's lever, the left one opens it on the way through.

The arms are yours; WALK does the rest. Without the lever the latch holds the door shut.
benchmarks/campaigns/door.yaml repeats it with other places.
"""

import argparse
import math
import signal
import sys

import numpy as np

from atlas_drake import AtlasSimulation, HandGoal, HandWork, Scenario

STAND = np.array([-0.5, 0.35])  # of the robot, from the lever's spindle [m]
AJAR = np.array([0.15, 0.0])  # way of the robot with the lever pressed [m]
PRESS = 40.0  # force of the right palm [N]
PLACE = [0.45, 0.25, 0.25]  # of the left palm, from the pelvis [m]
BEYOND = 1.2  # how far the robot goes beyond the door [m]
X = [1.0, 0.0, 0.0]


def opened(sim):
    """Returns how far the door is open [rad]."""
    return sim.plant.GetJointByName("hinge").get_angle(sim.part("plant")[1])


def walk_through(sim):
    """Opens the door on the way through it."""
    work, door = HandWork(sim), sim.frame_pose("post").translation()
    lever = sim.frame_pose("lever").translation()

    def move_right(up, duration, press=0.0):
        palm = lever + np.array([-0.14, 0.11, up])
        work.move([HandGoal("r_hand", palm, X, [0.0, 0.0, -press])], duration)

    sim.advance(0.5)
    work.walk_to(*(lever[:2] + STAND), 0.0)
    move_right(0.16, 1.5)
    move_right(-0.03, 1.5, PRESS)
    work.hold()
    work.walk_to(*(lever[:2] + STAND + AJAR), 0.0)
    work.move([HandGoal("l_hand", PLACE, X, frame="pelvis")], 1.5)
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
