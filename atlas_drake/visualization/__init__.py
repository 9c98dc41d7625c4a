"""The 3D view in Meshcat and films: scene, footsteps, overlays and colors of links.

The displays read records and never change the simulation.
"""

FRAME_RATE = 32.0
"""Pictures of the 3D view per simulated second [1/s]."""
FILM_SIZE = (960, 540)
"""Default width and height of a film's pictures [pixel]."""
