#!/usr/bin/env python
"""Steps up a platform, one foot after the other.

As programs for DRCSim were written: one Python 2, ROS 1 node. Run it with
atlas-drake script examples/scripts/step_up.py --scenario examples/scripts/platform.yaml
"""

from __future__ import print_function

import roslib

roslib.load_manifest("atlas_step_up")

import PyKDL
import rospy
from atlas_msgs.msg import AtlasSimInterfaceCommand, AtlasSimInterfaceState
from tf_conversions import posemath

RISE, AHEAD, HALF_WIDTH = 0.08, 0.35, 0.12  # Of the footholds [m].
LEFT, RIGHT = 0, 1


class StepUp:
    def __init__(self):
        self.state = None
        self.publisher = rospy.Publisher(
            "/atlas/atlas_sim_interface_command", AtlasSimInterfaceCommand, queue_size=1
        )
        rospy.Subscriber(
            "/atlas/atlas_sim_interface_state", AtlasSimInterfaceState, self.on_state
        )

    def on_state(self, message):
        self.state = message

    def wait_for(self, condition):
        rate = rospy.Rate(20)
        while not condition(self.state):
            rate.sleep()

    def command(self, behavior):
        message = AtlasSimInterfaceCommand()
        message.header.stamp = rospy.Time.now()
        message.behavior = behavior
        return message

    def step(self, index, foot, start):
        message = self.command(AtlasSimInterfaceCommand.STEP)
        step = message.step_params.desired_step
        step.step_index = index
        step.foot_index = foot
        step.duration = 1.0
        step.swing_height = 0.1
        side = HALF_WIDTH if foot == LEFT else -HALF_WIDTH
        step.pose = posemath.toMsg(start * PyKDL.Frame(PyKDL.Vector(AHEAD, side, RISE)))
        self.publisher.publish(message)
        self.wait_for(
            lambda state: (
                state.step_feedback.current_step_index == index
                and state.step_feedback.t_step_rem <= 0.0
            )
        )
        print("step %d done at %.1f s" % (index, rospy.get_time()))

    def climb(self):
        self.wait_for(lambda state: state is not None)
        feet = [posemath.fromMsg(pose) for pose in self.state.foot_pos_est]
        # Halfway between the feet, heading where the left one points.
        start = PyKDL.Frame(feet[LEFT].M, (feet[LEFT].p + feet[RIGHT].p) / 2)
        for index, foot in enumerate((LEFT, RIGHT), 1):
            self.step(index, foot, start)
        self.publisher.publish(self.command(AtlasSimInterfaceCommand.STAND))
        rospy.sleep(0.5)
        heights = [pose.position.z for pose in self.state.foot_pos_est]
        print("up there" if min(heights) > RISE - 0.01 else "not up there")


if __name__ == "__main__":
    rospy.init_node("atlas_step_up")
    StepUp().climb()
