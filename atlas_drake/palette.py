"""Colors of quantities of the controller, the same in figures and 3D view.

Red, green and blue, 0 to 1.
"""

from __future__ import annotations

Color = tuple[float, float, float]

COM: Color = (0.10, 0.62, 0.32)
"""Green."""
DCM: Color = (0.78, 0.12, 0.55)
"""Magenta."""
COP: Color = (0.85, 0.12, 0.10)
"""Red."""
CMP: Color = (0.95, 0.55, 0.15)
"""Orange."""
SUPPORT: Color = (0.20, 0.25, 0.35)
"""Grey."""
SWING: Color = (0.05, 0.60, 0.66)
"""Teal."""
FORCE: Color = (0.93, 0.68, 0.05)
"""Yellow."""
FEET: tuple[Color, Color] = ((0.10, 0.42, 0.85), (0.90, 0.42, 0.08))
"""Blue and orange: the left and the right foot."""

BEHAVIOR, SHARED, USER = (0.32, 0.52, 0.82), (0.66, 0.30, 0.68), (0.96, 0.58, 0.12)
"""Blue, violet and amber: the behavior's joint, half each, the user's."""
POLICY: Color = (0.10, 0.60, 0.55)
"""Blue green: a learned policy's joint."""
IDLE, BUSY, SPENT = (0.50, 0.57, 0.66), (0.95, 0.80, 0.15), (0.85, 0.1, 0.1)
"""Grey, yellow and red: no effort, half of its limit, all of it."""
