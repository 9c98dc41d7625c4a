"""AtlasStation: the robot with its joint controllers and behaviors.

Two command ports in, state ports out, as the simulator's plugin was to the original.
Wiring only.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    ProximityProperties,
    SceneGraph,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.systems.framework import Diagram, DiagramBuilder, System

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.registration import registered
from atlas_drake.behaviors.shipped import SHIPPED_ENTRIES
from atlas_drake.control.estimation.leg_odometry import OdometryTuning
from atlas_drake.diagrams.controller_socket import (
    ControllerSource,
    add_controller,
    make_controller,
)
from atlas_drake.diagrams.dissipation import (
    scene_graph_config,
    set_robot_dissipation,
)
from atlas_drake.diagrams.ground_friction import GROUND, block_name
from atlas_drake.diagrams.standing import stand_by_default
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario.drake_configs import checked_plant_config, plant_config
from atlas_drake.scenario.harness import HarnessGains
from atlas_drake.scenario.noise import NoiseModel
from atlas_drake.scenario.pushes import PlannedPush
from atlas_drake.scenario.terrain import GROUND_SIZE, GROUND_THICKNESS, Block
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
        commands: ``CommandsInForce``
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
    tuning = config.controller or ControllerConfig.of(robot.file, entries)
    builder = DiagramBuilder()
    plant, scene_graph = _add_plant(builder, robot, config, world)
    indices, own = robot.indices(plant), robot.instance(plant)
    own_state = plant.get_state_output_port(own)

    catalog = BehaviorCatalog(entries)
    commands = builder.AddNamedSystem(
        "command_interface",
        CommandInterface(
            robot, config.control_period, config.initial_behavior, catalog
        ),
    )
    pid = builder.AddNamedSystem(
        "joint_pid_bank",
        JointPidBank(
            robot,
            indices,
            plant.num_positions(own),
            config.physics_step,
            config.control_period,
        ),
    )
    ours = partial(make_whole_body_controller, entries=entries)
    chosen = make_controller(ours if controller is None else controller, robot, config)
    socket = add_controller(builder, chosen, robot, catalog)
    reporter = builder.AddNamedSystem("interface_reporter", InterfaceReporter(robot))
    selector = builder.AddNamedSystem("effort_selector", EffortSelector(robot, indices))
    sensors = builder.AddNamedSystem(
        "robot_sensors",
        RobotSensors(
            robot,
            plant,
            config.noise,
            config.seed,
            config.physics_step,
            config.control_period,
        ),
    )
    statistics = builder.AddNamedSystem(
        "run_statistics",
        RunStatistics(
            robot, indices, plant.num_multibody_states(own), config.control_period
        ),
    )

    pushes = builder.AddNamedSystem(
        "push_source", PushSource(robot, plant, config.pushes, config.control_period)
    )
    falls = builder.AddNamedSystem(
        "fall_monitor",
        FallMonitor(robot, plant, tuning, config.control_period),
    )

    def connect(source: System, output: str, target: System, *inputs: str) -> None:
        for name in inputs or (output,):
            builder.Connect(source.GetOutputPort(output), target.GetInputPort(name))

    connect(commands, "joint_command", pid)
    connect(commands, "k_effort", selector)
    connect(commands, "commands", sensors)
    connect(commands, "commands", reporter)
    connect(pid, "user_effort", selector)
    for reader in (selector, pid, reporter):
        builder.Connect(socket.effort, reader.GetInputPort("behavior_effort"))
    for reader in (reporter, pushes):
        builder.Connect(socket.status, reader.GetInputPort("controller_status"))
    builder.Connect(
        selector.GetOutputPort("actuation"), plant.get_actuation_input_port(own)
    )
    connect(selector, "effort", sensors)
    connect(selector, "actuation", statistics)
    if config.estimated:
        estimator = _add_estimator(builder, robot, config, plant, sensors)
        behavior_state = estimator.GetOutputPort("estimated_state")
    else:
        behavior_state = sensors.GetOutputPort("measured_state")
    builder.Connect(behavior_state, reporter.GetInputPort("state"))
    socket.connect_inputs(
        builder,
        state=behavior_state,
        foot_loads=sensors.GetOutputPort("foot_loads"),
        user_forecast=pid.GetOutputPort("user_forecast"),
        commands=commands.GetOutputPort("commands"),
        imu=sensors.GetOutputPort("imu"),
    )
    connect(plant, "contact_results", sensors)
    builder.Connect(
        plant.get_generalized_acceleration_output_port(robot.instance(plant)),
        sensors.GetInputPort("acceleration"),
    )
    for reader in (sensors, pid, statistics, pushes, falls):
        builder.Connect(own_state, reader.GetInputPort("state"))

    for name in ("atlas_command", "atlas_sim_interface_command"):
        builder.ExportInput(commands.GetInputPort(name), name)
    connect(sensors, "foot_wrenches", pushes)
    builder.ExportInput(
        pushes.GetInputPort("other_spatial_force"), "applied_spatial_force"
    )
    forces = pushes.GetOutputPort("applied_spatial_force")
    if config.harnessed:
        harness = builder.AddNamedSystem(
            "harness", Harness(robot, plant, config.harness)
        )
        builder.Connect(own_state, harness.GetInputPort("state"))
        connect(selector, "actuation", harness)
        connect(sensors, "foot_wrenches", harness)
        builder.Connect(forces, harness.GetInputPort("other_spatial_force"))
        forces = harness.GetOutputPort("applied_spatial_force")
        builder.ExportOutput(harness.GetOutputPort("harness"), "harness")
    builder.Connect(forces, plant.get_applied_spatial_force_input_port())
    for system, names in (
        (sensors, ("atlas_state", "imu")),
        (sensors, ("foot_wrenches", "hand_wrenches", "contact_wrenches")),
        (reporter, ("atlas_sim_interface_state",)),
        (commands, ("commands",)),
        (pid, ("user_effort",)),
        (selector, ("effort",)),
        (statistics, ("extremes",)),
        (pushes, ("pushes",)),
        (falls, ("fall",)),
        (plant, ("body_poses", "contact_results")),
    ):
        for name in names:
            builder.ExportOutput(system.GetOutputPort(name), name)
    builder.ExportOutput(own_state, "state")
    builder.ExportOutput(plant.get_state_output_port(), "plant_state")
    for instance, name in world_instances(plant, robot).items():
        builder.ExportOutput(plant.get_state_output_port(instance), f"{name}.state")
    builder.ExportOutput(behavior_state, "behavior_state")
    builder.ExportOutput(socket.effort, "behavior_effort")
    builder.ExportOutput(socket.status, "controller_status")
    builder.ExportOutput(socket.paths, "planned_paths")
    builder.ExportOutput(scene_graph.get_query_output_port(), "query_object")
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


def add_scenery(
    plant: MultibodyPlant, terrain: Iterable[Block], ground_friction: float
) -> None:
    """Adds the level ground and the terrain's boxes to a plant (before Finalize).

    Args:
        plant: Plant to add to.
        terrain: The boxes.
        ground_friction: Coefficient of friction of ground and boxes.
    """
    # A half-space would end the process: FCL's tree of fixed shapes, which has no limit
    # to their number otherwise, cannot balance itself with a shape of infinite size.
    ground = Box(GROUND_SIZE, GROUND_SIZE, GROUND_THICKNESS)
    X_WG = RigidTransform(np.array([0.0, 0.0, -0.5 * GROUND_THICKNESS]))
    plant.RegisterCollisionGeometry(
        plant.world_body(), X_WG, ground, GROUND, _material(ground_friction)
    )
    for number, block in enumerate(terrain):
        _add_block(plant, block, block_name(number), ground_friction)


def _material(friction: float) -> ProximityProperties:
    """Returns a rigid material; its surface counts where contact is hydroelastic."""
    properties = ProximityProperties()
    AddContactMaterial(
        friction=CoulombFriction(friction, friction), properties=properties
    )
    AddRigidHydroelasticProperties(properties)
    return properties


def _add_estimator(
    builder: DiagramBuilder,
    robot: Robot,
    config: StationConfig,
    plant: MultibodyPlant,
    sensors: RobotSensors,
) -> StateEstimator:
    """Adds the state estimator, its IMU, and the measure of its error."""
    imu = builder.AddNamedSystem(
        "inertial_sensor",
        InertialSensor(
            robot,
            plant,
            config.noise,
            config.seed,
            config.physics_step,
            config.control_period,
        ),
    )
    estimator = builder.AddNamedSystem(
        "state_estimator",
        StateEstimator(robot, config.control_period, config.estimator),
    )
    error = builder.AddNamedSystem(
        "estimation_error", EstimationError(robot, plant, config.control_period)
    )
    for name in ("measured_state", "foot_loads"):
        builder.Connect(sensors.GetOutputPort(name), estimator.GetInputPort(name))
    builder.Connect(imu.GetOutputPort("inertial"), estimator.GetInputPort("inertial"))
    true = plant.get_state_output_port(robot.instance(plant))
    builder.Connect(true, imu.GetInputPort("state"))
    builder.Connect(true, estimator.GetInputPort("start_state"))
    builder.Connect(true, error.GetInputPort("state"))
    estimate = estimator.GetOutputPort("estimated_state")
    builder.Connect(estimate, error.GetInputPort("estimated_state"))
    builder.ExportOutput(estimate, "estimated_state")
    for name in ("estimation_error", "largest_estimation_error"):
        builder.ExportOutput(error.GetOutputPort(name), name)
    return estimator


def _add_block(
    plant: MultibodyPlant, block: Block, name: str, ground_friction: float
) -> None:
    """Adds one box for contact and for display."""
    shape = Box(np.array(block.size))
    coefficient = ground_friction if block.friction is None else block.friction
    world = plant.world_body()
    plant.RegisterCollisionGeometry(
        world, block.X_WC, shape, name, _material(coefficient)
    )
    plant.RegisterVisualGeometry(world, block.X_WC, shape, name, block.rgba)
