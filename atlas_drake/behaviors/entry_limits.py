"""When STAND can take over a robot that does not balance.

The condition that reads these limits is in ``shipped``.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class EntryLimits:
    """When STAND can take over; measured by ``benchmarks/entry_limits.py``."""

    com_inside: float = 0.01
    """The CoM must lie this far inside the soles' hull less its margins [m]."""
    dcm_inside: float = 0.03
    """And the DCM this far, which is where it would come to rest by itself [m]."""
    joint_speed: float = 4.0
    """Fastest joint that the behavior would have to catch [rad/s]."""
