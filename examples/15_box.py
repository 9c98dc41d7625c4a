"""Two hands push a box of 10 kg out of the way, by half a meter.

The arms are yours and stay where they are at the pelvis; WALK does the rest.
benchmarks/campaigns/box.yaml repeats it with other masses and places.
"""

import argparse
import signal
import sys

from atlas_drake import AtlasSimulation, HandGoal, HandWork, Scenario

PLACE = [0.4, 0.22, -0.05]  # of the left palm, from the pelvis [m]
HALF = 0.35  # from the box's middle to its near side [m]
FIST = 0.11  # from a palm to the end of the fist [m]
CLOSE = 0.02  # to the end of its way is near enough [m]
WAY = 0.5  # of the box [m]


def push(sim, way, place=PLACE):
    """Pushes the box away by this [m]; returns how far it went [m]."""
    work, box = HandWork(sim), sim.frame_pose("box").translation()
    sim.advance(0.5)
    left, right = sim.robot.file.hands
    ahead, aside, up = place
    goals = [
        HandGoal(hand, [ahead, y, up], [1.0, 0.0, 0.0], frame=sim.robot.file.pelvis)
        for hand, y in ((left, aside), (right, -aside))
    ]
    work.move(goals, 1.5)
    there, pushed = box[0] - HALF - FIST - ahead, 0.0
    for _ in range(3):  # Arms that give way leave something for another walk.
        if way - pushed < CLOSE:
            break
        there += way - pushed
        work.walk_to(there, box[1], 0.0)
        pushed = sim.frame_pose("box").translation()[0] - box[0]
    return pushed


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--headless", action="store_true", help="no 3D view")
    options = parser.parse_args()
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado
    sim = AtlasSimulation(Scenario(world="box"), view=not options.headless)
    done = push(sim, WAY) > WAY - 0.05 and not sim.has_fallen
    print("The box is out of the way." if done else "The box is still there.")
    sys.exit(not done)
