"""A gantry that carries the robot until it is released."""
