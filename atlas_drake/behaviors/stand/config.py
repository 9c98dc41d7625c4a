"""What can be tuned of STAND and of the stance guard.

Values only; ``stand`` and ``stance_guard`` use them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class StandConfig:
    """Tunes STAND and STAND_PREP."""

    com_speed: float = 0.08
    """Speed of the CoM reference towards the middle of the feet [m/s]."""
    foot_slip: float = 0.01
    """Re-latch the pose of a sole that slipped farther than this [m]."""


@dataclass(frozen=True)
class StanceGuardConfig:
    """Tunes when STAND and MANIPULATE hold their pose instead of balancing."""

    least_effort: float = 15.0
    """Effort that the behavior must be able to command at hip and ankle pitch of one
    leg to balance with that leg [N·m]."""
