"""Parameters of WALK, gathered from the modules that use the values."""

from dataclasses import dataclass, field

from atlas_drake.behaviors.walk.rules import WalkRules
from atlas_drake.behaviors.walk.timing import GaitTiming
from atlas_drake.config import Configuration, NotNegative
from atlas_drake.control.balance.step_adjustment import StepAdjustmentLimits
from atlas_drake.control.feet.step_limits import StepLimits, StepSlack
from atlas_drake.control.feet.swing_foot import SwingProfile
from atlas_drake.errors import ScenarioError
from atlas_drake.planning.footholds import UsualSteps


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
    cop_inward: NotNegative = 0.010
    """Distance of the CoP reference in single support from the middle of the stance
    sole, toward the other foot [m]."""
    adjustment: StepAdjustmentLimits = field(default_factory=StepAdjustmentLimits)
    """The step adjustment, which moves and hastens a step for balance."""
    slack: StepSlack = field(default_factory=StepSlack)
    """Amount by which a step may exceed its limits to correct landing errors."""

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
