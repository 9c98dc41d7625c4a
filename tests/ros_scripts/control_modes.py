#!/usr/bin/env python
"""The tutorial's six commands as one would have written them for DRCSim, in less time.

Run by test_script_command; not a module of the tests.
"""

from __future__ import print_function

import roslib

roslib.load_manifest("control_modes")

import time

import PyKDL
import rospy
from atlas_msgs.msg import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    AtlasState,
)
from sensor_msgs.msg import Imu
from tf_conversions import posemath

JOINTS = 28


class ControlModes:
    def __init__(self):
        self.state, self.imu, self.joints = None, None, None
        self.user = rospy.Publisher("atlas/atlas_command", AtlasCommand, queue_size=1)
        self.behavior = rospy.Publisher(
            "atlas/atlas_sim_interface_command", AtlasSimInterfaceCommand, queue_size=1
        )
        for topic, kind, name in [
            ("atlas/atlas_sim_interface_state", AtlasSimInterfaceState, "state"),
            ("atlas/imu", Imu, "imu"),
            ("atlas/atlas_state", AtlasState, "joints"),
        ]:
            rospy.Subscriber(topic, kind, self.keep, name)
        time.sleep(0.1)

    def keep(self, message, name):
        setattr(self, name, message)

    def hold(self, k_effort, **moved):
        message = AtlasCommand()
        message.header.stamp = rospy.Time.now()
        message.position = list(self.joints.position)
        for name, position in moved.items():
            message.position[getattr(AtlasState, name)] = position
        message.kp_velocity = [20.0] * JOINTS
        message.k_effort = k_effort
        self.user.publish(message)

    def begin(self, behavior, k_effort):
        message = AtlasSimInterfaceCommand()
        message.header.stamp = rospy.Time.now()
        message.behavior = behavior
        message.k_effort = k_effort
        self.behavior.publish(message)

    def walk(self, k_effort):
        message = AtlasSimInterfaceCommand(behavior=AtlasSimInterfaceCommand.WALK)
        q, p = self.imu.orientation, self.state.pos_est.position
        robot = PyKDL.Frame(
            PyKDL.Rotation.Quaternion(q.x, q.y, q.z, q.w), PyKDL.Vector(p.x, p.y, p.z)
        )
        for i in range(4):
            step = AtlasBehaviorStepData(step_index=i + 1, foot_index=i % 2)
            step.duration, step.swing_height = 0.63, 0.2
            side = 0.12 if i % 2 == 0 else -0.12
            # Both feet of a pair go as far: these are whole numbers.
            ahead = PyKDL.Frame(PyKDL.Vector((1 + i / 2) * 0.2, side, 0.0))
            step.pose = posemath.toMsg(robot * ahead)
            message.walk_params.step_queue[i] = step
        message.k_effort = k_effort
        self.behavior.publish(message)

    def run(self):
        everything, nothing = [255] * JOINTS, "".join(chr(0) for _ in range(JOINTS))
        arms = [0] * JOINTS
        arms[AtlasState.l_arm_ely] = arms[AtlasState.r_arm_ely] = 255
        self.hold(everything)
        time.sleep(0.3)
        self.begin(AtlasSimInterfaceCommand.STAND_PREP, everything)
        time.sleep(0.2)
        self.begin(AtlasSimInterfaceCommand.STAND, nothing)
        time.sleep(0.5)
        self.hold(arms, l_arm_ely=2.1, r_arm_ely=2.1)
        time.sleep(0.5)
        print("elbow at %.1f" % self.joints.position[AtlasState.l_arm_ely])
        begin = self.state.pos_est.position.x
        self.walk(arms)
        time.sleep(4.4)
        print("walked %.1f m" % (self.state.pos_est.position.x - begin))
        self.hold(everything)
        time.sleep(0.3)


if __name__ == "__main__":
    rospy.init_node("control_modes")
    ControlModes().run()
