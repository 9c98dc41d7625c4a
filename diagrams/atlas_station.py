"""AtlasStation: the robot with its joint controllers and behaviors.

Two command ports in, state ports out, as the simulator's plugin was to the original.
Wiring only.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.systems.framework import Diagram, DiagramBuilder, OutputPort, System

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.registration import registered
from atlas_drake.behaviors.shipped import SHIPPED_ENTRIES
from atlas_drake.control.estimation.leg_odometry import OdometryTuning
from atlas_drake.diagrams.contact import (
    add_scenery,
    scene_graph_config,
    set_robot_dissipation,
)
from atlas_drake.diagrams.controller_socket import (
    ControllerSource,
    add_controller,
)
from atlas_drake.diagrams.standing import stand_by_default
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario.drake_configs import checked_plant_config, plant_config
from atlas_drake.scenario.noise import NoiseModel
from atlas_drake.scenario.pushes import PlannedPush
from atlas_drake.scenario.scenario import HarnessGains
from atlas_drake.scenario.terrain import Block
from atlas_drake.scenario.time_grid import on_common_grid
from atlas_drake.scenario.world import (
    WorldError,
    WorldMaker,
    add_world,
    world_instances,
)
from atlas_drake.systems.command_interface import CommandInterface
from atlas_drake.systems.effort_selector import EffortSelector
from atlas_drake.systems.estimation_error import EstimationError
from atlas_drake.systems.fall_monitor import FallMonitor
from atlas_drake.systems.harness import Harness
from atlas_drake.systems.inertial_sensor import InertialSensor
from atlas_drake.systems.interface_reporter import InterfaceReporter
from atlas_drake.systems.joint_pid_bank import JointPidBank
from atlas_drake.systems.push_source import PushSource
from atlas_drake.systems.robot_sensors import RobotSensors
from atlas_drake.systems.run_statistics import RunStatistics
from atlas_drake.systems.state_estimator import StateEstimator
from atlas_drake.systems.whole_body_controller import WholeBodyController


@dataclass(frozen=True)
class StationConfig:
    """Settings of a station.

    Attributes:
        physics_step: Step of the plant and of the joint controllers [s].
        control_period: Step of the behaviors [s], a multiple of ``physics_step``; 0 for
            the multiple that is nearest to 9 ms.
        ground_friction: Coefficient of the ground.
        terrain: Boxes on the ground.
        noise: Noise of the sensors.
        seed: Seed of that noise.
        initial_behavior: The behavior active at the start.
        harnessed: True to add a harness that can hold the pelvis.
        harness: Gains of the harness.
        estimated: True if the behaviors read an estimate in place of the true state.
        controller: Parameters of the controller; None for the robot's.
        estimator: Parameters of the state estimator.
        plant: Contact model and solver; see ``Scenario.plant``.
        pushes: Pushes on the robot, see ``PlannedPush``.
    """

    physics_step: float = 0.0015
    control_period: float = 0.0
    ground_friction: float = 0.9
    terrain: tuple[Block, ...] = ()
    noise: NoiseModel = field(default_factory=NoiseModel)
    seed: int = 0
    initial_behavior: Behavior = Behavior.STAND
    harnessed: bool = False
    harness: HarnessGains = field(default_factory=HarnessGains)
    estimated: bool = False
    controller: ControllerConfig | None = None
    estimator: OdometryTuning = field(default_factory=OdometryTuning)
    plant: MultibodyPlantConfig = field(default_factory=plant_config)
    pushes: tuple[PlannedPush, ...] = ()

    def __post_init__(self) -> None:
        """Adjusts both steps so that their multiples coincide exactly."""
        steps = on_common_grid(self.physics_step, self.control_period)
        object.__setattr__(self, "physics_step", steps[0])
        object.__setattr__(self, "control_period", steps[1])


CONTROLLER_INPUTS = ("state", "foot_loads", "user_forecast", "commands", "imu")
"""Signals that a controller may read, see ``controller_socket``."""
EXPORTED = (
    "atlas_state",
    "imu",
    "foot_wrenches",
    "hand_wrenches",
    "contact_wrenches",
    "atlas_sim_interface_state",
    "commands",
    "user_effort",
    "effort",
    "extremes",
    "pushes",
    "fall",
    "body_poses",
    "contact_results",
    "state",
    "plant_state",
    "behavior_state",
    "behavior_effort",
    "controller_status",
    "planned_paths",
    "query_object",
    "harness",
    "estimated_state",
    "estimation_error",
    "largest_estimation_error",
)
"""Output ports of a station; the last four only with harness or state estimator."""


def make_atlas_station(
    robot: Robot | None = None,
    config: StationConfig | None = None,
    *,
    controller: ControllerSource | None = None,
    behaviors: Iterable[BehaviorEntry] = (),
    world: Sequence[WorldMaker] = (),
) -> Diagram:
    """Builds the station.

    In its default context the robot stands in the stand-prep pose over the origin of W,
    ready to simulate; ``place_robot`` puts it elsewhere.

    Args:
        robot: Robot of the station; None is ``atlas``.
        config: Periods, sensors, ground; None for the defaults.
        controller: Replaces ``WholeBodyController``; see
            ``atlas_drake.diagrams.controller_socket`` for the ports that it may have.
        behaviors: Added to the shipped behaviors of ``WholeBodyController``.
        world: Callables (plant) -> None that add models beside the robot; see
            ``atlas_drake.scenario.world``.

    Input ports:
        atlas_command: ``AtlasCommand``; optional. See ``CommandInterface`` for when a
            message counts as a new one.
        atlas_sim_interface_command: ``AtlasSimInterfaceCommand``; optional.
        applied_spatial_force: Further forces, as Drake's plant takes them; optional.

    Output ports:
        atlas_state: ``AtlasState``
        imu: ``Imu``
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
        commands: ``ActiveCommand``
        controller_status: ``ControllerStatus``
        planned_paths: ``PlannedPaths``, computed when they are read.
        behavior_effort: Efforts of the controller [N·m], shape (n,), message order.
        effort: Efforts of the motors [N·m], shape (n,), message order.
        user_effort: Efforts of the joint controllers [N·m], shape (n,), message order.
        behavior_state: State that the behaviors read.
        foot_wrenches, hand_wrenches, contact_wrenches: See ``RobotSensors``.
        extremes: Extremes of the run so far, see ``RunStatistics``.
        pushes: ``PushState``
        fall: ``Fall``; NOTHING until the robot falls.
        harness: ``HarnessState``; only with a harness.
        state: Positions and velocities of the robot.
        plant_state: Positions and velocities of the whole plant.
        NAME.state: Positions and velocities of each other model that can move.
        body_poses, contact_results: Outputs of the plant.
        query_object: Output of the scene graph, for visualisers.
        estimated_state, estimation_error, largest_estimation_error: Outputs of the
            state estimator, if there is one; see ``EstimationError``.

    Raises:
        ControllerError: If the controller does not fit the socket.
        BehaviorError: If a behavior cannot be registered.
        ScenarioError: If the robot lacks a body that is to be pushed.
        WorldError: If the world cannot be added.
    """
    robot = robot or load_robot()
    config = config or StationConfig()
    entries = (*SHIPPED_ENTRIES, *registered(behaviors))
    catalog = BehaviorCatalog(entries)
    tuning = config.controller or ControllerConfig.of(robot.file, entries)
    builder = DiagramBuilder()
    add = builder.AddNamedSystem
    step, period = config.physics_step, config.control_period
    plant, scene_graph = _add_plant(builder, robot, config, world)
    indices, own = robot.indices(plant), robot.instance(plant)

    commands = add(
        "command_interface",
        CommandInterface(robot, period, config.initial_behavior, catalog),
    )
    pid = add(
        "joint_pid_bank",
        JointPidBank(robot, indices, plant.num_positions(own), step, period),
    )
    ours = partial(make_whole_body_controller, entries=entries)
    source = ours if controller is None else controller
    socket = add_controller(builder, source, robot, config, catalog)
    reporter = add("interface_reporter", InterfaceReporter(robot))
    selector = add("effort_selector", EffortSelector(robot, indices))
    sensors = add(
        "robot_sensors",
        RobotSensors(robot, plant, config.noise, config.seed, step, period),
    )
    statistics = add(
        "run_statistics",
        RunStatistics(robot, indices, plant.num_multibody_states(own), period),
    )
    pushes = add("push_source", PushSource(robot, plant, config.pushes, period))
    falls = add("fall_monitor", FallMonitor(robot, plant, tuning, period))

    # Ports are connected by name: every input reads the signal of its name.
    signals = {
        "state": plant.get_state_output_port(own),
        "plant_state": plant.get_state_output_port(),
        "acceleration": plant.get_generalized_acceleration_output_port(own),
        "body_poses": plant.GetOutputPort("body_poses"),
        "contact_results": plant.GetOutputPort("contact_results"),
        "query_object": scene_graph.get_query_output_port(),
        "behavior_effort": socket.effort,
        "controller_status": socket.status,
        "planned_paths": socket.paths,
    }
    systems = (commands, pid, selector, sensors, statistics, pushes, falls)
    for system in (*systems, reporter):
        signals |= _outputs(system)
    if config.estimated:
        signals |= _add_estimator(builder, robot, config, plant, signals)
    signals["behavior_state"] = signals[
        "estimated_state" if config.estimated else "measured_state"
    ]
    if config.harnessed:
        harness = add("harness", Harness(robot, plant, config.harness))
        pushed = signals["applied_spatial_force"]
        _connect(builder, harness, {**signals, "other_spatial_force": pushed})
        signals |= _outputs(harness)
    for system in systems:
        _connect(builder, system, signals)
    behavior_signals = {**signals, "state": signals["behavior_state"]}
    _connect(builder, reporter, behavior_signals)
    socket.connect_inputs(
        builder, **{name: behavior_signals[name] for name in CONTROLLER_INPUTS}
    )
    builder.Connect(signals["actuation"], plant.get_actuation_input_port(own))
    builder.Connect(
        signals["applied_spatial_force"], plant.get_applied_spatial_force_input_port()
    )

    for name in ("atlas_command", "atlas_sim_interface_command"):
        builder.ExportInput(commands.GetInputPort(name), name)
    builder.ExportInput(
        pushes.GetInputPort("other_spatial_force"), "applied_spatial_force"
    )
    for name in EXPORTED:
        if name in signals:
            builder.ExportOutput(signals[name], name)
    for instance, name in world_instances(plant, robot).items():
        builder.ExportOutput(plant.get_state_output_port(instance), f"{name}.state")
    station = builder.Build()
    station.set_name("AtlasStation")
    if world:
        # Only the whole diagram knows where the geometry of all models is.
        root = station.CreateDefaultContext()
        context = plant.GetMyMutableContextFromRoot(root)
        stand_by_default(plant, robot, config.terrain, context)
    return station


def make_whole_body_controller(
    robot: Robot,
    config: StationConfig,
    entries: Iterable[BehaviorEntry] = SHIPPED_ENTRIES,
) -> WholeBodyController:
    """Makes the default controller of a station.

    Args:
        robot: Robot to control.
        config: Settings of the station.
        entries: Entries of the behaviors.
    """
    entries = tuple(entries)
    tuning = config.controller or ControllerConfig.of(robot.file, entries)
    return WholeBodyController(
        robot, tuning, config.control_period, config.initial_behavior, entries
    )


def _add_plant(
    builder: DiagramBuilder,
    robot: Robot,
    config: StationConfig,
    world: Sequence[WorldMaker],
) -> tuple[MultibodyPlant, SceneGraph]:
    """Adds the plant with robot, level ground at z = 0, terrain and world."""
    plant, scene_graph = AddMultibodyPlant(
        checked_plant_config(config.plant, config.physics_step),
        scene_graph_config(),
        builder,
    )
    robot.add_to(plant)
    set_robot_dissipation(plant, scene_graph, robot)
    add_scenery(plant, config.terrain, config.ground_friction)
    add_world(plant, world)
    plant.Finalize()
    own = plant.num_multibody_states(robot.instance(plant))
    if world and own != robot.make_plant().num_multibody_states():
        raise WorldError(
            f"world must not add bodies that move to the model of {robot.name}; a "
            "model instance of their own can be welded to it, or hang on its joints"
        )
    stand_by_default(plant, robot, config.terrain)
    return plant, scene_graph


def _add_estimator(
    builder: DiagramBuilder,
    robot: Robot,
    config: StationConfig,
    plant: MultibodyPlant,
    signals: Mapping[str, OutputPort],
) -> dict[str, OutputPort]:
    """Adds the state estimator, its IMU, and the measure of its error.

    Returns:
        Their signals by name.
    """
    step, period = config.physics_step, config.control_period
    imu = builder.AddNamedSystem(
        "inertial_sensor",
        InertialSensor(robot, plant, config.noise, config.seed, step, period),
    )
    estimator = builder.AddNamedSystem(
        "state_estimator", StateEstimator(robot, period, config.estimator)
    )
    error = builder.AddNamedSystem(
        "estimation_error", EstimationError(robot, plant, period)
    )
    parts = (imu, estimator, error)
    own = {name: port for part in parts for name, port in _outputs(part).items()}
    for part in parts:
        _connect(builder, part, {**signals, **own, "start_state": signals["state"]})
    return own


def _outputs(system: System) -> dict[str, OutputPort]:
    """Returns the output ports of a system by name."""
    ports = map(system.get_output_port, range(system.num_output_ports()))
    return {port.get_name(): port for port in ports}


def _connect(
    builder: DiagramBuilder, system: System, signals: Mapping[str, OutputPort]
) -> None:
    """Connects every input port of a system for which there is a signal of its name."""
    for port in map(system.get_input_port, range(system.num_input_ports())):
        if port.get_name() in signals:
            builder.Connect(signals[port.get_name()], port)
