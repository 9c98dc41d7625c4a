"""Scenarios: robot, world and settings of a run, read from typed YAML.

One dataclass, one comment per field, all defaults here. ``simulation`` runs a scenario.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from annotated_types import Interval, Len
from pydantic import BeforeValidator, Strict
from pydrake.multibody.plant import MultibodyPlantConfig
from pydrake.systems.analysis import SimulatorConfig

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.config import (
    CheckedOnce,
    Configuration,
    NotNegative,
    OfDrake,
    Positive,
    as_plain,
    checked,
    read_as,
)
from atlas_drake.errors import (
    InvalidMessageError,
    RobotDescriptionError,
    ScenarioError,
    shown,
)
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.parts.estimation.leg_odometry import OdometryTuning
from atlas_drake.parts.gantry.gantry import GantryGains
from atlas_drake.robot import (
    DEFAULT_ROBOT,
    find_robot,
    model_beside,
    read_robot_file,
    robot_to_scale_by,
)
from atlas_drake.scenario.physics import (
    check_plant_config,
    check_simulator_config,
    is_multiple,
    nominal_period,
    on_common_grid,
    plant_config,
    stations_plant_config,
)
from atlas_drake.scenario.policy_use import PolicyUse
from atlas_drake.scenario.timed_message import TimedMessage
from atlas_drake.shipped import BEHAVIORS, CATALOG
from atlas_drake.systems.pushes import PlannedPush
from atlas_drake.systems.sensor_noise import NoiseModel, NoiseName, noise_model
from atlas_drake.units import (
    Meters,
    Radians,
    Ratio,
    Seconds,
)
from atlas_drake.worlds.models import Model
from atlas_drake.worlds.terrain import START_REACH, Block, Place
from atlas_drake.worlds.world_file import World, world_fields

SHORTEST_STEP, LONGEST_STEP = 1e-5, 0.01
"""Range of the physics step [s]. Below it a simulated second takes minutes. At its end
stiff gains of a user already throw the robot over, see docs/benchmarks.md."""
LARGEST_SEED = 2**64 - 1
"""Largest seed of the random generator."""
Seed = Annotated[int, Strict(), Interval(ge=0, le=LARGEST_SEED)]
LONGEST_PERIOD = 0.02
"""Longest control period on offer [s]."""
IN_THE_AIR = (Behavior.USER, Behavior.FREEZE)
"""Behaviors in which a robot can start on the gantry."""


@dataclass(frozen=True)
class Jitter(Configuration):
    """Random variations of the start and the physics, drawn from the scenario's seed.

    Every value is the half width of a uniform distribution; 0 is no variation.
    """

    position: Annotated[Meters, Interval(ge=0.0, le=START_REACH)] = 0.0
    """Position of the pelvis along x and y."""
    orientation: NotNegative[Radians] = 0.0
    """Roll, pitch and yaw of the pelvis."""
    joints: NotNegative[Radians] = 0.0
    """Position of each joint."""
    mass: Annotated[Ratio, Interval(ge=0.0, lt=1.0)] = 0.0
    """Mass and inertia of each link, as a share of the controller's model; below 1."""


@dataclass(frozen=True)
class Start(Configuration):
    """Start of the robot, on its feet on the terrain."""

    position: Place | None = None
    """Position of the pelvis along x and y in W; null for the world's start."""
    yaw: Radians | None = None
    """Heading of the pelvis in W; null for the world's start."""
    on_gantry: bool = False
    """True to start on a gantry that holds the pelvis, with the feet in the air."""
    release_time: NotNegative[Seconds] | None = None
    """Time after the start, or the reset, at which the gantry lowers and releases the
    robot; null for no automatic release."""

    def check(self) -> None:
        """Checks that there is a gantry to be released from."""
        if self.release_time is not None and not self.on_gantry:
            raise ScenarioError(
                "release_time", self.release_time, "needs start.on_gantry: true"
            )

    def check_behavior(self, behavior: Behavior) -> None:
        """Checks that the robot can begin so.

        Args:
            behavior: The behavior that is active at the start.
        """
        if self.on_gantry and behavior not in IN_THE_AIR:
            raise ScenarioError(
                "initial_behavior",
                behavior.name,
                "must be USER or FREEZE on a gantry: other behaviors need the ground",
            )


@dataclass(frozen=True)
class LogContent(Configuration):
    """What a log holds beside the numbers of every control tick."""

    paths: bool = True
    """Planned paths, for the overlays ``plan`` and ``swing`` of a replay."""
    contacts: bool = False
    """Forces of single contacts, for the overlay ``forces`` of a replay."""


