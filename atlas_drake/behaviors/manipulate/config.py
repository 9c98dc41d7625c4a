"""Parameters of MANIPULATE. Values only."""

from dataclasses import dataclass, field

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.control.pelvis.pelvis_pose import (
    PelvisLead,
    PelvisRange,
    PelvisRates,
)
from atlas_drake.control.pelvis.pelvis_reach import PelvisReserves


@dataclass(frozen=True)
class ManipulateConfig(Configuration):
    """Parameters of MANIPULATE."""

    range: PelvisRange = field(default_factory=PelvisRange)
    """Range of pelvis poses."""
    reserves: PelvisReserves = field(default_factory=PelvisReserves)
    """Reserves for balance, which limit the pelvis poses further."""
    rates: PelvisRates = field(default_factory=PelvisRates)
    """Speed and acceleration of pelvis and CoM."""
    lead: PelvisLead = field(default_factory=PelvisLead)
    """Largest lead of the reference over a robot that does not follow."""
    foot_slip: NotNegative = 0.002
    """Re-latch the pose of a sole that slipped farther than this [m]. Small, because
    all poses are relative to the soles."""
    arms_moved: NotNegative = 0.01
    """Clamp the requested pose again when the CoM of trunk and arms has moved this far
    in the pelvis frame, for example when the user's arms reach out [m]."""
    home: NotNegative = 0.002
    """Hand over to STAND when the reference is this near to STAND's pose [m], [rad]."""
