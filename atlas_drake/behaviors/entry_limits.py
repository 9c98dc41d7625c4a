"""Limits within which STAND can take over a robot that does not balance.

The condition that reads these limits is in ``shipped``.
"""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.configuration import Configuration, NotNegative


@dataclass(frozen=True)
class EntryLimits(Configuration):
    """Limits within which STAND can take over."""

    com_inside: NotNegative = 0.01
    """Least distance of the CoM from the edge of the support polygon, inside it [m]."""
    dcm_inside: NotNegative = 0.03
    """Least distance of the DCM from the edge of the support polygon, inside it [m]."""
    joint_speed: NotNegative = 4.0
    """Largest speed of any joint that STAND takes over [rad/s]."""
