"""Parameters of WALK: its timing, thresholds, limits and usual steps. Values only."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from atlas_drake.config import Configuration, NotNegative, Positive, ProperShare, Share
from atlas_drake.control.balance.step_adjustment import StepAdjustmentLimits
from atlas_drake.control.feet.foot_roll import FootRoll
from atlas_drake.control.feet.step_limits import StepLimits, StepSlack
from atlas_drake.control.feet.swing_foot import SwingProfile
from atlas_drake.errors import ScenarioError
from atlas_drake.planning.footholds import UsualSteps
from atlas_drake.units import Meters, MetersPerSecond, Radians, Ratio, Seconds


@dataclass(frozen=True, kw_only=True)
class GaitTiming(Configuration):
    """Durations of a walk's phases that the duration of a step does not define."""

    first_shift: NotNegative[Seconds] = 0.80
    """Weight shift before the first lift-off."""
    transfer_share: ProperShare = 0.20
    """Share of a step's duration in double support. In single support the error of the
    DCM grows, and only the ankle corrects it; but a shorter swing takes more energy,
    10 % at a share of a quarter."""
    settle: NotNegative[Seconds] = 0.70
    """Weight shift to the middle of the feet after the last step."""
    rest: NotNegative[Seconds] = 0.50
    """Time at rest before STAND takes over."""

    def transfer(self, duration: float) -> float:
        """Computes the double support before the lift-off of a step [s]."""
        return self.transfer_share * duration

    def swing(self, duration: float) -> float:
        """Computes the single support of a step of this duration [s]."""
        return (1.0 - self.transfer_share) * duration


@dataclass(frozen=True)
class WalkRules(Configuration):
    """Thresholds of the walk."""

    touchdown_force: NotNegative[Ratio] = 0.08
    """Normal force that counts as touchdown, in weights of the robot."""
    landing_force: NotNegative[Ratio] = 0.01
    """Normal force that counts as touchdown in the last part of a swing, ``frozen_end``
    long, and later, when the ground is expected; in weights of the robot. A foot that
    bounces lightly passes between two ticks through any larger force."""
    ground_near: NotNegative[Meters] = 0.02
    """Height of a sole's lowest edge above its place up to which the ground may have
    turned it: what turns a foot that is higher is a push."""
    landing_upright: Share = 0.9
    """Cosine of the largest tilt of a sole that has landed."""
    landing_turn: Positive[Radians] = 0.03
    """Turn of a sole on its toes, from its reference toward flat, that counts as
    touchdown."""
    earliest_touchdown: Share = 0.75
    """Share of the swing before which contact is a stumble, not a touchdown."""
    unload_share: Positive[Ratio] = 0.4
    """Last share of a transfer in which the leaving foot is unloaded."""
    dcm_ready: NotNegative[Meters] = 0.035
    """Largest DCM error for lift-off."""
    dcm_lost: NotNegative[Meters] = 0.01
    """Distance of the DCM outside the support polygon, beyond that of the plan, from
    which only a step saves the balance: the next foot lifts off at once."""
    feet_apart: NotNegative[Meters] = 0.03
    """Distance of a foot from its place beside the other one, from which it is put
    there once the balance is caught. Below what a step in place is wider than the
    stance (``in_place.width``)."""
    longest_wait: NotNegative[Seconds] = 0.25
    """Longest delay of lift-off until the DCM error is small enough."""
    straight_flexion: NotNegative[Radians] = 0.12
    """Lift off without further delay when the leaving knee is bent by less than this
    from the straight leg."""
    frozen_end: NotNegative[Seconds] = 0.06
    """Last part of a swing in which the landing place does not change."""
    rest_speed: NotNegative[MetersPerSecond] = 0.08
    """Speed of the center of mass below which the walk is over."""
    replan_shift: NotNegative[Meters] = 0.002
    """Least change of the landing place for a new plan."""
    quick_step: NotNegative[Seconds] = 0.70
    """Longest duration of a step in which the height of the center of mass may yield
    (``gains.weights.com_height_quick``): it has no time to sink far."""
    quick_sink: NotNegative[MetersPerSecond] = 0.45
    """Speed at which the center of mass sinks from which it is held up as in a slow
    step. Above that of any touchdown: at a metre a second a walk that is held up lands
    with 2.1 weights instead of 1.6."""
    transfer_change: NotNegative[Ratio] = 0.40
    """Largest change of a transfer's duration, as a share of it, to correct an early or
    late touchdown. A larger timing error comes from a disturbance, and is not corrected
    further."""
    height_rate: NotNegative[MetersPerSecond] = 0.30
    """Speed at which the reference of the CoM's height follows the ground; less falls
    behind on stairs."""
    leg_stretch: NotNegative[Meters] = 0.04
    """Stretch of the lower leg on uneven ground."""


