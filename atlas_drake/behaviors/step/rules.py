"""The thresholds that STEP goes by, all of which a scenario can change."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.bounds import Positive, ProperShare, Share


@dataclass(frozen=True)
class StepRules:
    """Thresholds of STEP."""

    touchdown_force: float = 0.04
    """Normal force that counts as touchdown, in weights of the robot [-]."""
    settle: float = 0.25
    """Time for which a new foot is pressed flat before the weight moves [s]."""
    settling_load: float = 0.06
    """Least that it then carries, in weights [-]."""
    fresh_share: Share = 0.4
    """First share of a weight shift in which the foot that landed stays pressed [-]."""
    unload_share: Positive = 0.35
    """Last share of a weight shift in which the leaving foot is unloaded [-]."""
    still_loaded: float = 0.10
    """A foot that carries more than this does not lift off, in weights [-]."""
    dcm_ready: float = 0.02
    """DCM error with which a foot may lift off [m]."""
    dcm_lost: float = 0.01
    """How far inside the support the DCM keeps, or a weight shift is given up [m]."""
    cop_inside: float = 0.01
    """How far inside the support a weight shift plans the CoP [m]."""
    begin_inside: float = 0.015
    """How far inside the support the DCM is when a weight shift may begin [m]."""
    longest_wait: float = 0.3
    """Time after a weight shift for which a foot waits to leave; then it stays [s]."""
    lean_inside: float = 0.025
    """How far inside the standing sole the center of mass stays when it leans into a
    step [m]."""
    rest_speed: float = 0.05
    """Speed of the center of mass below which the robot is at rest [m/s]."""
    heel_begins: ProperShare = 0.5
    """Share of a weight shift after which the leaving heel rises [-]: by then it bears
    no weight."""
    level: float = 0.02
    """Feet at rest that differ less in height let the trunk be upright [m]."""
    least_clearance: float = 0.04
    """Height above its footholds to which a foot is lifted even by a leg short of
    room [m]."""
