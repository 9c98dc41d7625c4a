"""What is shown in Meshcat: the world around the robot, footsteps and a caption.

Reads ports; nothing here changes what is simulated.
"""

FRAME_RATE = 32.0
"""Pictures per simulated second, of everything that is shown [1/s]."""
