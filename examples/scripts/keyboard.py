#!/usr/bin/env python
"""Steers Atlas with keys: from the keyboard, or from a file on standard input.

As programs for DRCSim were written: one Python 2, ROS 1 node. Run it with
atlas-drake script examples/scripts/keyboard.py, or feed it
echo "s w 5 f q" to it: each key is a word here, each number a time to wait [s].
"""

from __future__ import print_function

import math
import sys

import roslib

roslib.load_manifest("atlas_keyboard")

import rospy
from atlas_msgs.msg import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
)
from std_msgs.msg import String
from tf.transformations import euler_from_quaternion, quaternion_from_euler

KEYS = """
  w  walk ahead             s  stand
  a  turn left              f  freeze
  d  turn right             q  quit
"""
LENGTH, HALF_WIDTH, TURN = 0.2, 0.12, 0.25  # Of a step [m, m, rad].
MODES = {"s": "Stand", "f": "Freeze"}
GOALS = {"w": (LENGTH, 0.0), "a": (0.0, TURN), "d": (0.0, -TURN)}


class Keyboard:
    def __init__(self):
        self.state = None
        self.command = rospy.Publisher(
            "atlas/atlas_sim_interface_command", AtlasSimInterfaceCommand, None, False
        )
        self.mode = rospy.Publisher("atlas/control_mode", String, None, False)
        rospy.Subscriber(
            "atlas/atlas_sim_interface_state", AtlasSimInterfaceState, self.on_state
        )
        rospy.sleep(0.1)

    def on_state(self, message):
        self.state = message

    def press(self, key):
        if key in MODES:
            self.mode.publish(MODES[key])
        elif key in GOALS:
            self.walk(*GOALS[key])
        else:
            rospy.logwarn("there is no key %s", key)

    def walk(self, ahead, turn):
        """Four steps: two along the goal, and two for the feet to meet there."""
        feet = self.state.foot_pos_est
        x, y = [
            (getattr(feet[0].position, axis) + getattr(feet[1].position, axis)) / 2
            for axis in "xy"
        ]
        q = feet[0].orientation
        yaw = euler_from_quaternion((q.x, q.y, q.z, q.w))[2]
        message = AtlasSimInterfaceCommand()
        message.header.stamp = rospy.Time.now()
        message.behavior = message.WALK
        for i in range(4):
            step = AtlasBehaviorStepData()
            step.step_index, step.foot_index = i + 1, i % 2
            step.duration, step.swing_height = 0.63, 0.1
            rounds = 1 + i / 2
            heading = yaw + rounds * turn
            side = HALF_WIDTH if step.foot_index == 0 else -HALF_WIDTH
            step.pose.position.x = (
                x + rounds * ahead * math.cos(heading) - side * math.sin(heading)
            )
            step.pose.position.y = (
                y + rounds * ahead * math.sin(heading) + side * math.cos(heading)
            )
            orientation = quaternion_from_euler(0, 0, heading)
            for axis, value in zip("xyzw", orientation):
                setattr(step.pose.orientation, axis, value)
            message.walk_params.step_queue[i] = step
        self.command.publish(message)

    def run(self):
        print(KEYS)
        while not rospy.is_shutdown():
            line = sys.stdin.readline()
            if not line:
                return
            for word in line.split():
                if word == "q":
                    return
                elif word.replace(".", "", 1).isdigit():
                    rospy.sleep(float(word))
                else:
                    self.press(word)
                    rospy.sleep(0.1)
                    print("%s at %.1f s" % (word, rospy.get_time()))


if __name__ == "__main__":
    rospy.init_node("atlas_keyboard")
    Keyboard().run()
