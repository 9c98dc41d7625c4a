"""All parameters of the whole-body controller, in one value.

Gathers the configurations, each of which is defined beside the code that it configures;
no parameter is defined here. A robot's file gives its own values at the same paths,
and the configuration of each registered behavior is one more field.
"""

import functools
from collections.abc import Iterable, Mapping
from dataclasses import (
    asdict,
    dataclass,
    field,
    fields,
    is_dataclass,
    make_dataclass,
    replace,
)
from typing import Any

from atlas_drake.behaviors.balance import StanceConfig
from atlas_drake.behaviors.body_reference import BodyRates
from atlas_drake.behaviors.body_sway import BodySway
from atlas_drake.behaviors.entry import BehaviorEntry, EntryLimits
from atlas_drake.behaviors.fall import FallLimits
from atlas_drake.behaviors.freeze import FreezeConfig
from atlas_drake.behaviors.leg_ranges import stance_clearing, within_ranges
from atlas_drake.behaviors.manipulate.manipulate import ManipulateConfig
from atlas_drake.behaviors.scaling import feet_fitting, scaled
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.step.config import StepConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.config import Configuration, checked, declared
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.control.gains import ControlGains
from atlas_drake.errors import ScenarioError
from atlas_drake.planning.footholds import Gait
from atlas_drake.robot import (
    DEFAULT_ROBOT,
    Robot,
    RobotFile,
    Size,
    read_robot_file,
)


@dataclass(frozen=True)
class ControllerConfig(Configuration):
    """Parameters of the controller; field ``controller`` of a scenario.

    The configuration of a behavior of your own, BOW for example, is one more field,
    ``bow``.
    """

    gains: ControlGains = field(default_factory=ControlGains)
    """Gains and weights of the whole-body controller."""
    stance: StanceConfig = field(default_factory=StanceConfig)
    """How the robot stands."""
    body: BodyRates = field(default_factory=BodyRates)
    """Speed limits of the trunk and posture reference in STAND, WALK and MANIPULATE."""
    sway: BodySway = field(default_factory=BodySway)
    """Swing of pelvis and arms with the feet of a walk."""
    entry: EntryLimits = field(default_factory=EntryLimits)
    """Conditions under which STAND can take over."""
    fall: FallLimits = field(default_factory=FallLimits)
    """Posture that counts as a fall."""
    freeze: FreezeConfig = field(default_factory=FreezeConfig)
    stand: StandConfig = field(default_factory=StandConfig)
    walk: WalkConfig = field(default_factory=WalkConfig)
    step: StepConfig = field(default_factory=StepConfig)
    manipulate: ManipulateConfig = field(default_factory=ManipulateConfig)

    @staticmethod
    def of(
        file: RobotFile,
        robot: Robot | None,
        behaviors: Iterable[BehaviorEntry] | None = None,
    ) -> "ControllerConfig":
        """Returns the configuration of a robot: its file's values, or else defaults.

        Atlas' values are scaled to the robot, and its steps are within the ranges of
        its legs; with None it has the defaults as they are.
        """
        config = ControllerConfig()
        if robot is not None:
            atlas = read_robot_file(DEFAULT_ROBOT).controller
            config = config.with_values(atlas).scaled(robot.size)
            walk, stance = config.walk, config.stance
            width = stance_clearing(stance.width, walk.limits, robot)
            limits = within_ranges(walk.limits, robot, width, stance.com_drop)
            config = replace(
                config,
                stance=replace(stance, width=width),
                walk=replace(walk, limits=limits),
            )
        return config.with_values(file.controller, behaviors)

    def scaled(self, size: Size) -> "ControllerConfig":
        """Returns the configuration, scaled to a robot of this size."""
        made = scaled(self, size)

        def fitting(limits: StepLimits) -> StepLimits:
            return replace(limits, width=feet_fitting(limits.width, size))

        return replace(
            made,
            stance=replace(made.stance, width=size.stance_width),
            walk=replace(made.walk, limits=fitting(made.walk.limits)),
            step=replace(made.step, limits=fitting(made.step.limits)),
        )

    def with_values(
        self,
        values: Mapping[str, Any],
        behaviors: Iterable[BehaviorEntry] | None = None,
    ) -> "ControllerConfig":
        """Returns the configuration with some values changed.

        Args:
            values: Values by field, as in YAML.
            behaviors: Entries of the registered behaviors, whose configurations are
                fields, too. None if the behaviors are not known yet: then mappings
                under other names are neither checked nor kept.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        shared = [one.name for one in fields(ControllerConfig)]
        own = {
            entry.configured_at: entry.config
            for entry in behaviors or ()
            if entry.config is not None and entry.configured_at not in shared
        }
        kind = _with_fields(tuple((name, type(one)) for name, one in own.items()))
        base = {name: getattr(self, name, own.get(name)) for name in (*shared, *own)}
        given = dict(values)
        if behaviors is None:
            # Fields under another name may be those of a behavior that is yet to come.
            given = {
                name: value
                for name, value in values.items()
                if name in base
                or not (isinstance(value, Mapping) or is_dataclass(value))
            }
        made: ControllerConfig = checked(kind, given, "controller", base=base)
        return made

    def gait(self, **desired: float) -> Gait:
        """Returns the usual gait.

        Args:
            **desired: Values of stride, turn, duration and swing_height other than
                the usual ones.

        Raises:
            ValueError: If the robot cannot walk like that.
        """
        usual = {**asdict(self.walk.steps), "swing_height": self.walk.swing.height}
        return Gait(
            **{**usual, **desired},
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


@functools.cache
def _with_fields(own: tuple[tuple[str, type], ...]) -> type[ControllerConfig]:
    """Returns the configuration's class, with a field for each of the user's own."""
    if not own:
        return ControllerConfig
    return make_dataclass(
        "ExtendedControllerConfig",
        [(name, declared(kind)) for name, kind in own],
        bases=(ControllerConfig,),
        frozen=True,
        kw_only=True,
    )
