"""The thresholds that a walk goes by, all of which a scenario can change."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.bounds import Positive, Share


@dataclass(frozen=True)
class WalkRules:
    """Thresholds of the walk."""

    touchdown_force: float = 0.08
    """Normal force that counts as touchdown, in weights of the robot [-]."""
    earliest_touchdown: Share = 0.75
    """Share of the swing before which contact is a stumble, not a touchdown."""
    unload_share: Positive = 0.4
    """Last share of a transfer in which the leaving foot is unloaded [-]."""
    dcm_ready: float = 0.025
    """DCM error with which a foot may lift off [m]."""
    longest_wait: float = 0.25
    """Time that lift-off waits at most for that [s]."""
    straight_flexion: float = 0.12
    """A leg whose knee is bent by less, counted from the straight leg, does not wait
    any longer [rad]."""
    frozen_end: float = 0.06
    """Last part of a swing in which the landing place stays put [s]."""
    rest_speed: float = 0.08
    """Speed of the center of mass below which the walk is over [m/s]."""
    replan_shift: float = 0.002
    """Change of the landing place that is worth a new plan [m]."""
    transfer_change: float = 0.15
    """Share by which a transfer is longer or shorter, at most, to make up for a
    touchdown before or after its time. A foot that is farther off was disturbed, and
    the next step shall not wait for the clock [-]."""
    leg_stretch: float = 0.04
    """Stretch of the lower leg where the ground is uneven [m]."""
