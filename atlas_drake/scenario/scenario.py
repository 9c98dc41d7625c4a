"""Scenarios: robot, world and settings of a run, read from typed YAML.

One dataclass, one comment per field, all defaults here. ``simulation`` runs a scenario.
"""

import copy
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydrake.common.yaml import yaml_load
from pydrake.multibody.plant import MultibodyPlantConfig
from pydrake.systems.analysis import SimulatorConfig

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.bounds import NOT_NEGATIVE, Bounds
from atlas_drake.control.estimation.leg_odometry import OdometryTuning
from atlas_drake.errors import (
    InvalidMessageError,
    RobotDescriptionError,
    ScenarioError,
    shown,
)
from atlas_drake.kinds import as_plain, typed
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.robot import DEFAULT_ROBOT, find_robot, model_beside
from atlas_drake.scenario.drake_configs import (
    check_simulator_config,
    checked_plant_config,
    plant_config,
)
from atlas_drake.scenario.models import Model, models_beside
from atlas_drake.scenario.noise import NOISE_MODELS
from atlas_drake.scenario.paths import is_path, put
from atlas_drake.scenario.pushes import PlannedPush
from atlas_drake.scenario.terrain import START_REACH, Block, Place
from atlas_drake.scenario.time_grid import is_multiple, nominal_period
from atlas_drake.scenario.timed_message import TimedMessage
from atlas_drake.scenario.world_file import World, world_beside, world_from

PHYSICS_STEPS = Bounds(1e-5, 0.003)
"""Range of the physics step [s]. Below it a simulated second takes minutes; above it
a robot that stands under the tutorial's gains sways until it falls."""
LARGEST_SEED = 2**64 - 1
"""Largest seed of the random generator."""
LONGEST_PERIOD = 0.02
"""Longest control period on offer [s]."""
PROGRAMMES = ("none", "tutorial", "tutorial_literal")
STATES = ("true", "estimated")
IN_THE_AIR = (Behavior.USER, Behavior.FREEZE)
"""Behaviors in which a robot can start in the harness."""


@dataclass
class Jitter:
    """Random variations of the start and the physics, drawn from the scenario's seed.

    Every value is the half width of a uniform distribution; 0 is no variation.
    """

    position: Annotated[float, Bounds(0.0, START_REACH)] = 0.0
    """Position of the pelvis along x and y [m]."""
    orientation: float = 0.0
    """Roll, pitch and yaw of the pelvis [rad]."""
    joints: float = 0.0
    """Position of each joint [rad]."""
    mass: float = 0.0
    """Mass and inertia of each link, as a share of the controller's model; below 1."""


