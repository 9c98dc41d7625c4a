"""Logs as pictures that move: in the 3D view, and as a film without a browser."""

FILM_SIZE = (960, 540)
"""Default width and height of a film's pictures [pixel]."""
