"""Limits within which STAND can take over a robot that does not balance.

The condition that reads these limits is in ``shipped``.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class EntryLimits:
    """Limits within which STAND can take over."""

    com_inside: float = 0.01
    """Least distance of the CoM from the edge of the support polygon, inside it [m]."""
    dcm_inside: float = 0.03
    """Least distance of the DCM from the edge of the support polygon, inside it [m]."""
    joint_speed: float = 4.0
    """Largest speed of any joint that STAND takes over [rad/s]."""