@dataclass
class Start:
    """Start of the robot, on its feet on the terrain."""

    position: list[Place] | None = None
    """Position of the pelvis along x and y in W [m]; null for the world's start."""
    yaw: float | None = None
    """Heading of the pelvis in W [rad]; null for the world's start."""
    harnessed: bool = False
    """True to start in a harness that holds the pelvis, with the feet in the air."""
    release_time: float | None = None
    """Time after the start, or the reset, at which the harness lowers and releases the
    robot [s]; null for no automatic release."""

    def validate(self, behavior: Behavior) -> None:
        """Checks every field against each other and the behavior to begin with.

        Args:
            behavior: The initial behavior.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        position = self.position
        if position is not None and len(position) != 2:
            raise ScenarioError(
                "start.position", position, f"is {shown(position)}; must be two numbers"
            )
        if self.yaw is not None and not np.isfinite(self.yaw):
            raise ScenarioError(
                "start.yaw", self.yaw, f"is {shown(self.yaw)}; must be a number"
            )
        release = self.release_time
        if release is not None:
            if not (np.isfinite(release) and release >= 0.0):
                raise ScenarioError(
                    "start.release_time",
                    release,
                    f"is {shown(release)}; must be a number not below 0",
                )
            if not self.harnessed:
                raise ScenarioError(
                    "start.release_time", release, "needs start.harnessed: true"
                )
        if self.harnessed and behavior not in IN_THE_AIR:
            raise ScenarioError(
                "initial_behavior",
                behavior.name,
                "must be USER or FREEZE in a harness: other behaviors need the ground",
            )


@dataclass(eq=False)
class Scenario:
    """All settings of a run."""

    name: str = "sandbox"
    """Text that is shown to the user."""
    model: str = DEFAULT_ROBOT
    """Robot: a name from ``models/``, or the path of a robot's YAML file, relative to
    the scenario's file, and in Python and on the command line to the working folder."""
    programme: str = "none"
    """Commands that are sent automatically: one of PROGRAMMES."""
    messages: list[TimedMessage] = field(default_factory=list)
    """Commands that are sent automatically beside the programme, each at its time."""
    duration: float = 10.0
    """Length of the run on the command line [s]."""
    initial_behavior: str = "STAND"
    """Behavior active at the start; USER gives all joints to the user."""
    physics_step: float = 0.0015
    """Step of plant and joint controllers [s], within PHYSICS_STEPS. The field is here
    rather than in ``plant`` because joint controllers and sensors share the step."""
    control_period: float = 0.0
    """Step of the behaviors [s], a multiple of physics_step; 0 for the multiple that is
    nearest to NOMINAL_PERIOD, 9 ms."""
    plant: MultibodyPlantConfig = field(default_factory=plant_config)
    """Contact model and solver: all fields of Drake's ``MultibodyPlantConfig`` but
    ``time_step``, which is physics_step, and ``use_sampled_output_ports``, which is
    false."""
    simulator: SimulatorConfig = field(default_factory=SimulatorConfig)
    """Drake's ``SimulatorConfig``: the integration of continuous systems that a user
    adds, and the real-time rate. ``start_time`` is 0."""
    controller: Annotated[ControllerConfig, NOT_NEGATIVE] = field(
        default_factory=ControllerConfig
    )
    """Gains, weights, limits and timings of the controller, such as
    ``gains: {dcm_gain: 2.5}``."""
    estimator: Annotated[OdometryTuning, NOT_NEGATIVE] = field(
        default_factory=OdometryTuning
    )
    """Noise parameters of the state estimator."""
    ground_friction: float = 0.9
    """Friction coefficient of the ground [-]."""
    friction_jitter: float = 0.0
    """Half width of a uniform random variation of ``ground_friction`` [-]."""
    world: World | str | Mapping[str, Any] = field(default_factory=World)
    """World around the robot, and start of the robot: a name from ``models/worlds``,
    the path of a world's YAML file, relative as ``model``, or fields of a world, such
    as ``{name: stairs, stairs: {rise: 0.06}}``."""
    terrain: list[Block] = field(default_factory=list)
    """Boxes on the level ground at z = 0, beside those of the world."""
    models: list[Model] = field(default_factory=list)
    """Models beside the robot, from files, beside those of the world."""
    start: Start = field(default_factory=Start)
    """Start of the robot."""
    pushes: list[PlannedPush] = field(default_factory=list)
    """Pushes on the robot, each at a time or at a phase of its gait."""
    noise: str = "none"
    """Sensor noise, a name from NOISE_MODELS."""
    state: str | bool = "true"
    """State that the behaviors read, one of STATES: the true state with the noise of
    the sensors, or the state estimated from IMU, joints and loads on the feet. A bare
    ``true``, which YAML reads as a truth value, means the word."""
    seed: int = 0
    """Seed of noise and jitter."""
    jitter: Jitter = field(default_factory=Jitter)
    """Random variations at the start."""

    def __eq__(self, other: object) -> bool:
        """Compares all fields; Drake's configurations have no comparison."""
        if not isinstance(other, Scenario):
            return NotImplemented
        return bool(as_plain(self) == as_plain(other))

    __hash__ = None  # type: ignore[assignment]  # A scenario is mutable.

    def resolved(self) -> "Scenario":
        """Return a valid copy in which every field is as a simulation uses it.

        The steps stay as they were given; a station rounds both to a common grid.

        Raises:
            ScenarioError: As ``validate`` does.
        """
        scenario = copy.deepcopy(self.validate())
        if scenario.control_period == 0.0:
            scenario.control_period = nominal_period(scenario.physics_step)
        scenario.plant = checked_plant_config(scenario.plant, scenario.physics_step)
        return scenario

    def validate(self) -> "Scenario":
        """Checks every field.

        Replaces a truth value for ``state`` by the word, and numbers by Python's own.

        Returns:
            The scenario itself.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        self.world = world_from(self.world)
        typed(self, Scenario)
        try:
            find_robot(self.model)
        except RobotDescriptionError as error:
            raise ScenarioError("model", self.model, error.problem) from None
        _one_of("programme", self.programme, PROGRAMMES)
        _one_of("noise", self.noise, tuple(NOISE_MODELS))
        if self.state is True:
            self.state = "true"
        _one_of("state", self.state, STATES)
        # A step on the common grid may be longer, by a relative error below 1e-9.
        if not PHYSICS_STEPS.allow(round(self.physics_step, 10)):
            raise ScenarioError(
                "physics_step",
                self.physics_step,
                f"is {shown(self.physics_step)}; must be {PHYSICS_STEPS} s",
            )
        check_simulator_config(self.simulator)
        self.behavior()
        _positive("duration", self.duration)
        _positive("ground_friction", self.ground_friction)
        if not 0.0 <= self.control_period < np.inf:
            raise ScenarioError(
                "control_period",
                self.control_period,
                f"is {shown(self.control_period)}; must be positive, or 0 for the "
                "default",
            )
        if not is_multiple(self.control_period, self.physics_step):
            raise ScenarioError(
                "control_period",
                self.control_period,
                f"is {shown(self.control_period)}; must be a whole multiple of "
                f"physics_step ({self.physics_step} s), or 0 for the default",
            )
        if round(self.control_period, 10) > LONGEST_PERIOD:
            raise ScenarioError(
                "control_period",
                self.control_period,
                f"is {shown(self.control_period)}; must be at most {LONGEST_PERIOD}: "
                "the robot cannot balance with longer ones",
            )
        checked_plant_config(self.plant, self.physics_step)
        check_seed(self.seed)
        for name, value in vars(self.jitter).items():
            most = 1.0 if name == "mass" else np.inf
            if not 0.0 <= value < most:
                wanted = "0 or more, and below 1" if name == "mass" else "0 or more"
                raise ScenarioError(
                    f"jitter.{name}", value, f"is {shown(value)}; must be {wanted}"
                )
        if not 0.0 <= self.friction_jitter < self.ground_friction:
            raise ScenarioError(
                "friction_jitter",
                self.friction_jitter,
                f"is {shown(self.friction_jitter)}; must be 0 or more, and below the "
                f"ground's friction ({self.ground_friction})",
            )
        self.surroundings().validate()
        for index, block in enumerate(self.terrain):
            block.validate(f"terrain[{index}]")
        for index, model in enumerate(self.models):
            model.validate(f"models[{index}]")
        for index, push in enumerate(self.pushes):
            push.validate(f"pushes[{index}]")
        for index, message in enumerate(self.messages):
            message.validate(f"messages[{index}]")
        self.start.validate(self.behavior())
        return self

    def surroundings(self) -> World:
        """Return the world that ``world`` stands for.

        Raises:
            ScenarioError: If there is no such world, or it has a value that cannot be
                used.
        """
        return world_from(self.world)

    def all_terrain(self) -> list[Block]:
        """Return the boxes of the world and those of the scenario, in this order."""
        return [*self.surroundings().terrain(), *self.terrain]

    def all_models(self) -> list[Model]:
        """Return the models of the world and those of the scenario, in this order."""
        return [*self.surroundings().models, *self.models]

    def start_pose(self, start: Start | None = None) -> tuple[list[float], float]:
        """Return where the robot begins: x and y of the pelvis [m], and yaw [rad].

        Args:
            start: What does not say it has it from the world; None is the scenario's.
        """
        start, world = start or self.start, self.surroundings().start
        return (
            world.position if start.position is None else start.position,
            world.yaw if start.yaw is None else start.yaw,
        )

    def behavior(self) -> Behavior:
        """The initial behavior.

        Raises:
            ScenarioError: If a run cannot start in it.
        """
        try:
            return starting_behavior(self.initial_behavior, "initial_behavior")
        except InvalidMessageError as error:
            raise ScenarioError(
                "initial_behavior", self.initial_behavior, error.problem
            ) from error


def check_seed(value: object) -> int:
    """Checks a seed of noise and jitter.

    Args:
        value: The given value.

    Returns:
        The seed as Python's own number.

    Raises:
        ScenarioError: If it cannot be used.
    """
    seed: int = typed(value, int, "seed")
    if not 0 <= seed <= LARGEST_SEED:
        raise ScenarioError(
            "seed", value, f"is {shown(value)}; must be from 0 to {LARGEST_SEED}"
        )
    return seed


def starting_behavior(
    value: object, name: str, catalog: BehaviorCatalog = SHIPPED
) -> Behavior:
    """Finds a behavior that a run can start in.

    Args:
        value: Its name in any case, its number, or the behavior itself.
        name: Name of the field, for the error.
        catalog: The registered behaviors.

    Raises:
        InvalidMessageError: If there is no such behavior, or a run cannot start in it.
    """
    behavior = catalog.find(value, name)
    allowed = (Behavior.STAND, Behavior.STAND_PREP, Behavior.USER, Behavior.FREEZE)
    if behavior not in allowed:
        names = ", ".join(b.name for b in allowed)
        raise InvalidMessageError(
            name, value, f"is {shown(value)}; must be one of {names}"
        )
    return behavior


def load_scenario(path: str | Path) -> Scenario:
    """Reads and validates one YAML file; fields left out have their defaults.

    Args:
        path: Path of the file.

    Raises:
        ScenarioError: If the file cannot be read, has unknown keys or bad values.
    """
    try:
        text = Path(path).read_text()
        raw = yaml_load(data=text) if text.strip() else None
    except Exception as error:
        # The parser raises many kinds of exception for a faulty file.
        problem = f"{path} cannot be read: {error}"
        raise ScenarioError("file", str(path), problem) from error
    try:
        if not isinstance(raw, Mapping):
            raise ScenarioError(
                "file", raw, "must have fields of a scenario, such as duration: 10"
            )
        return scenario_from(with_full_paths(raw, Path(path).parent))
    except ScenarioError as error:
        raise ScenarioError(
            error.field, error.value, f"{error.problem} (in {path})"
        ) from None


def with_full_paths(raw: Mapping[str, Any], folder: Path) -> Mapping[str, Any]:
    """Makes the files of robot, world and models relative to ``folder`` absolute."""
    seen = dict(raw)
    if isinstance(raw.get("model"), str):
        seen["model"] = model_beside(raw["model"], folder)
    if "world" in raw:
        seen["world"] = world_beside(raw["world"], folder)
    if "models" in raw:
        seen["models"] = models_beside(raw["models"], folder)
    return seen


def scenario_from(
    fields: Mapping[str, Any], default: Scenario | None = None
) -> Scenario:
    """Makes a scenario from the fields of a YAML file.

    Args:
        fields: Some or all fields, as YAML reads them.
        default: Scenario with the values of omitted fields; None for the defaults. It
            is not changed.

    Raises:
        ScenarioError: Naming the first field that cannot be used.
    """
    base = Scenario() if default is None else default
    if "world" in fields:
        world = world_from(fields["world"], base.surroundings())
        fields = {**fields, "world": world}
    scenario: Scenario = typed(fields, Scenario, default=base, from_text=True)
    return scenario.validate()


def with_settings(scenario: Scenario, settings: Iterable[str]) -> Scenario:
    """Returns a scenario with some fields set as on the command line.

    Args:
        scenario: Scenario with the values of all other fields.
        settings: Such as ``controller.gains.dcm_gain=2.5`` or
            ``pushes[0].impulse=30``: path and value as in YAML; of two for one field
            the later counts.

    Raises:
        ScenarioError: Naming the first field that cannot be set.
    """
    values: dict[str, Any] = {}
    for setting in settings:
        path, equals, text = setting.partition("=")
        if not (equals and is_path(path)):
            raise ScenarioError(
                "--set", setting, f"is {shown(setting)}; must be KEY.PATH=VALUE"
            )
        try:
            value = yaml_load(data=text)
        except Exception as error:  # The parser raises many kinds of exception.
            problem = f"is {shown(text)}; must be a value as in YAML: {error}"
            raise ScenarioError(path, text, problem) from error
        values.pop(path, None)
        values[path] = value
    return with_values(scenario, values)


def with_values(scenario: Scenario, values: Mapping[str, Any]) -> Scenario:
    """Returns a scenario with some fields set.

    Args:
        scenario: With all other fields.
        values: As YAML has them, by path, such as ``jitter.mass`` or
            ``terrain[1].friction``; set one after the other.

    Raises:
        ScenarioError: Naming the first field that cannot be set.
    """
    fields: dict[str, Any] = {}
    for path, value in values.items():
        put(fields, path, value, scenario)
    return scenario_from(fields, scenario)


def _one_of(name: str, value: object, allowed: Collection[object]) -> None:
    if value not in allowed:
        raise ScenarioError(
            name,
            value,
            f"is {shown(value)}; must be one of {', '.join(map(str, allowed))}",
        )


def _positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise ScenarioError(
            name, value, f"is {shown(value)}; must be a positive number"
        )