@dataclass(frozen=True)
class StepsInPlace(Configuration):
    """Steps after one that caught the balance, until the robot is quiet.

    Nobody commanded them: the feet come together step by step, and the robot comes to
    rest on its way.
    """

    most: NotNegative[int] = 4
    """Largest number of them."""
    width: Positive[Ratio] = 1.2
    """Distance between the feet, in widths of the stance."""
    height: Positive[Ratio] = 0.5
    """Apex of the swings, in that of usual steps."""
    quiet_speed: NotNegative[MetersPerSecond] = 0.25
    """Speed of the center of mass at touchdown below which a usual step, which puts the
    feet side by side, is the last; none if they are."""


@dataclass(frozen=True)
class WalkConfig(Configuration):
    """Parameters of WALK."""

    timing: GaitTiming = field(default_factory=GaitTiming)
    """Durations of the phases."""
    limits: StepLimits = field(default_factory=StepLimits)
    """Limits of one step."""
    steps: UsualSteps = field(default_factory=UsualSteps)
    """Default steps of planners and demonstrations; their apex is ``swing.height``."""
    rules: WalkRules = field(default_factory=WalkRules)
    """Thresholds of touchdown, lift-off and rest."""
    swing: SwingProfile = field(default_factory=SwingProfile)
    """Shape of the swing."""
    roll: FootRoll = field(default_factory=FootRoll)
    """Pitch of the soles at lift-off and touchdown."""
    cop_inward: NotNegative[Meters] = 0.015
    """Distance of the CoP reference in single support from the middle of the stance
    sole, toward the other foot: the legs, which sway with the robot, move the CoP
    outward by about as much."""
    cop_up: NotNegative[Ratio] = 0.45
    """Distance of that reference ahead of the middle of the stance sole, per height of
    a step up: the higher knee carries less."""
    cop_down: NotNegative[Ratio] = 0.30
    """The same per height of a step down."""
    com_rise: NotNegative[Meters] = 0.05
    """Rise of the center of mass above its height in STAND, in a walk with full pitch
    of the soles: toe-off lengthens the trailing leg, and the knees bend less."""
    adjustment: StepAdjustmentLimits = field(default_factory=StepAdjustmentLimits)
    """The step adjustment, which moves and hastens a step for balance."""
    in_place: StepsInPlace = field(default_factory=StepsInPlace)
    """Steps in place after one that caught the balance."""
    slack: StepSlack = field(default_factory=StepSlack)
    """Amount by which a step may exceed its limits to correct landing errors."""

    @cached_property
    def limits_for_balance(self) -> StepLimits:
        """Limits of a step that balance moves."""
        return self.slack.loosen(self.limits).extended(self.adjustment.stretch)

    def check(self) -> None:
        """Checks that the default steps are within the limits."""
        limits = self.limits
        for name, value, most in (
            ("steps.stride", self.steps.stride, limits.forward),
            ("steps.turn", self.steps.turn, limits.toe_in),
            ("steps.duration", self.steps.duration, limits.duration.greatest),
            ("swing.height", self.swing.height, limits.swing_height.greatest),
        ):
            if value > most:
                problem = f"the limits allow {most:g} at most"
                raise ScenarioError.about(name, value, problem)
