"""Mixed control: STAND balances while you control the arms and the neck.

Each joint has its own share: k_effort is 0 for the behavior, 255 for you.
"""

import argparse
import signal
import sys

from atlas_drake import AtlasCommand, AtlasSimulation, AtlasState

GOALS = {  # [rad]
    AtlasState.neck_ry: -0.1,
    AtlasState.l_arm_ely: 2.1,
    AtlasState.l_arm_wrx: -0.1,
    AtlasState.r_arm_ely: 2.1,
    AtlasState.r_arm_wrx: -0.1,
}

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

sim = AtlasSimulation(view=not options.headless)

n = sim.robot.num_joints
command = AtlasCommand()
command.position = list(sim.atlas_state.position)
command.kp_velocity = [50.0] * n  # [N·m·s/rad]
command.k_effort = [0] * n
for joint, goal in GOALS.items():
    command.position[joint] = goal
    command.k_effort[joint] = 255
sim.publish(command)
sim.advance(3.0)

print("joint       commanded    is [rad]")
for joint, goal in GOALS.items():
    is_at = sim.atlas_state.position[joint]
    print(f"{sim.robot.joint_names[joint]:10} {goal:10.3f} {is_at:10.3f}")
print("What is missing is gravity's share: a PID without integral term gives way.")

# Handing the joints back is one message, too.
command.k_effort = [0] * n
sim.publish(command)
sim.advance(2.0)
elbow = sim.atlas_state.position[AtlasState.l_arm_ely]
print(f"Back under the behavior the elbow is at {elbow:.3f} rad.")
print("Atlas fell." if sim.has_fallen else "Atlas still stands.")
sys.exit(sim.has_fallen)
