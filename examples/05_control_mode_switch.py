"""The tutorial: from user control to behaviors, both at once, and back again."""

import argparse
import signal
import sys

from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    AtlasState,
)

GAINS = [20.0, 4000.0, 2000.0, 20.0]  # back, neck
GAINS += 2 * [5.0, 100.0, 2000.0, 1000.0, 900.0, 300.0]  # legs
GAINS += 2 * [2000.0, 1000.0, 200.0, 200.0, 50.0, 100.0]  # arms [N·m/rad]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

sim = AtlasSimulation(view=not options.headless)
n = sim.robot.num_joints


def say(text: str) -> None:
    """Prints what happens, with the simulated time."""
    print(f"{sim.time:6.2f} s  {text}")


def posture() -> AtlasCommand:
    """All joints to zero, with gains."""
    command = AtlasCommand()
    command.position = [0.0] * n
    command.velocity = [0.0] * n
    command.effort = [0.0] * n
    command.kp_position = GAINS
    command.ki_position = [0.0] * n
    command.kd_position = [0.0] * n
    command.kp_velocity = [50.0] * n  # makes the transition smooth
    command.i_effort_min = [0.0] * n
    command.i_effort_max = [0.0] * n
    return command


sim.advance(2.0)

# Step 1: go to the stand-prep pose under user control.
stand_prep = AtlasCommand()
stand_prep.position = sim.robot.stand_prep.tolist()
stand_prep.velocity = [0.0] * n
stand_prep.effort = [0.0] * n
stand_prep.k_effort = [255] * n
say("[USER] Going to stand prep position...")
sim.publish(stand_prep)
sim.advance(2.0)

# Step 2: prepare the behavior while the user keeps all joints, then stand.
stand = AtlasSimInterfaceCommand()
stand.behavior = stand.STAND_PREP
stand.k_effort = [255] * n
say("[USER] Warming up BDI stand...")
sim.publish(stand)
sim.advance(1.0)
stand.behavior = stand.STAND
stand.k_effort = [0] * n
say("[BDI] Standing...")
sim.publish(stand)
sim.advance(2.0)

# Step 3: take five joints back and move them; the behavior keeps the balance.
arms = posture()
arms.k_effort = [0] * n
for joint, position in (
    (AtlasState.neck_ry, -0.1),
    (AtlasState.l_arm_ely, 2.1),
    (AtlasState.l_arm_wrx, -0.1),
    (AtlasState.r_arm_ely, 2.1),
    (AtlasState.r_arm_wrx, -0.1),
):
    arms.position[joint] = position
    arms.k_effort[joint] = 255
say("[USER/BDI] Command neck and arms...")
sim.publish(arms)
sim.advance(2.0)

# Step 4: walk. Steps are planned in the robot's frame and sent in the world's.
orientation = Quaternion(sim.imu.orientation.to_wxyz())
position = sim.atlas_sim_interface_state.pos_est.position
X_WP = RigidTransform(orientation, position.to_array())
walk = AtlasSimInterfaceCommand()
walk.behavior = walk.WALK
for i in range(4):
    step = AtlasBehaviorStepData()
    step.step_index = i + 1
    step.foot_index = i % 2  # 0 left, 1 right
    step.duration = 0.63  # [s]
    step.swing_height = 0.3  # [m]
    p_PF = [(1 + i // 2) * 0.25, 0.15 if i % 2 == 0 else -0.15, 0.0]  # [m]
    p_WF = X_WP @ p_PF
    step.pose.position.x, step.pose.position.y, step.pose.position.z = p_WF
    w, x, y, z = X_WP.rotation().ToQuaternion().wxyz()
    turned = step.pose.orientation
    turned.w, turned.x, turned.y, turned.z = w, x, y, z
    walk.walk_params.step_queue[i] = step
walk.k_effort = arms.k_effort
say("[USER/BDI] Walking...")
sim.publish(walk)
sim.advance(6.0)

# Step 5: back to the home pose under user control.
home = posture()
home.k_effort = [255] * n
say("[USER] Going to home position...")
sim.publish(home)
sim.advance(2.0)

steps = len(sim.footsteps)
say("Atlas fell." if sim.has_fallen else f"Atlas stands, {steps} steps further on.")
sys.exit(sim.has_fallen or steps < 4)
