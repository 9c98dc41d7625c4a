"""Footsteps for a goal: where the feet shall go.

Geometry and messages only; how a step is taken is in ``behaviors``.
"""
