"""Terrain, obstacles and models around the robot, as data and as geometry."""
