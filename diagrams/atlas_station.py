"""AtlasStation: the robot with its joint controllers and behaviors.

Two command ports in, state ports out, as the simulator's plugin was to the original.
Wiring only.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlant
from pydrake.systems.framework import (
    Context,
    Diagram,
    DiagramBuilder,
    OutputPort,
    System,
)
from pydrake.systems.primitives import Multiplexer

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.diagrams.contact import (
    scene_graph_config,
    set_materials,
)
from atlas_drake.diagrams.controller_socket import (
    CONTROLLER,
    ControllerSource,
    add_controller,
    connect_controller,
)
from atlas_drake.diagrams.standing import stand_by_default
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.commands import COMMAND_PORTS
from atlas_drake.parts.estimation.estimation_error import EstimationError
from atlas_drake.parts.estimation.state_estimator import StateEstimator
from atlas_drake.parts.gantry.gantry import Gantry
from atlas_drake.robot import Robot, load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.shipped import BEHAVIORS, registered
from atlas_drake.systems.command_interface import CommandInterface
from atlas_drake.systems.contact_pairs import ContactPairs
from atlas_drake.systems.effort_selector import EffortSelector
from atlas_drake.systems.fall_monitor import FallMonitor
from atlas_drake.systems.imu import InertialSensor
from atlas_drake.systems.interface_reporter import InterfaceReporter
from atlas_drake.systems.joint_pid_bank import JointPidBank
from atlas_drake.systems.motors import Motors
from atlas_drake.systems.push_source import PushSource
from atlas_drake.systems.robot_sensors import RobotSensors
from atlas_drake.systems.run_statistics import RunStatistics
from atlas_drake.systems.sensor_noise import noise_model
from atlas_drake.systems.tick_recorder import TickRecorder
from atlas_drake.systems.whole_body_controller import WholeBodyController
from atlas_drake.worlds.models import world_of
from atlas_drake.worlds.scenery import add_scenery
from atlas_drake.worlds.world import (
    WorldError,
    WorldMaker,
    add_world,
    listed,
    world_instances,
)

CONTROLLER_INPUTS = (
    "state",
    "foot_loads",
    "foot_wrenches",
    "hand_wrenches",
    "user_forecast",
    "commands",
    "imu",
)
"""Signals that a controller may read, see ``controller_socket``."""
EXPORTED = (
    "record",
    "marks",
    "atlas_state",
    "imu",
    "foot_wrenches",
    "hand_wrenches",
    "contact_wrenches",
    "contact_pairs",
    "atlas_sim_interface_state",
    "commands",
    "user_effort",
    "effort",
    "peaks",
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
    "gantry",
    "estimated_state",
    "estimation_error",
    "largest_estimation_error",
)
"""Output ports of a station; some only with a gantry, a state estimator or contacts."""

_FORGET = (
    "joint_pid_bank",
    "motors",
    "robot_sensors",
    "contact_pairs",
    "inertial_sensor",
    "state_estimator",
    "push_source",
    "fall_monitor",
    "tick_recorder",
)
"""Systems that return to a state of rest; a station need not have every one."""
_BEGIN = ("command_interface", CONTROLLER)
"""Systems that restart with a behavior."""


def make_atlas_station(
    robot: Robot | None = None,
    scenario: Scenario | None = None,
    *,
    controller: ControllerSource | None = None,
    behaviors: Iterable[BehaviorEntry] = (),
    world: Iterable[WorldMaker] = (),
) -> Diagram:
    """Builds the station.

    In its default context the robot stands in the stand-prep pose over the origin of W,
    ready to simulate; ``place_robot`` puts it elsewhere. Start, jitter and commands of
    the scenario are for ``AtlasSimulation``.

    Args:
        robot: Robot of the station, in place of the scenario's; None loads that one.
        scenario: Steps, world, sensors, controller, initial behavior, pushes; None for
            the defaults.
        controller: Replaces ``WholeBodyController``; see
            ``atlas_drake.diagrams.controller_socket`` for the ports that it may have.
        behaviors: Added to the shipped behaviors of ``WholeBodyController``.
        world: Callables (plant) -> None that add models beside the robot and those of
            the scenario; see ``atlas_drake.worlds.world``.

    Input ports:
        atlas_command: ``AtlasCommand``; optional. See ``CommandInterface`` for when a
            message counts as a new one.
        atlas_sim_interface_command: ``AtlasSimInterfaceCommand``; optional.
        scheduled_atlas_command, scheduled_atlas_sim_interface_command: The same, of a
            scheduler; optional.
        applied_spatial_force: Further forces, as Drake's plant takes them; optional.

    Output ports:
        record: ``TickRecord`` of the latest control tick, see ``TickRecorder``.
        marks: Counts of events so far.
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
        contact_pairs: See ``ContactPairs``; only if the scenario names ``contacts``.
        peaks: Peaks of the run so far, see ``RunStatistics``.
        pushes: ``PushState``
        fall: ``Fall``; NOTHING until the robot falls.
        gantry: ``GantryState``; only with a gantry.
        state: Positions and velocities of the robot.
        plant_state: Positions and velocities of the whole plant.
        NAME.state: Positions and velocities of each other model that can move.
        body_poses, contact_results: Outputs of the plant.
        query_object: Output of the scene graph, for visualisers.
        estimated_state, estimation_error, largest_estimation_error: Outputs of the
            state estimator, if there is one; see ``EstimationError``.

    Raises:
        ScenarioError: If the scenario has a value that cannot be used, or the robot
            lacks a body that is to be pushed.
        RobotDescriptionError: If the robot's files cannot be used.
        ControllerError: If the controller does not fit the socket.
        BehaviorError: If a behavior cannot be registered.
        WorldError: If the world cannot be added.
    """
    own_behaviors = registered(behaviors)
    robot, scenario = ready(robot, scenario, own_behaviors)
    entries = (*BEHAVIORS, *own_behaviors)
    catalog = BehaviorCatalog(entries)
    terrain, noise = scenario.all_terrain(), noise_model(scenario.noise)
    world = (*world_of(scenario.all_models()), *listed(world))
    builder = DiagramBuilder()
    add = builder.AddNamedSystem
    step, period = scenario.physics_step, scenario.control_period
    plant, scene_graph = _add_plant(builder, robot, scenario, world)
    indices, own = robot.indices(plant), robot.instance(plant)

    commands = add(
        "command_interface",
        CommandInterface(robot, period, scenario.behavior(), catalog),
    )
    pid = add(
        "joint_pid_bank",
        JointPidBank(robot, plant, step, period),
    )
    ours = partial(make_whole_body_controller, entries=entries)
    source = ours if controller is None else controller
    of_controller = add_controller(builder, source, robot, scenario, catalog)
    reporter = add("interface_reporter", InterfaceReporter(robot))
    selector = add("effort_selector", EffortSelector(robot, plant))
    sensors = add(
        "robot_sensors",
        RobotSensors(robot, plant, noise, scenario.seed, step, period),
    )
    statistics = add(
        "run_statistics",
        RunStatistics(robot, indices, plant.num_multibody_states(own), period),
    )
    pushes = add("push_source", PushSource(robot, plant, scenario.pushes, period))
    tuning = scenario.controller_config()
    falls = add("fall_monitor", FallMonitor(robot, plant, tuning, period))

    # Ports are connected by name: every input reads the signal of its name.
    signals = {
        "state": plant.get_state_output_port(own),
        "plant_state": plant.get_state_output_port(),
        "acceleration": plant.get_generalized_acceleration_output_port(own),
        "net_actuation": plant.get_net_actuation_output_port(own),
        "body_poses": plant.GetOutputPort("body_poses"),
        "contact_results": plant.GetOutputPort("contact_results"),
        "query_object": scene_graph.get_query_output_port(),
        **of_controller,
    }
    systems = (commands, pid, selector, sensors, statistics, pushes, falls)
    for system in (*systems, reporter):
        signals |= _outputs(system)
    signals["received_effort"] = signals["behavior_effort"]
    if "speed_hold" in signals:
        signals["received_hold"] = signals["speed_hold"]
    if scenario.effort_delay or noise.effort:
        delay = scenario.effort_delay
        motors = add("motors", Motors(robot, noise, scenario.seed, delay, step, period))
        _connect(builder, motors, signals)
        signals |= _outputs(motors)
    state = "measured_state"
    if scenario.state == "estimated":
        state = "estimated_state"
        signals |= _add_estimator(builder, robot, scenario, plant, signals)
    signals["behavior_state"] = signals[state]
    if scenario.start.on_gantry:
        gantry = add("gantry", Gantry(robot, plant, scenario.gantry))
        pushed = signals["applied_spatial_force"]
        _connect(builder, gantry, {**signals, "other_spatial_force": pushed})
        signals |= _outputs(gantry)
    if scenario.contacts:
        pairs = ContactPairs(robot, plant, scenario.contacts, period)
        add("contact_pairs", pairs)
        _connect(builder, pairs, signals)
        signals |= _outputs(pairs)
    signals |= _add_recorder(builder, robot, plant, scenario, signals)
    for system in systems:
        _connect(builder, system, signals)
    behavior_signals = {**signals, "state": signals["behavior_state"]}
    _connect(builder, reporter, behavior_signals)
    connect_controller(
        builder, {name: behavior_signals[name] for name in CONTROLLER_INPUTS}
    )
    builder.Connect(signals["actuation"], plant.get_actuation_input_port(own))
    builder.Connect(signals["desired_state"], plant.get_desired_state_input_port(own))
    builder.Connect(
        signals["applied_spatial_force"], plant.get_applied_spatial_force_input_port()
    )

    for name in COMMAND_PORTS:
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
        stand_by_default(plant, robot, terrain, context)
    return station


def reset_station(station: Diagram, root: Context, behavior: Behavior) -> None:
    """Resets joint controllers, sensors, commands and behaviors."""
    for names, arguments in ((_FORGET, ()), (_BEGIN, (behavior,))):
        for name in names:
            if station.HasSubsystemNamed(name):
                system: Any = station.GetSubsystemByName(name)
                context = system.GetMyMutableContextFromRoot(root)
                if hasattr(system, "reset"):
                    system.reset(context, *arguments)
                else:  # A controller without a reset method.
                    system.SetDefaultContext(context)


def ready(
    robot: Robot | None, scenario: Scenario | None, behaviors: Iterable[BehaviorEntry]
) -> tuple[Robot, Scenario]:
    """Returns robot and scenario as a station uses them.

    The scenario is resolved, its steps are on the common grid, and it names the robot.
    """
    scenario = scenario or Scenario()
    robot = robot or load_robot(scenario.model)
    if robot.model != scenario.model:
        scenario = replace(scenario, model=robot.model)
    return robot, scenario.resolved(behaviors).on_time_grid()


def make_whole_body_controller(
    robot: Robot,
    scenario: Scenario,
    entries: Iterable[BehaviorEntry] = BEHAVIORS,
) -> WholeBodyController:
    """Makes the default controller of a station.

    Args:
        robot: Robot to control.
        scenario: Scenario of the station, as a controller's callable gets it.
        entries: Entries of the behaviors.
    """
    entries = tuple(entries)
    tuning, period = scenario.controller_config(entries), scenario.control_period
    return WholeBodyController(robot, tuning, period, scenario.behavior(), entries)


def _add_plant(
    builder: DiagramBuilder,
    robot: Robot,
    scenario: Scenario,
    world: Sequence[WorldMaker],
) -> tuple[MultibodyPlant, SceneGraph]:
    """Adds the plant with robot, level ground at z = 0, terrain and world."""
    plant, scene_graph = AddMultibodyPlant(
        scenario.plant, scene_graph_config(), builder
    )
    robot.add_to(plant)
    terrain = scenario.all_terrain()
    add_scenery(plant, terrain, scenario.ground_friction)
    add_world(plant, world)
    set_materials(plant, scene_graph, robot)
    plant.Finalize()
    own = plant.num_multibody_states(robot.instance(plant))
    if world and own != robot.plant.num_multibody_states():
        raise WorldError(
            f"world must not add bodies that move to the model of {robot.name}; a "
            "model instance of their own can be welded to it, or hang on its joints"
        )
    stand_by_default(plant, robot, terrain)
    return plant, scene_graph


def _add_recorder(
    builder: DiagramBuilder,
    robot: Robot,
    plant: MultibodyPlant,
    scenario: Scenario,
    signals: Mapping[str, OutputPort],
) -> dict[str, OutputPort]:
    """Adds what makes the records; returns its signals by name."""
    recorder = builder.AddNamedSystem(
        "tick_recorder",
        TickRecorder(
            robot,
            plant,
            scenario.control_period,
            scenario.state == "estimated",
            scenario.contacts,
        ),
    )
    # Drake joins them in a fraction of the time that reading each of them would take.
    joined = builder.AddNamedSystem(
        "record_numbers", Multiplexer([*recorder.sizes.values()])
    )
    for index, name in enumerate(recorder.sizes):
        builder.Connect(signals[name], joined.get_input_port(index))
    _connect(builder, recorder, {**signals, "numbers": joined.get_output_port()})
    return _outputs(recorder)


def _add_estimator(
    builder: DiagramBuilder,
    robot: Robot,
    scenario: Scenario,
    plant: MultibodyPlant,
    signals: Mapping[str, OutputPort],
) -> dict[str, OutputPort]:
    """Adds the state estimator, its IMU, and the measure of its error."""
    step, period = scenario.physics_step, scenario.control_period
    noise = noise_model(scenario.noise)
    imu = builder.AddNamedSystem(
        "inertial_sensor",
        InertialSensor(robot, plant, noise, scenario.seed, step, period),
    )
    estimator = builder.AddNamedSystem(
        "state_estimator", StateEstimator(robot, period, scenario.estimator)
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
