"""What a view shows: read from a station's ports, once for Meshcat and for videos.

``meshcat_view`` and ``video_display`` draw it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import QueryObject, SceneGraphInspector
from pydrake.multibody.plant import ContactResults
from pydrake.systems.framework import Context, DiagramBuilder, LeafSystem, System

from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.frozen import NOTHING
from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import (
    ControllerStatus,
    Plan,
    PlannedPaths,
)
from atlas_drake.palette import Color
from atlas_drake.robot import Robot
from atlas_drake.visualization.caption import caption_of, feedback_words
from atlas_drake.visualization.control_colors import joint_colors
from atlas_drake.visualization.footsteps import FootstepMark, footstep_marks
from atlas_drake.visualization.overlay_shapes import (
    DRAWN,
    ContactForce,
    Shape,
    contact_forces_of,
    overlay_shapes,
)
from atlas_drake.visualization.overlays import Overlays

PATHS = frozenset({"plan", "swing"})
"""The overlays that show planned paths."""


class Seen(NamedTuple):
    """What a view shows at an instant.

    Attributes:
        state: State of the robot.
        report: Report of the robot.
        title: Title of the caption.
        notes: Lines below the title.
        footsteps: Marks of footsteps.
        shapes: Shapes of the overlays, the lowest first.
        joint_colors: Colors of the joints' links; None leaves the links their own.
        inspector: Inspector of the scene graph.
    """

    state: np.ndarray
    report: AtlasSimInterfaceState
    title: str
    notes: list[str]
    footsteps: list[FootstepMark]
    shapes: list[Shape]
    joint_colors: list[Color] | None
    inspector: SceneGraphInspector


class ViewPorts:
    """The input ports of a view.

    Input ports:
        state: State of the robot, the pelvis' orientation and position first.
        foot_wrenches: Contact wrenches on both soles, see ``RobotSensors``.
        effort: Efforts of the motors [N·m], shape (n,).
        commands: ``ActiveCommand``
        controller_status: ``ControllerStatus``
        planned_paths: ``PlannedPaths``
        atlas_sim_interface_state: ``AtlasSimInterfaceState``
        query_object: Of the scene graph.
        contact_results: Contact results of the plant; left out in a replay.
    """

    def __init__(
        self, view: LeafSystem, robot: Robot, overlays: Overlays, paths_every: int = 1
    ) -> None:
        """Declares the ports.

        Args:
            view: The system that draws.
            robot: Robot in its pictures.
            overlays: Switches of the overlays.
            paths_every: Pictures between updates of the paths, which are slow to
                compute and change slowly.
        """
        self._overlays = overlays
        self._limit = robot.effort_limit
        self._model = WholeBodyModel(robot)
        self._scratch = self._model.create_context()
        for name, size in (
            ("state", self._model.num_states),
            ("foot_wrenches", 12),
            ("effort", robot.num_joints),
        ):
            view.DeclareVectorInputPort(name, size)
        for name, blank in (
            ("commands", NOTHING),
            ("controller_status", NOTHING),
            ("planned_paths", NOTHING),
            ("atlas_sim_interface_state", NOTHING),
            ("query_object", QueryObject()),
            ("contact_results", ContactResults()),
        ):
            view.DeclareAbstractInputPort(name, AbstractValue.Make(blank))
        self._view = view
        self._paths_every = paths_every
        self._pictures = 0
        self._latest_paths = PlannedPaths()

    def see(self, context: Context) -> Seen:
        """Reads the ports."""
        state = self._read("state", context)
        commands: ActiveCommand = self._read("commands", context)
        report: AtlasSimInterfaceState = self._read(
            "atlas_sim_interface_state", context
        )
        status: ControllerStatus = self._read("controller_status", context)
        inspector = self._read("query_object", context).inspector()
        title, note = caption_of(report, commands.catalog)
        flags = [feedback_words(report)] if self._overlays.is_on("flags") else []
        effort = self._read("effort", context)
        return Seen(
            state,
            report,
            title,
            [note, *flags],
            footstep_marks(commands.request, report, status.events, status.plan),
            self._shapes(context, state, status.plan, inspector),
            joint_colors(self._overlays, commands.k_effort, effort, self._limit),
            inspector,
        )

    def _read(self, name: str, context: Context) -> Any:
        return self._view.GetInputPort(name).Eval(context)

    def _shapes(
        self,
        context: Context,
        state: np.ndarray,
        plan: Plan,
        inspector: SceneGraphInspector,
    ) -> list[Shape]:
        """Computes the shapes of the overlays that are switched on."""
        on = {name for name in DRAWN if self._overlays.is_on(name)}
        if not on & PATHS:
            self._pictures = 0
        else:
            if self._pictures % self._paths_every == 0:
                self._latest_paths = self._read("planned_paths", context)
            self._pictures += 1
        if not on:
            return []
        forces: list[ContactForce] = []
        # A replay has no contact results.
        contacts = self._view.GetInputPort("contact_results")
        if "forces" in on and contacts.HasValue(context):
            forces = contact_forces_of(contacts.Eval(context), inspector)
        return overlay_shapes(
            on,
            self._model.evaluate(self._scratch, state),
            plan,
            self._latest_paths,
            self._read("foot_wrenches", context),
            forces,
        )


def add_view(
    builder: DiagramBuilder, station: System, name: str, view: LeafSystem
) -> None:
    """Adds a view to a diagram, and connects it to the ports that the station has."""
    builder.AddNamedSystem(name, view)
    for index in range(view.num_input_ports()):
        port = view.get_input_port(index)
        if station.HasOutputPort(port.get_name()):
            builder.Connect(station.GetOutputPort(port.get_name()), port)
