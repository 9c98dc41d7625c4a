"""Parameters of STEP, gathered from the modules that use the values."""

from dataclasses import dataclass, field

from atlas_drake.behaviors.body_reference import BodyRates
from atlas_drake.config import Configuration, NotNegative, Positive, ProperShare, Share
from atlas_drake.control.feet.step_limits import StepLimits, quasi_static_limits
from atlas_drake.parts.step.action import ActionRules
from atlas_drake.parts.step.swing_path import SwingPathProfile
from atlas_drake.units import (
    Meters,
    MetersPerRadian,
    MetersPerSecond,
    Radians,
    Ratio,
    Seconds,
)


@dataclass(frozen=True)
class StepRules(Configuration):
    """Thresholds of STEP."""

    touchdown_force: NotNegative[Ratio] = 0.04
    """Normal force that counts as touchdown, in weights of the robot."""
    settle: NotNegative[Seconds] = 0.25
    """Time for which a new foot is pressed flat before the weight moves."""
    settling_load: NotNegative[Ratio] = 0.06
    """Least load of a new foot while it is pressed flat, in weights."""
    fresh_share: Share = 0.4
    """First share of a weight shift in which the landed foot stays pressed."""
    unload_share: Positive[Ratio] = 0.35
    """Last share of a weight shift in which the leaving foot is unloaded."""
    still_loaded: NotNegative[Ratio] = 0.10
    """Largest load of a foot at lift-off, in weights."""
    dcm_ready: NotNegative[Meters] = 0.02
    """Largest DCM error for lift-off."""
    dcm_lost: NotNegative[Meters] = 0.01
    """Abandon a weight shift when the DCM is nearer than this to the edge of the
    support."""
    cop_inside: NotNegative[Meters] = 0.01
    """Distance of a weight shift's planned CoP from the edge of the support."""
    begin_inside: NotNegative[Meters] = 0.015
    """Least distance of the DCM from the edge of the support when a weight shift
    begins."""
    longest_wait: NotNegative[Seconds] = 0.3
    """Longest delay of lift-off after a weight shift, before the step is abandoned."""
    lean_inside: NotNegative[Meters] = 0.025
    """Least distance of the center of mass from the edge of the standing sole when the
    body leans into a step."""
    rest_speed: NotNegative[MetersPerSecond] = 0.05
    """Speed of the center of mass below which the robot is at rest."""
    heel_begins: ProperShare = 0.5
    """Share of a weight shift after which the leaving heel, then without load,
    rises."""
    level: NotNegative[Meters] = 0.02
    """Height difference of the feet at rest below which the trunk is upright."""
    least_clearance: NotNegative[Meters] = 0.04
    """Least height above its footholds to which a foot is lifted, even beyond the reach
    of its leg."""


@dataclass(frozen=True)
class PostureRules(Configuration):
    """Limits of the posture that unloads the standing knee and extends the reach."""

    knee_efforts: tuple[Share, ...] = (0.78, 0.90)
    """Shares of the standing knee's effort limit that a posture may need at rest; the
    second one is tried when the first is not enough."""
    level: NotNegative[Meters] = 0.02
    """Steps that lead up or down by less than this are level."""
    rise_slack: NotNegative[Meters] = 0.01
    """Tolerance of the greatest rise, for ground that differs from the step's
    height."""
    joint_slack: NotNegative[Radians] = 0.02
    """Distance beyond a joint's stop that the kinematics of a posture may be wrong
    by."""
    drop: NotNegative[Meters] = 0.02
    """Distance by which the body sinks for a leg's reach before a heel rises."""
    steepest_heel: NotNegative[Radians] = 0.6
    """Largest angle of a raised heel."""
    forced_heel: NotNegative[Radians] = 0.3
    """Least angle of a heel that is forced to rise."""
    lean: NotNegative[Radians] = 0.36
    """Largest forward lean of the trunk."""
    ahead: NotNegative[Meters] = 0.05
    """Largest distance of the CoM ahead of the sole's middle; like the lean, it reduces
    the torque of a bent knee."""
    squat: Positive[Meters] = 0.40
    """Range below the highest position in which the lowest is searched."""
    lean_shift: NotNegative[MetersPerRadian] = 0.2
    """Distance of the hips behind the center of mass per lean."""
    smallest_share: Share = 0.3
    """Least share of its length to which a step is shortened."""


@dataclass(frozen=True)
class StepConfig(Configuration):
    """Parameters of STEP."""

    limits: StepLimits = field(default_factory=quasi_static_limits)
    """Limits of one step."""
    body: BodyRates = field(default_factory=lambda: BodyRates(yaw=0.5))
    """Speed limits of the reference of trunk and posture."""
    rules: StepRules = field(default_factory=StepRules)
    """Thresholds of touchdown, lift-off and rest."""
    posture: PostureRules = field(default_factory=PostureRules)
    """Limits of the posture that unloads the standing knee and extends the reach."""
    action: ActionRules = field(default_factory=ActionRules)
    """Values of step actions, and which of a message count."""
    swing: SwingPathProfile = field(default_factory=SwingPathProfile)
    """Shape of the swing."""
