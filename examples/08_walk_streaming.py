"""WALK, streamed: steps round a circle, sent four at a time as Atlas asks for them."""

import argparse
import math
import signal
import sys

from atlas_drake import AtlasSimulation, Gait, StepStream, steps_along_arc

RADIUS = 0.8  # of the circle [m]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

sim = AtlasSimulation(view=not options.headless)

steps = steps_along_arc(
    sim.atlas_sim_interface_state,
    length=2.0 * math.pi * RADIUS,
    angle=2.0 * math.pi,
    gait=Gait(stride=0.2, turn=0.25),
)
stream = StepStream(steps)
while not stream.is_over(sim.atlas_sim_interface_state) and not sim.has_fallen:
    command = stream.next_command(sim.atlas_sim_interface_state)
    if command is not None:
        sim.publish(command)
        sent = [step.step_index for step in command.walk_params.step_queue]
        print(f"{sim.time:5.2f} s  sent steps {[index for index in sent if index > 0]}")
    sim.advance(0.1)

for step in sim.footsteps:
    print(f"step {step['index']:2} landed {1e3 * step['error_m']:3.0f} mm off")
done = len(sim.footsteps) == len(steps) and not sim.has_fallen
print("Atlas walked its circle." if done else "Atlas did not make it.")
sys.exit(not done)
