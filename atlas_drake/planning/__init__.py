"""Planning: landing poses of the feet for a goal, positions of the arms for the hands.

Geometry and messages only; the motion of a step is in ``behaviors``.
"""
