"""MANIPULATE: the pelvis goes to commanded poses while you control the arms.

Every pose is clamped to the limits of legs, motors and feet, and reported.
"""

import argparse
import signal
import sys

from atlas_drake import (
    AtlasBehaviorPelvisServoParams,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    AtlasState,
    Behavior,
)

POSES = [  # what, and how [m], [rad]
    ("lean forward", {"pelvis_height": 0.85, "pelvis_pitch": 0.35}),
    ("weight to the left", {"pelvis_height": 0.85, "com_v0": 0.08}),
    ("turn and tilt", {"pelvis_yaw": -0.1, "pelvis_roll": 0.15}),
    ("far too deep", {"pelvis_height": 0.2}),
]

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--headless", action="store_true", help="no 3D view")
options = parser.parse_args()
signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it, without ado

sim = AtlasSimulation(view=not options.headless)
sim.advance(0.5)

arms = AtlasCommand()  # both arms are yours: elbows out, well damped
arms.position = list(sim.atlas_state.position)
arms.position[AtlasState.l_arm_ely] = arms.position[AtlasState.r_arm_ely] = 1.2
arms.kp_velocity = [20.0] * sim.robot.num_joints  # [N·m·s/rad]
arms.k_effort = [255 if "arm" in name else 0 for name in sim.robot.joint_names]
sim.publish(arms)

command = AtlasSimInterfaceCommand()
command.behavior = command.MANIPULATE
command.manipulate_params.use_desired = True
for what, pose in POSES:
    # A new pelvis pose each time; an empty k_effort leaves the arms under your control.
    desired = AtlasBehaviorPelvisServoParams()
    command.manipulate_params.desired = desired
    for field, value in pose.items():
        setattr(desired, field, value)
    sim.publish(command)
    sim.advance(3.0)
    feedback = sim.atlas_sim_interface_state.manipulate_feedback
    granted, sensed = feedback.clamped, feedback.internal_sensed
    print(f"{sim.time:5.2f} s  {what}")
    for field, value in pose.items():
        print(
            f"    {field:13} asked {value:+.3f}  granted {getattr(granted, field):+.3f}"
            f"  is {getattr(sensed, field):+.3f}"
        )

stand = AtlasSimInterfaceCommand()
stand.behavior = stand.STAND
sim.publish(stand)
sim.wait_until(  # it comes back up first
    lambda sim: sim.current_behavior is Behavior.STAND or sim.has_fallen
)
done = sim.current_behavior is Behavior.STAND and not sim.has_fallen
print("Atlas stands again." if done else "Atlas did not make it.")
sys.exit(not done)
