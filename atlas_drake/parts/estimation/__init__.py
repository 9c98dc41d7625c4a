"""Estimation of the robot's state from joints, feet and IMU."""
