"""WALK: steps ahead, and more steps added while walking, in a curve to the left."""

import argparse
import signal
import sys

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    steps_along_arc,
)

LENGTH, ANGLE = 1.8, 0.9  # of the curve [m], [rad]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

sim = AtlasSimulation(view=not options.headless)


def wants_steps(sim: AtlasSimulation) -> bool:
    """Returns True if fewer than two steps remain that have not begun."""
    walk = sim.atlas_sim_interface_state.walk_feedback
    ahead = walk.next_step_index_needed - walk.current_step_index - 1
    return ahead < 2 or sim.has_fallen


def has_ended(sim: AtlasSimulation) -> bool:
    """Returns True once the walk has ended, completed or not."""
    return sim.current_behavior is not Behavior.WALK or sim.has_fallen


# Poses are those of the soles in the world; the last step puts them side by side.
steps = steps_along_arc(sim.atlas_sim_interface_state, LENGTH, ANGLE)
to_send = list(steps)
while to_send and not sim.has_fallen:
    command = AtlasSimInterfaceCommand()
    command.behavior = command.WALK
    for place, step in enumerate(to_send[:4]):  # the queue holds four
        command.walk_params.step_queue[place] = step
    sim.publish(command)
    indices = [step.step_index for step in to_send[:4]]
    print(f"{sim.time:5.2f} s  sent steps {indices}")
    del to_send[:4]
    sim.advance(0.1)  # the steps have arrived then
    sim.wait_until(wants_steps, what="the last steps but two")
sim.wait_until(has_ended, timeout=20.0, what="the end of the walk")

for step in sim.footsteps:
    print(f"step {step['index']:2} landed {1e3 * step['error_m']:3.0f} mm off")
done = len(sim.footsteps) == len(steps) and not sim.has_fallen
print("Atlas walked its curve." if done else "Atlas did not make it.")
sys.exit(not done)
