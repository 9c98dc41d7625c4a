"""Parameters of STEP, gathered from the modules that use the values."""

from dataclasses import dataclass, field

from atlas_drake.behaviors.body_reference import BodyRates
from atlas_drake.behaviors.step.plan import PostureRules
from atlas_drake.behaviors.step.rules import StepRules
from atlas_drake.configuration import Configuration
from atlas_drake.control.feet.step_limits import StepLimits, quasi_static_limits
from atlas_drake.control.feet.step_swing import StepSwingProfile


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
    swing: StepSwingProfile = field(default_factory=StepSwingProfile)
    """Shape of the swing."""
