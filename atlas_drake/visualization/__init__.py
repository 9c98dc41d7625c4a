"""The 3D view in Meshcat and videos: scene, footsteps, overlays and caption.

The displays read ports and never change the simulation.
"""

FRAME_RATE = 32.0
"""Pictures of all displays per simulated second [1/s]."""
