"""Plays a log in Meshcat: the same view as of the run, fed from the log.

A diagram without physics: the robot is put where the log says it was.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import (
    BasicVector,
    Context,
    Diagram,
    DiagramBuilder,
    LeafSystem,
)
from pydrake.systems.rendering import MultibodyPositionToGeometryPose

from atlas_drake.behaviors.base import Event
from atlas_drake.behaviors.supervisor import KEPT_EVENTS, SupervisorState
from atlas_drake.commands import BehaviorRequest, CommandsInForce, commands_at_start
from atlas_drake.diagrams.atlas_station import add_scenery
from atlas_drake.frozen import replace
from atlas_drake.logs.layout import STEP_FIELDS
from atlas_drake.logs.log import Log
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
    behavior_from,
)
from atlas_drake.systems.behavior_controller import ControllerState


class LogPlayer(LeafSystem):
    """The log's row at the Context's time, as the ports that the view reads.

    Output ports:
        positions: Of the plant, the true ones.
        commands: ``CommandsInForce``, as far as the view needs it: the request.
        controller_state: ``ControllerState``, likewise: the events so far.
        atlas_sim_interface_state: ``AtlasSimInterfaceState``, likewise: behaviours,
            flags, steps, and who has which joint.
    """

    def __init__(self, log: Log):
        """Plays ``log``; beyond its ends the first or the last row stands."""
        super().__init__()
        self._log = log
        self._requests = _requests(log)
        start = commands_at_start(log.robot, Behavior.STAND)
        nothing = np.zeros(log.robot.num_joints)
        idle = ControllerState(SupervisorState(Behavior.STAND, Behavior.STAND), nothing)
        self._start, self._idle = start, idle
        now = {self.time_ticket()}
        self.DeclareVectorOutputPort(
            "positions", log["state.q"].shape[1], self._calc_positions, now
        )
        for name, blank, calc in (
            ("commands", start, self._commands),
            ("controller_state", idle, self._controller_state),
            ("atlas_sim_interface_state", AtlasSimInterfaceState(), self._report),
        ):
            self.DeclareAbstractOutputPort(
                name,
                lambda blank=blank: AbstractValue.Make(blank),
                lambda context, out, calc=calc: out.set_value(calc(context)),
                now,
            )

    def row(self, context: Context) -> int:
        """Number of the row that is shown: the latest that is not in the future."""
        time = self._log.time
        # A hair of slack: times are sums of rounded periods.
        after = np.searchsorted(time, context.get_time() + 1e-9, side="right")
        return max(int(after) - 1, 0)

    def _calc_positions(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._log["state.q"][self.row(context)])

    def _commands(self, context: Context) -> CommandsInForce:
        number = int(self._log["behavior.request_number"][self.row(context)])
        request = self._requests.get(number, self._start.request)
        return replace(self._start, request=request)

    def _controller_state(self, context: Context) -> ControllerState:
        # The latest events, as in the controller.
        now = context.get_time() + 1e-9
        past: list[Event] = [e for e in self._log.events if e.time <= now]
        supervisor = replace(
            self._idle.supervisor,
            events=tuple(past[-KEPT_EVENTS:]),
            event_count=len(past),
        )
        return replace(self._idle, supervisor=supervisor)

    def _report(self, context: Context) -> AtlasSimInterfaceState:
        log, row = self._log, self.row(context)
        message = AtlasSimInterfaceState()
        message.header.stamp = float(log.time[row])
        message.current_behavior = int(log["behavior.current"][row])
        message.desired_behavior = int(log["behavior.desired"][row])
        message.behavior_feedback.status_flags = int(log["behavior.status_flags"][row])
        message.k_effort = log["joints.k_effort"][row].tolist()
        walk = message.walk_feedback
        walk.status_flags = int(log["walk.status_flags"][row])
        walk.current_step_index = int(log["walk.current_step_index"][row])
        steps = log["walk.steps"][row].reshape(-1, len(STEP_FIELDS))
        walk.step_queue_saturated = [_step_data(step.tolist()) for step in steps]
        step = message.step_feedback
        step.status_flags = int(log["step.status_flags"][row])
        step.t_step_rem = float(log["step.t_step_rem"][row])
        step.current_step_index = int(log["step.current_step_index"][row])
        step.desired_step_saturated = _step_data(log["step.step"][row].tolist())
        return message


def make_replay(log: Log, meshcat: Meshcat, *, recorded: bool = False) -> Diagram:
    """Builds a diagram that shows a log as the run was shown.

    Args:
        log: What to play.
        meshcat: Where to.
        recorded: Whether Meshcat records, see ``add_meshcat_view``.

    Raises:
        LogError: If the log's scenario is unknown to this program.
    """
    # Loads only where there is something to see.
    from atlas_drake.visualization.meshcat_view import add_meshcat_view

    builder = DiagramBuilder()
    builder.AddNamedSystem("station", _make_station(log))
    station: Any = builder.GetSubsystemByName("station")
    add_meshcat_view(builder, station, log.robot, meshcat, recorded=recorded)
    diagram = builder.Build()
    diagram.set_name("replay")
    return diagram


def _make_station(log: Log) -> Diagram:
    """What looks like a station from outside, with a log in place of physics."""
    builder = DiagramBuilder()
    player = builder.AddNamedSystem("log_player", LogPlayer(log))
    scene_graph = builder.AddNamedSystem("scene_graph", SceneGraph())
    plant = MultibodyPlant(time_step=0.0)
    source = plant.RegisterAsSourceForSceneGraph(scene_graph)
    log.robot.add_to(plant)
    scenario = log.scenario
    add_scenery(plant, scenario.terrain, scenario.ground_friction)
    plant.Finalize()
    poses = builder.AddNamedSystem("poses", MultibodyPositionToGeometryPose(plant))
    builder.Connect(player.GetOutputPort("positions"), poses.get_input_port())
    builder.Connect(poses.get_output_port(), scene_graph.get_source_pose_port(source))
    for name in ("commands", "controller_state", "atlas_sim_interface_state"):
        builder.ExportOutput(player.GetOutputPort(name), name)
    builder.ExportOutput(player.GetOutputPort("positions"), "positions")
    builder.ExportOutput(scene_graph.get_query_output_port(), "query_object")
    station = builder.Build()
    station.set_name("ReplayStation")
    return station


def _requests(log: Log) -> dict[int, BehaviorRequest]:
    """The behaviour commands that were accepted, by their number."""
    requests = {}
    numbers, times = log["behavior.request_number"], log.time
    for command in log.commands:
        message = command.message
        row = int(np.searchsorted(times, command.time - 1e-9))
        if not isinstance(message, AtlasSimInterfaceCommand) or row >= len(times):
            continue
        number = int(numbers[row])
        # A refused command leaves the number as it was.
        if number > (int(numbers[row - 1]) if row else 0):
            behavior = behavior_from(message.behavior)
            requests[number] = BehaviorRequest(behavior, message.snapshot(), number)
    return requests


def _step_data(step: list[float]) -> AtlasBehaviorStepData:
    index, foot, x, y, z, yaw = step
    data = AtlasBehaviorStepData()
    data.step_index, data.foot_index = int(index), int(foot)
    if data.step_index != NO_STEP:
        position, orientation = data.pose.position, data.pose.orientation
        position.x, position.y, position.z = x, y, z
        orientation.z, orientation.w = float(np.sin(yaw / 2)), float(np.cos(yaw / 2))
    return data
