"""All parameters of the whole-body controller, in one value.

Gathers the configurations, each of which is defined beside the code that it configures;
no parameter is defined here. A robot's file gives its own values at the same paths.
"""

from dataclasses import asdict, dataclass, field
from typing import Any, Self

from atlas_drake.behaviors.body_reference import BodyRates
from atlas_drake.behaviors.entry_limits import EntryLimits
from atlas_drake.behaviors.fall import FallLimits
from atlas_drake.behaviors.freeze import FreezeConfig
from atlas_drake.behaviors.manipulate.config import ManipulateConfig
from atlas_drake.behaviors.stance import StanceConfig
from atlas_drake.behaviors.stand.config import StandConfig
from atlas_drake.behaviors.step.config import StepConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.checked import checked
from atlas_drake.configuration import Configuration
from atlas_drake.control.gains import ControlGains
from atlas_drake.errors import ScenarioError
from atlas_drake.planning.footholds import Gait
from atlas_drake.robot import RobotFile


@dataclass(frozen=True)
class ControllerConfig(Configuration):
    """Parameters of the controller; field ``controller`` of a scenario."""

    gains: ControlGains = field(default_factory=ControlGains)
    """Gains and weights of the whole-body controller."""
    stance: StanceConfig = field(default_factory=StanceConfig)
    """How the robot stands."""
    body: BodyRates = field(default_factory=BodyRates)
    """Speed limits of the trunk and posture reference in STAND, WALK and MANIPULATE."""
    entry: EntryLimits = field(default_factory=EntryLimits)
    """Conditions under which STAND can take over."""
    fall: FallLimits = field(default_factory=FallLimits)
    """Posture that counts as a fall."""
    freeze: FreezeConfig = field(default_factory=FreezeConfig)
    stand: StandConfig = field(default_factory=StandConfig)
    walk: WalkConfig = field(default_factory=WalkConfig)
    step: StepConfig = field(default_factory=StepConfig)
    manipulate: ManipulateConfig = field(default_factory=ManipulateConfig)
    behaviors: dict[str, Any] = field(default_factory=dict)
    """Configurations of registered behaviors by name, such as ``BOW: {depth: 0.3}``;
    checked against the configuration dataclass of the behavior's entry."""

    @classmethod
    def of(cls, file: RobotFile) -> Self:
        """Returns the configuration of a robot: its file's values, or else defaults.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        made: Self = checked(cls, file.controller, "controller", from_text=True)
        return made

    def gait(self, **wanted: float) -> Gait:
        """Returns the usual gait.

        Args:
            **wanted: Values of stride, turn, duration and swing_height that differ from
                the usual ones.

        Raises:
            ValueError: If the robot cannot walk like that.
        """
        usual = {**asdict(self.walk.steps), "swing_height": self.walk.swing.height}
        return Gait(
            **{**usual, **wanted},
            limits=self.walk.limits,
            stance_width=self.stance.width,
        )

    def check(self) -> None:
        """Checks that feet side by side are within the limits of a step."""
        least, greatest = self.walk.limits.width
        if not least <= self.stance.width <= greatest:
            width = self.stance.width
            problem = f"walk.limits.width is {least:g} to {greatest:g}"
            raise ScenarioError.about("stance.width", width, problem)

    @property
    def of_behaviors(self) -> dict[str, Any]:
        """Configuration of each behavior that has one, by the behavior's name."""
        return {
            "FREEZE": self.freeze,
            "STAND_PREP": self.stand,
            "STAND": self.stand,
            "WALK": self.walk,
            "STEP": self.step,
            "MANIPULATE": self.manipulate,
        }
