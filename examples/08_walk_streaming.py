"""WALK, streamed: steps round a circle, sent four at a time as Atlas asks for them."""

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

NUM_STEPS = 28  # once round
LENGTH, TURN = 0.2, 2.0 * math.pi / (NUM_STEPS - 1)  # of each step [m], [rad]
HALF_WIDTH = 0.12  # of each foot from the middle [m]
AHEAD = 2  # steps known and not begun, with which the next ones are sent

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

meshcat = None if options.headless else start_meshcat()
sim = AtlasSimulation(meshcat=meshcat)
if meshcat is not None:
    sim.set_realtime_rate(1.0)
    await_viewer(meshcat)


def step_on_circle(index: int) -> AtlasBehaviorStepData:
    """The step with this index; the last one puts the feet side by side."""
    x = y = yaw = 0.0
    for _ in range(min(index, NUM_STEPS - 1)):
        yaw += TURN
        x += LENGTH * math.cos(yaw)
        y += LENGTH * math.sin(yaw)
    step = AtlasBehaviorStepData()
    step.step_index = index
    step.foot_index = (index - 1) % 2  # 0 left, 1 right
    step.duration = 0.63
    step.swing_height = 0.1
    side = HALF_WIDTH if step.foot_index == 0 else -HALF_WIDTH
    # The height counts from the foot on the ground, wherever that is in the world.
    step.pose.position.x = x - side * math.sin(yaw)
    step.pose.position.y = y + side * math.cos(yaw)
    step.pose.position.z = 0.0
    step.pose.orientation.z = math.sin(0.5 * yaw)
    step.pose.orientation.w = math.cos(0.5 * yaw)
    return step


needed, sent = 1, 0
while sent < NUM_STEPS or sim.current_behavior is Behavior.WALK:
    walk = sim.atlas_sim_interface_state.walk_feedback
    if sent:  # before, nobody walks and asks for steps
        needed = walk.next_step_index_needed
    known = needed - walk.current_step_index - 1
    if sent < needed <= NUM_STEPS and known <= AHEAD:
        command = AtlasSimInterfaceCommand()
        command.behavior = command.WALK
        command.walk_params.use_relative_step_height = True
        indices = range(needed, min(needed + 4, NUM_STEPS + 1))
        for place, index in enumerate(indices):
            command.walk_params.step_queue[place] = step_on_circle(index)
        sim.publish(command)
        print(f"{sim.time:5.2f} s  sent steps {needed} to {indices[-1]}")
        sent = indices[-1]
    sim.advance(0.1)
    if sim.has_fallen:
        break

for step in sim.footsteps:
    print(f"step {step['index']:2} landed {1e3 * step['error_m']:3.0f} mm off")
done = len(sim.footsteps) == NUM_STEPS and not sim.has_fallen
print("Atlas walked its circle." if done else "Atlas did not make it.")
sys.exit(not done)
