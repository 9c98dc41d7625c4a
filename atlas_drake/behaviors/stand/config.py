"""Parameters of STAND.

Values only; ``stand`` uses them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class StandConfig:
    """Parameters of STAND and STAND_PREP."""

    com_speed: float = 0.08
    """Speed of the CoM reference towards the middle of the feet [m/s]."""
    foot_slip: float = 0.01
    """Re-latch the pose of a sole that slipped farther than this [m]."""
