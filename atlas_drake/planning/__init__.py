"""Footstep planning: landing poses of the feet for a goal.

Geometry and messages only; the motion of a step is in ``behaviors``.
"""
