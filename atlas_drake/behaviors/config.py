"""All parameters of the whole-body controller, in one value.

Gathers the configurations, each of which is defined beside the code that it configures;
no parameter is defined here. A robot's file gives its own values at the same paths,
and the configuration of each registered behavior is one more field.
"""

import functools
from collections.abc import Callable, Iterable, Mapping
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
from atlas_drake.behaviors.scaling import feet_fitting, scaled
from atlas_drake.behaviors.stand.stand import StandConfig
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.config import Configuration, LeastGreatest, checked, declared
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.control.gains import ControlGains
from atlas_drake.control.whole_body.hand_loads import HandLoads
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

    The configuration of each other behavior is one more field: ``step``,
    ``manipulate``, or ``bow`` of a behavior BOW of your own.
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
    hand_loads: HandLoads = field(default_factory=HandLoads)
    """How what the hands carry becomes part of the model."""
    freeze: FreezeConfig = field(default_factory=FreezeConfig)
    stand: StandConfig = field(default_factory=StandConfig)
    walk: WalkConfig = field(default_factory=WalkConfig)

    @staticmethod
    def of(
        file: RobotFile,
        robot: Robot | None,
        shipped: Iterable[BehaviorEntry],
        own: Iterable[BehaviorEntry] | None = (),
    ) -> "ControllerConfig":
        """Returns the configuration of a robot: its file's values, or else defaults.

        Atlas' values are scaled to the robot, and its steps are within the ranges of
        its legs; with None it has the defaults as they are.

        Args:
            file: Has values of its own.
            robot: To scale by.
            shipped: Entries whose configurations are fields, and scale as well.
            own: Entries whose configurations are fields as they are; None if they are
                not known yet, see ``with_values``.
        """
        config = ControllerConfig().with_behaviors(shipped)
        if robot is not None:
            atlas = read_robot_file(DEFAULT_ROBOT).controller
            config = config.with_values(atlas, ignore_unknown=True).scaled(robot.size)
            config = config.within_reach(robot, file.controller.get("stance", {}))
        return config.with_behaviors(own or ()).with_values(
            file.controller, ignore_unknown=own is None
        )

    def within_reach(
        self, robot: Robot, stance: Mapping[str, Any]
    ) -> "ControllerConfig":
        """Returns the configuration with steps that a robot's legs reach and clear.

        ``stance`` has the values of its file, whose width it keeps.
        """
        limits, drop = self.walk.limits, self.stance.com_drop
        clearing = stance_clearing(self.stance.width, limits, robot)
        width = stance.get("width", clearing)
        limits = within_ranges(limits, robot, width, drop)
        apart = self._with_widths(
            lambda width: LeastGreatest(
                max(width.least, limits.passing), width.greatest
            )
        )
        return replace(
            apart,
            stance=replace(self.stance, width=width),
            walk=replace(self.walk, limits=limits),
        )

    def with_behaviors(self, behaviors: Iterable[BehaviorEntry]) -> "ControllerConfig":
        """Returns this configuration with those of the behaviors as further fields."""
        values = self._values()
        for entry in behaviors:
            if entry.config is not None:
                values.setdefault(entry.configured_at, entry.config)
        return _made(values)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles and copies the values: the class is made at run time."""
        return _made, (self._values(),)

    def _values(self) -> dict[str, Any]:
        """Returns the value of each field."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    def scaled(self, size: Size) -> "ControllerConfig":
        """Returns the configuration, scaled to a robot of this size."""
        made = scaled(self, size)
        made = made._with_widths(lambda width: feet_fitting(width, size))
        return replace(made, stance=replace(made.stance, width=size.stance_width))

    def _with_widths(
        self, change: Callable[[LeastGreatest], LeastGreatest]
    ) -> "ControllerConfig":
        """Changes the width of each behavior's steps."""
        changed = {}
        for one in fields(self):
            part = getattr(self, one.name)
            limits = getattr(part, "limits", None)
            if isinstance(limits, StepLimits):
                width = change(limits.width)
                changed[one.name] = replace(part, limits=replace(limits, width=width))
        return replace(self, **changed)

    def with_values(
        self, values: Mapping[str, Any], ignore_unknown: bool = False
    ) -> "ControllerConfig":
        """Returns the configuration with some values changed.

        Args:
            values: Values by field, as in YAML.
            ignore_unknown: True leaves out mappings under other names, not checked:
                they may be for behaviors that are yet to come.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        given, known = dict(values), self._values()
        if ignore_unknown:
            given = {
                name: value
                for name, value in values.items()
                if name in known
                or not (isinstance(value, Mapping) or is_dataclass(value))
            }
        made: ControllerConfig = checked(type(self), given, "controller", base=known)
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


_SHARED = len(fields(ControllerConfig))
"""Number of fields that every configuration has, the first ones."""


def _made(values: dict[str, Any]) -> ControllerConfig:
    """Makes the configuration that has these fields."""
    kinds = [(name, type(value)) for name, value in values.items()]
    return _with_fields(tuple(kinds[_SHARED:]))(**values)


@functools.cache
def _with_fields(own: tuple[tuple[str, type], ...]) -> type[ControllerConfig]:
    """Returns the configuration's class, with a field for each of these behaviors."""
    if not own:
        return ControllerConfig
    return make_dataclass(
        "ControllerConfig",
        [(name, declared(kind), field(default_factory=kind)) for name, kind in own],
        bases=(ControllerConfig,),
        frozen=True,
        kw_only=True,
        namespace={"__doc__": ControllerConfig.__doc__},
    )