@dataclass(frozen=True, eq=False)
class Scenario(CheckedOnce):
    """All settings of a run."""

    name: str = "sandbox"
    """Text that is shown to the user."""
    model: str = DEFAULT_ROBOT
    """Robot: a name from ``models/``, or the path of a robot's YAML file, relative to
    the scenario's file, and in Python and on the command line to the working folder."""
    schedule: Literal["none", "tutorial", "tutorial_literal"] = "none"
    """Commands that are sent automatically."""
    messages: list[TimedMessage] = field(default_factory=list)
    """Commands that are sent automatically beside the schedule, each at its time."""
    policy: PolicyUse | None = None
    """A learned policy that commands joints beside them; null for none. It is joined by
    ``atlas_drake.AtlasSimulation`` and the commands, see ``clients.policies``."""
    duration: Positive[Seconds] = 10.0
    """Length of the run on the command line."""
    initial_behavior: str = "STAND"
    """Behavior active at the start; USER gives all joints to the user."""
    physics_step: Positive[Seconds] = 0.003
    """Step of the plant and its motors, from 1e-5 to 0.01. The field is here rather
    than in ``plant`` because joint controllers and sensors share the step."""
    control_period: NotNegative[Seconds] = 0.0
    """Step of the behaviors, a multiple of physics_step; 0 for the multiple that is
    nearest to NOMINAL_PERIOD, 9 ms."""
    plant: Annotated[MultibodyPlantConfig, OfDrake()] = field(
        default_factory=plant_config
    )
    """Contact model and solver: all fields of Drake's ``MultibodyPlantConfig`` but
    ``time_step``, which is physics_step, and ``use_sampled_output_ports``, which is
    false."""
    simulator: Annotated[SimulatorConfig, OfDrake()] = field(
        default_factory=SimulatorConfig
    )
    """Drake's ``SimulatorConfig``: the integration of continuous systems that a user
    adds, and the real-time rate. ``start_time`` is 0."""
    controller: Annotated[
        ControllerConfig | Mapping[str, Any], read_as(dict[str, Any])
    ] = field(default_factory=dict)
    """Gains, weights, limits and timings of the controller, such as
    ``gains: {dcm_gain: 2.5}``, those of behaviors of your own included. What is left
    out has the value of the robot's file, or else the default; a ``ControllerConfig``
    has every value."""
    estimator: OdometryTuning = field(default_factory=OdometryTuning)
    """Noise parameters of the state estimator."""
    ground_friction: Positive[Ratio] = 0.9
    """Friction coefficient of the ground."""
    friction_jitter: NotNegative[Ratio] = 0.0
    """Half width of a uniform random variation of ``ground_friction``."""
    world: Annotated[World | str | Mapping[str, Any], read_as(World)] = field(
        default_factory=World
    )
    """World around the robot, and start of the robot: a name from ``models/worlds``,
    the path of a world's YAML file, relative as ``model``, or fields of a world, such
    as ``{name: stairs, stairs: {rise: 0.06}}``."""
    terrain: list[Block] = field(default_factory=list)
    """Boxes on the level ground at z = 0, beside those of the world."""
    models: list[Model] = field(default_factory=list)
    """Models beside the robot, from files, beside those of the world."""
    start: Start = field(default_factory=Start)
    """Start of the robot."""
    gantry: GantryGains = field(default_factory=GantryGains)
    """Gains of the gantry, for a robot that starts on it."""
    pushes: list[PlannedPush] = field(default_factory=list)
    """Pushes on the robot, each at a time or at a phase of its gait."""
    noise: Annotated[
        NoiseModel | NoiseName,
        read_as(NoiseModel),
        BeforeValidator(noise_model, json_schema_input_type=NoiseModel | NoiseName),
    ] = field(default_factory=NoiseModel)
    """Noise of the sensors: ``none``, ``reference`` (the IMU of DRCSim's simulator),
    ``rough`` (that, and noisy joint encoders), or fields, with noise of the motors."""
    effort_delay: NotNegative[Seconds] = 0.0
    """Time that efforts of the behaviors take to the motors, a multiple of
    physics_step."""
    state: Annotated[
        Literal["true", "estimated"],
        BeforeValidator(
            lambda value: "true" if value is True else value,
            json_schema_input_type=Literal["true", "estimated", True],
        ),
    ] = "true"
    """State that the behaviors read: the true state with the noise of
    the sensors, or the state estimated from IMU, joints and loads on the feet. A bare
    ``true``, which YAML reads as a truth value, means the word."""
    seed: Seed = 0
    """Seed of noise and jitter."""
    jitter: Jitter = field(default_factory=Jitter)
    """Random variations at the start."""
    contacts: list[Annotated[list[str], Len(1, 2)]] = field(default_factory=list)
    """Bodies whose contact is measured, such as ``[[l_hand, crate], [r_hand]]``: the
    wrench of the second on the first, or of all others on it. A name is that of a body
    of the robot or else of another model, ``MODEL::BODY`` where several have it;
    ``world`` is the ground and all that is fixed."""
    log: LogContent = field(default_factory=LogContent)
    """What a log holds beside the numbers of every control tick."""

    def __eq__(self, other: object) -> bool:
        """Compares all fields; Drake's configurations have no comparison."""
        if not isinstance(other, Scenario):
            return NotImplemented
        return bool(as_plain(self) == as_plain(other))

    __hash__ = None  # type: ignore[assignment]  # It holds lists.

    def resolved(self, behaviors: Iterable[BehaviorEntry] = ()) -> "Scenario":
        """Returns a valid copy in which every field is as a simulation uses it.

        Args:
            behaviors: Entries of the user's own behaviors.
        """
        valid = self.validate()
        policy = valid.policy
        period = valid.control_period or nominal_period(valid.physics_step)
        return replace(
            valid,
            model=model_beside(valid.model, Path.cwd()),
            policy=policy and replace(policy, file=str(Path(policy.file).absolute())),
            control_period=period,
            plant=stations_plant_config(valid.plant, valid.physics_step),
            controller=valid.controller_config(behaviors),
        ).mark_checked()

    def on_time_grid(self) -> "Scenario":
        """Returns a resolved scenario with steps whose multiples meet exactly."""
        step, period = on_common_grid(self.physics_step, self.control_period)
        plant = stations_plant_config(self.plant, step)
        return replace(
            self, physics_step=step, control_period=period, plant=plant
        ).mark_checked()

    def validate(self) -> "Scenario":
        """Returns the scenario with every field checked and of its declared type."""
        if self.is_checked:
            return self
        given = replace(self, world=world_fields(self.world))
        valid: Scenario = checked(Scenario, given, base=Scenario())
        return valid

    def check(self) -> None:
        """Checks what files and other fields decide."""

        def refuse(name: str, wanted: str) -> None:
            value = getattr(self, name)
            raise ScenarioError.about(name, value, f"must be {wanted}")

        self.controller_config()
        # A step on the common grid may be longer, by a relative error below 1e-9.
        if not SHORTEST_STEP <= round(self.physics_step, 10) <= LONGEST_STEP:
            refuse("physics_step", f"from {SHORTEST_STEP:g} to {LONGEST_STEP:g} s")
        check_simulator_config(self.simulator)
        self.start.check_behavior(self.behavior())
        if round(self.control_period, 10) > LONGEST_PERIOD:
            refuse("control_period", f"at most {LONGEST_PERIOD} s, to keep balance")
        for name in ("control_period", "effort_delay"):
            if not is_multiple(getattr(self, name), self.physics_step):
                step = f"physics_step ({self.physics_step} s)"
                refuse(name, f"a whole multiple of {step}, or 0")
        check_plant_config(self.plant, self.physics_step)
        if not self.friction_jitter < self.ground_friction:
            refuse("friction_jitter", f"below ground_friction ({self.ground_friction})")
        self.mark_checked()

    def controller_config(
        self, behaviors: Iterable[BehaviorEntry] | None = None
    ) -> ControllerConfig:
        """Returns the parameters of the controller for the scenario's robot.

        Args:
            behaviors: Entries of the user's own behaviors, whose configurations are
                fields, too; None leaves these out, not checked.

        Raises:
            ScenarioError: If there is no such robot, or a value cannot be used.
        """
        if isinstance(self.controller, ControllerConfig):
            return self.controller
        try:
            file = read_robot_file(self.model)
            robot = robot_to_scale_by(self.model)
        except RobotDescriptionError as error:
            at_file = error.field == "model"
            problem = error.problem if at_file else str(error)
            raise ScenarioError("model", self.model, problem) from None
        try:
            robots = ControllerConfig.of(file, robot, BEHAVIORS, behaviors)
        except ScenarioError as error:
            # Without values in the file, a default of a user's behavior is at fault.
            named = error.within(find_robot(self.model)) if file.controller else error
            raise named from None
        if not self.controller:
            return robots
        return robots.with_values(self.controller, ignore_unknown=behaviors is None)

    def surroundings(self) -> World:
        """Returns the world that ``world`` stands for."""
        if isinstance(self.world, World):
            return self.world
        world: World = checked(World, world_fields(self.world), "world")
        return world

    def all_terrain(self) -> list[Block]:
        """Returns the boxes of the world, then those of the scenario."""
        return [*self.surroundings().terrain(), *self.terrain]

    def all_models(self) -> list[Model]:
        """Returns the models of the world, then those of the scenario."""
        return [*self.surroundings().models, *self.models]

    def start_pose(self, start: Start | None = None) -> tuple[list[float], float]:
        """Returns x and y of the pelvis [m], and yaw [rad], where the robot begins.

        Args:
            start: A start, which the world's completes; None is the scenario's.
        """
        start, world = start or self.start, self.surroundings().start
        return (
            world.position if start.position is None else start.position,
            world.yaw if start.yaw is None else start.yaw,
        )

    def behavior(self) -> Behavior:
        """Returns the initial behavior."""
        try:
            return starting_behavior(self.initial_behavior, "initial_behavior")
        except InvalidMessageError as error:
            raise ScenarioError(
                "initial_behavior", self.initial_behavior, error.problem
            ) from error


def starting_behavior(
    value: object, name: str, catalog: BehaviorCatalog = CATALOG
) -> Behavior:
    """Finds a behavior that a run can start in; ``name`` names its field in errors."""
    behavior = catalog.find(value, name)
    allowed = (Behavior.STAND, Behavior.STAND_PREP, Behavior.USER, Behavior.FREEZE)
    if behavior not in allowed:
        names = ", ".join(b.name for b in allowed)
        raise InvalidMessageError(
            name, value, f"is {shown(value)}; must be one of {names}"
        )
    return behavior
