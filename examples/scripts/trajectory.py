#!/usr/bin/env python
"""Sends the joints through a trajectory of a YAML file: FILE.yaml NAME.

As programs for DRCSim were written: one Python 2, ROS 1 node. Run it with
atlas-drake script examples/scripts/trajectory.py -- examples/scripts/poses.yaml NAME.
"""

from __future__ import print_function

import sys

import roslib

roslib.load_manifest("atlas_trajectory")

import numpy
import rospy
import yaml
from osrf_msgs.msg import JointCommands
from sensor_msgs.msg import JointState

RATE = 50  # Set-points per second.


class Trajectory:
    def __init__(self):
        self.joints = {}
        rospy.Subscriber("/atlas/joint_states", JointState, self.on_joints)
        self.publisher = rospy.Publisher(
            "/atlas/joint_commands", JointCommands, queue_size=1
        )

    def on_joints(self, message):
        self.joints = dict(zip(message.name, message.position))

    def command_for(self, names):
        command = JointCommands()
        command.name = ["atlas::" + name for name in names]
        count = len(names)
        for array in ("position", "velocity", "effort", "kp_velocity"):
            setattr(command, array, numpy.zeros(count))
        gains = [rospy.get_param("atlas_controller/gains/" + name) for name in names]
        command.kp_position = [gain["p"] for gain in gains]
        command.ki_position = [gain["i"] for gain in gains]
        command.kd_position = [gain["d"] for gain in gains]
        command.i_effort_max = [gain["i_clamp"] for gain in gains]
        command.i_effort_min = [-gain["i_clamp"] for gain in gains]
        return command

    def follow(self, poses):
        rate = rospy.Rate(RATE)
        for pose in poses:
            names = sorted(pose["joints"])
            command = self.command_for(names)
            begin = numpy.array([self.joints[name] for name in names])
            end = numpy.array([pose["joints"][name] for name in names])
            rounds = int(pose["seconds"] * RATE)
            for i in xrange(rounds):
                share = (i + 1.0) / rounds
                command.header.stamp = rospy.Time.now()
                command.position = (1.0 - share) * begin + share * end
                self.publisher.publish(command)
                rate.sleep()
            print("%s: there at %.1f s" % (pose["name"], rospy.get_time()))


if __name__ == "__main__":
    arguments = rospy.myargv(argv=sys.argv)
    if len(arguments) != 3:
        sys.exit("usage: trajectory.py FILE.yaml NAME")
    trajectories = yaml.load(file(arguments[1], "r"))
    if not trajectories.has_key(arguments[2]):
        sys.exit("%s has no trajectory %s" % (arguments[1], arguments[2]))
    rospy.init_node("atlas_trajectory")
    node = Trajectory()
    rospy.sleep(0.1)  # The joints' positions are known then.
    node.follow(trajectories[arguments[2]])
