"""WALK: steps ahead, and more steps added while walking, in a curve to the left."""

import argparse
import math
import signal
import sys

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
)
from atlas_drake.viewer import await_viewer, start_meshcat

NUM_STEPS = 10
LENGTH, TURN = 0.2, 0.1  # of each step [m], [rad]
HALF_WIDTH = 0.12  # of each foot from the middle [m]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

meshcat = None if options.headless else start_meshcat()
sim = AtlasSimulation(meshcat=meshcat)
if meshcat is not None:
    sim.set_realtime_rate(1.0)
    await_viewer(meshcat)


def plan() -> list[AtlasBehaviorStepData]:
    """Steps along an arc; the last one puts the feet side by side."""
    x = y = yaw = 0.0
    steps = []
    for i in range(NUM_STEPS):
        if i < NUM_STEPS - 1:
            yaw += TURN
            x += LENGTH * math.cos(yaw)
            y += LENGTH * math.sin(yaw)
        side = HALF_WIDTH if i % 2 == 0 else -HALF_WIDTH
        step = AtlasBehaviorStepData()
        step.step_index = i + 1
        step.foot_index = i % 2  # 0 left, 1 right
        step.duration = 0.63
        step.swing_height = 0.1
        # Poses are those of the sole in the world; the robot starts at the origin.
        step.pose.position.x = x - side * math.sin(yaw)
        step.pose.position.y = y + side * math.cos(yaw)
        step.pose.orientation.z = math.sin(0.5 * yaw)
        step.pose.orientation.w = math.cos(0.5 * yaw)
        steps.append(step)
    return steps


steps = plan()
while steps or sim.current_behavior is Behavior.WALK:
    walk = sim.atlas_sim_interface_state.walk_feedback
    ahead = walk.next_step_index_needed - walk.current_step_index - 1
    if steps and ahead < 2:
        command = AtlasSimInterfaceCommand()
        command.behavior = command.WALK
        for place, step in enumerate(steps[:4]):  # the queue holds four
            command.walk_params.step_queue[place] = step
        sim.publish(command)
        indices = [step.step_index for step in steps[:4]]
        print(f"{sim.time:5.2f} s  sent steps {indices}")
        del steps[:4]
    sim.advance(0.1)
    if sim.has_fallen:
        break

for step in sim.footsteps:
    print(f"step {step['index']:2} landed {1e3 * step['error_m']:3.0f} mm off")
done = len(sim.footsteps) == NUM_STEPS and not sim.has_fallen
print("Atlas walked its curve." if done else "Atlas did not make it.")
sys.exit(not done)
