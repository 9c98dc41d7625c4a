"""The 3D view in Meshcat: scene, footsteps, overlays and colors of links.

The displays read records and never change the simulation.
"""

FRAME_RATE = 32.0
"""Pictures of the 3D view per simulated second [1/s]."""
