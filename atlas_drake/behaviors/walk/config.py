"""Parameters of WALK, gathered from the modules that use the values."""

from dataclasses import dataclass, field

from atlas_drake.behaviors.walk.rules import WalkRules
from atlas_drake.configuration import Configuration
from atlas_drake.control.balance.step_adjustment import StepAdjustmentLimits
from atlas_drake.control.feet.footstep import StepSlack
from atlas_drake.control.feet.swing_foot import SwingProfile


@dataclass(frozen=True)
class WalkConfig(Configuration):
    """Parameters of WALK."""

    rules: WalkRules = field(default_factory=WalkRules)
    """Thresholds of touchdown, lift-off and rest."""
    swing: SwingProfile = field(default_factory=SwingProfile)
    """Shape of the swing."""
    adjustment: StepAdjustmentLimits = field(default_factory=StepAdjustmentLimits)
    """Limits of the step adjustment, which moves the landing place for balance."""
    slack: StepSlack = field(default_factory=StepSlack)
    """Amount by which a step may exceed its limits to correct landing errors."""
