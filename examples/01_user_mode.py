"""User mode: every joint follows your own PID set-points, without balance.

Atlas stands in its stand-prep pose on stiff joints alone, and nods and waves.
"""

import argparse
import math
import signal
import sys

from atlas_drake import AtlasCommand, AtlasSimulation, AtlasState, Scenario

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

sim = AtlasSimulation(Scenario(initial_behavior="USER"), view=not options.headless)

# All joints hold their pose with the robot's default gains. An empty array keeps the
# values in force, so later commands may give positions only.
n = sim.robot.num_joints
command = AtlasCommand()
command.position = sim.robot.stand_prep.tolist()
command.kp_velocity = [50.0] * n  # [N·m·s/rad]: damping, so that nothing swings
command.k_effort = [255] * n
sim.publish(command)
print(f"{sim.time:5.2f} s  holding the stand-prep pose")
sim.advance(1.0)

print(f"{sim.time:5.2f} s  waving")
elbow, neck = AtlasState.r_arm_elx, AtlasState.neck_ry
for _ in range(20):
    phase = 2.0 * math.pi * 0.5 * (sim.time - 1.0)  # [rad], at half a hertz
    command.position[elbow] = sim.robot.stand_prep[elbow] - 0.5 + 0.5 * math.cos(phase)
    command.position[neck] = 0.1 * math.sin(phase)
    sim.publish(command)
    sim.advance(0.1)

sim.advance(1.0)
error = abs(sim.atlas_state.position[elbow] - command.position[elbow])
print(f"{sim.time:5.2f} s  the elbow is {error:.3f} rad from where it was sent last")
print("Atlas fell." if sim.has_fallen else "Atlas still stands.")
sys.exit(sim.has_fallen)
