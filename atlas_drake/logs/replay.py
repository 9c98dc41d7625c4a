"""Plays a log: the same 3D view and video as of the run, fed from the log.

A diagram without physics: the robot is put where the log says it was.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import (
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
from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.log import Log
from atlas_drake.logs.notes import LogError
from atlas_drake.logs.report_channels import REPORT_CHANNELS, report_from
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
    behavior_from,
)
from atlas_drake.systems.behavior_controller import ControllerState
from atlas_drake.visualization.overlays import Overlays

if TYPE_CHECKING:
    from atlas_drake.visualization.video_display import Video

VECTORS = {
    "state": ("state.q", "state.v"),
    "effort": ("joints.effort",),
    "foot_wrenches": tuple(
        f"feet.{side}_{part}" for side in SIDES for part in ("torque", "force")
    ),
}
"""Channels of which the ports that carry plain vectors are made."""


class LogPlayer(LeafSystem):
    """The log's row at the Context's time, as the ports that displays read.

    Output ports:
        state: Of the plant, the true one.
        effort: Of the motors [N·m], shape (n,).
        foot_wrenches: See ``RobotSensors``, shape (12,).
        commands: ``CommandsInForce``, as far as displays need it: the request, and
            who has which joint.
        controller_state: ``ControllerState``, likewise: the events so far.
        atlas_sim_interface_state: ``AtlasSimInterfaceState``, all of it.
    """

    def __init__(self, log: Log):
        """Plays ``log``; beyond its ends the first or the last row stands.

        Raises:
            LogError: If the log lacks what is to be shown.
        """
        super().__init__()
        _check_complete(log)
        self._log = log
        self._requests = _requests(log)
        start = commands_at_start(log.robot, Behavior.STAND)
        nothing = np.zeros(log.robot.num_joints)
        idle = ControllerState(SupervisorState(Behavior.STAND, Behavior.STAND), nothing)
        self._start, self._idle = start, idle
        now = {self.time_ticket()}
        for name, channels in VECTORS.items():
            tables = [log[channel] for channel in channels]
            self.DeclareVectorOutputPort(
                name,
                sum(table.shape[1] for table in tables),
                lambda context, out, tables=tables: out.SetFromVector(
                    np.concatenate([table[self.row(context)] for table in tables])
                ),
                now,
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

    def _commands(self, context: Context) -> CommandsInForce:
        log, row = self._log, self.row(context)
        number = int(log["behavior.request_number"][row])
        request = self._requests.get(number, self._start.request)
        k_effort = log["joints.k_effort"][row].astype(float)
        joints = replace(self._start.joints, k_effort=k_effort)
        return replace(self._start, request=request, joints=joints)

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
        names = (entry.channel.name for entry in REPORT_CHANNELS)
        report = report_from({name: log[name][row] for name in names})
        report.header.stamp = float(log.time[row])
        report.f_out = log["joints.behavior_effort"][row].tolist()
        report.k_effort = log["joints.k_effort"][row].tolist()
        return report


def make_replay(
    log: Log,
    meshcat: Meshcat | None = None,
    overlays: Overlays | None = None,
    video: Video | None = None,
) -> Diagram:
    """Builds a diagram that shows a log as the run was shown.

    Args:
        log: Of the run.
        meshcat: Where to show it; None shows nothing.
        overlays: What is shown besides, of ``LOGGED``.
        video: What to film it into; None films nothing.

    Raises:
        LogError: If the log lacks what is to be shown, or has a scenario that is
            unknown to this program.
        VideoError: If the video cannot be made.
    """
    builder = DiagramBuilder()
    builder.AddNamedSystem("station", _make_station(log))
    station: Any = builder.GetSubsystemByName("station")
    # What displays need loads only where there is one.
    if meshcat is not None:
        from atlas_drake.visualization.meshcat_view import add_meshcat_view

        add_meshcat_view(builder, station, log.robot, meshcat, overlays)
    if video is not None:
        from atlas_drake.visualization.video_display import add_video

        add_video(builder, station, log.robot, log.scenario.terrain, video)
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
    poses = builder.AddNamedSystem(
        "poses", MultibodyPositionToGeometryPose(plant, input_multibody_state=True)
    )
    builder.Connect(player.GetOutputPort("state"), poses.get_input_port())
    builder.Connect(poses.get_output_port(), scene_graph.get_source_pose_port(source))
    for index in range(player.num_output_ports()):
        port = player.get_output_port(index)
        builder.ExportOutput(port, port.get_name())
    builder.ExportOutput(scene_graph.get_query_output_port(), "query_object")
    station = builder.Build()
    station.set_name("ReplayStation")
    return station


def _check_complete(log: Log) -> None:
    """Refuses the log of a program that kept less."""
    needed = [
        *(channel for channels in VECTORS.values() for channel in channels),
        *(entry.channel.name for entry in REPORT_CHANNELS),
    ]
    missing = [name for name in needed if name not in log.arrays]
    if missing:
        raise LogError(
            f"{log.path}: it was recorded without {', '.join(missing)}, so that it "
            "cannot be replayed; record it anew"
        )


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
