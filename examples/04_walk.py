"""WALK: steps ahead, and more steps added while walking, in a curve to the left."""

import argparse
import math
import sys

from pydrake.geometry import Meshcat

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
)

NUM_STEPS = 10
LENGTH, TURN = 0.2, 0.1  # of each step [m], [rad]
HALF_WIDTH = 0.12  # of each foot from the middle [m]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()

meshcat = None if options.headless else Meshcat()
sim = AtlasSimulation(meshcat=meshcat)
if meshcat is not None:
    sim.set_realtime_rate(1.0)
    input("Open the address above in a browser, then press Enter to start.")


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


def wants_steps(sim: AtlasSimulation) -> bool:
    """Whether fewer than two steps are known that have not begun."""
    walk = sim.atlas_sim_interface_state.walk_feedback
    ahead = walk.next_step_index_needed - walk.current_step_index - 1
    return ahead < 2 or sim.has_fallen


def has_ended(sim: AtlasSimulation) -> bool:
    """Whether the walk is over, for good or ill."""
    return sim.current_behavior is not Behavior.WALK or sim.has_fallen


steps = plan()
while steps and not sim.has_fallen:
    command = AtlasSimInterfaceCommand()
    command.behavior = command.WALK
    for place, step in enumerate(steps[:4]):  # the queue holds four
        command.walk_params.step_queue[place] = step
    sim.publish(command)
    indices = [step.step_index for step in steps[:4]]
    print(f"{sim.time:5.2f} s  sent steps {indices}")
    del steps[:4]
    sim.advance(0.1)  # it has heard of them then
    sim.wait_until(wants_steps, what="the last steps but two")
sim.wait_until(has_ended, timeout=20.0, what="the end of the walk")

for step in sim.footsteps:
    print(f"step {step['index']:2} landed {1e3 * step['error_m']:3.0f} mm off")
done = len(sim.footsteps) == NUM_STEPS and not sim.has_fallen
print("Atlas walked its curve." if done else "Atlas did not make it.")
sys.exit(not done)
