"""The thresholds of a walk, all of which a scenario can change."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.config import Configuration, NotNegative, Positive, Share


@dataclass(frozen=True)
class WalkRules(Configuration):
    """Thresholds of the walk."""

    touchdown_force: NotNegative = 0.08
    """Normal force that counts as touchdown, in weights of the robot [-]."""
    landing_force: NotNegative = 0.01
    """Normal force that counts as touchdown in the last part of a swing, ``frozen_end``
    long, and later, when the ground is expected; in weights of the robot [-]. A foot
    that bounces lightly passes between two ticks through any larger force."""
    earliest_touchdown: Share = 0.75
    """Share of the swing before which contact is a stumble, not a touchdown [-]."""
    unload_share: Positive = 0.4
    """Last share of a transfer in which the leaving foot is unloaded [-]."""
    dcm_ready: NotNegative = 0.025
    """Largest DCM error for lift-off [m]."""
    dcm_lost: NotNegative = 0.03
    """Distance of the DCM outside the support polygon, beyond that of the plan, from
    which only a step saves the balance: the next foot lifts off at once [m]."""
    hurried_transfer: NotNegative = 0.06
    """Time to load the other foot before such a lift-off [s]."""
    feet_apart: NotNegative = 0.05
    """Distance of a foot from its place beside the other one, from which it is put
    there after a step that caught the balance [m]."""
    longest_wait: NotNegative = 0.25
    """Longest delay of lift-off until the DCM error is small enough [s]."""
    straight_flexion: NotNegative = 0.12
    """Lift off without further delay when the leaving knee is bent by less than this
    from the straight leg [rad]."""
    frozen_end: NotNegative = 0.06
    """Last part of a swing in which the landing place does not change [s]."""
    rest_speed: NotNegative = 0.08
    """Speed of the center of mass below which the walk is over [m/s]."""
    replan_shift: NotNegative = 0.002
    """Least change of the landing place for a new plan [m]."""
    quick_step: NotNegative = 0.70
    """Longest duration of a step in which the height of the center of mass may yield
    (``gains.weights.com_height_quick``) [s]: it has no time to sink far."""
    transfer_change: NotNegative = 0.15
    """Largest change of a transfer's duration, as a share of it, to correct an early or
    late touchdown. A larger timing error comes from a disturbance, and is not corrected
    further [-]."""
    height_rate: NotNegative = 0.30
    """Speed at which the reference of the CoM's height follows the ground [m/s]; less
    falls behind on stairs."""
    leg_stretch: NotNegative = 0.04
    """Stretch of the lower leg on uneven ground [m]."""
