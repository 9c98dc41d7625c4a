"""Colors of quantities of the controller, the same in figures and 3D view."""

from __future__ import annotations

from pydrake.geometry import Rgba

COM = Rgba(0.10, 0.62, 0.32, 1.0)
"""Green."""
DCM = Rgba(0.78, 0.12, 0.55, 1.0)
"""Magenta."""
COP = Rgba(0.85, 0.12, 0.10, 1.0)
"""Red."""
SUPPORT = Rgba(0.20, 0.25, 0.35, 0.50)
"""Grey."""
SWING = Rgba(0.05, 0.60, 0.66, 1.0)
"""Teal."""
FORCE = Rgba(0.93, 0.68, 0.05, 1.0)
"""Yellow."""

BEHAVIOR_RGB, SHARED_RGB, USER_RGB = (
    (0.32, 0.52, 0.82),
    (0.66, 0.30, 0.68),
    (0.96, 0.58, 0.12),
)
"""Blue, violet and amber: the behavior's joint, half each, the user's."""
IDLE_RGB, BUSY_RGB, SPENT_RGB = (0.50, 0.57, 0.66), (0.95, 0.80, 0.15), (0.85, 0.1, 0.1)
"""Grey, yellow and red: no effort, half of its limit, all of it."""
