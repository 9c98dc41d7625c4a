"""Parameters of STAND.

Values only; ``stand`` uses them.
"""

from dataclasses import dataclass

from atlas_drake.configuration import Configuration, NotNegative


@dataclass(frozen=True)
class StandConfig(Configuration):
    """Parameters of STAND and STAND_PREP."""

    com_speed: NotNegative = 0.08
    """Speed of the CoM reference towards the middle of the feet [m/s]."""
    foot_slip: NotNegative = 0.01
    """Re-latch the pose of a sole that slipped farther than this [m]."""
