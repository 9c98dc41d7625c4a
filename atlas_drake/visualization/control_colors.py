"""Links colored by the user's share, or by the effort, of the joint that moves them.

The pelvis, which no joint moves, keeps its own colors.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import (
    FrameId,
    Mesh,
    Meshcat,
    QueryObject,
    Role,
    SceneGraphInspector,
)
from pydrake.systems.framework import Context

from atlas_drake.messages.joint_command import share_of
from atlas_drake.palette import BEHAVIOR, BUSY, IDLE, SHARED, SPENT, USER, Color
from atlas_drake.robot import Robot
from atlas_drake.visualization.display import Display
from atlas_drake.visualization.gltf_triangles import gltf_triangles
from atlas_drake.visualization.marks import Timeline
from atlas_drake.visualization.overlays import Overlays

SHADES = 20
"""Steps of a color scale: equal colors are not sent again."""
GAMMA = 2.2
"""Exponent of the conversion to light intensities, in which Meshcat takes colors."""
COVER = "_colored"
"""Suffix of the path of a link's copy."""


def owner_colors(k_effort: np.ndarray) -> list[Color]:
    """Colors joints by the user's share, 0 to 255, shape (n,)."""
    colors = (BEHAVIOR, SHARED, USER)
    return [_between(colors, share) for share in share_of(k_effort)]


def effort_colors(effort: np.ndarray, limit: np.ndarray) -> list[Color]:
    """Colors joints on a scale of three by effort over limit [N·m], shapes (n,)."""
    shares = np.minimum(np.abs(effort) / limit, 1.0)
    return [_between((IDLE, BUSY, SPENT), share) for share in shares]


def _between(colors: Sequence[Color], share: float) -> Color:
    """Returns the color at a point of a scale, in discrete shades."""
    shade = round(SHADES * float(share)) / SHADES
    places = np.linspace(0.0, 1.0, len(colors))
    r, g, b = (
        round(float(np.interp(shade, places, part)), 3)
        for part in zip(*colors, strict=True)
    )
    return r, g, b


class ControlColors(Display):
    """Colors the links while one of the two colorings is switched on.

    A colored link is hidden behind a copy with one material. Browsers load the link
    itself too late for a recording to reach its materials; without the copy the link
    shows its own colors again.

    Input ports:
        query_object: Query object of the scene graph.
        commands: ``CommandsInForce``
        effort: Efforts of the motors [N·m], shape (n,).
    """

    __slots__ = ()

    def __init__(
        self,
        meshcat: Meshcat,
        prefix: str,
        robot: Robot,
        overlays: Overlays,
        period: float,
    ) -> None:
        """Updates the colors every ``period`` [s].

        Drake's visualiser draws the links under ``prefix``.
        """
        super().__init__(period)
        self._meshcat = meshcat
        self._prefix = prefix
        self._limit = robot.effort_limit
        self._frame_names = [
            [f"{robot.name}::{link}" for link in links] for links in robot.moved_links
        ]
        self._overlays = overlays
        self._query = self.DeclareAbstractInputPort(
            "query_object", AbstractValue.Make(QueryObject())
        )
        (self._commands,) = self.declare_values("commands")
        self._effort = self.DeclareVectorInputPort("effort", robot.num_joints)
        self._begin()
        # Drake's visualiser then draws everything anew, which also deletes the copies.
        self.DeclareInitializationPublishEvent(lambda _context: self._begin())

    def _begin(self) -> None:
        self._timeline = Timeline(self._meshcat)
        self._links: list[list[str]] = []

    def _publish(self, context: Context) -> None:
        time = context.get_time()
        if self._overlays.is_on("owner"):
            commands: Any = self._commands.Eval(context)
            colors = owner_colors(commands.k_effort)
        elif self._overlays.is_on("effort"):
            colors = effort_colors(self._effort.Eval(context), self._limit)
        else:
            self._cover(False, time)
            return
        if not self._links:
            query: Any = self._query.Eval(context)
            inspector = query.inspector()
            frames = {inspector.GetName(f): f for f in inspector.GetAllFrameIds()}
            self._links = [
                [path for name in names for path in self._draw(inspector, frames[name])]
                for names in self._frame_names
            ]
        for paths, color in zip(self._links, colors, strict=True):
            for path in paths:
                for part, value in zip("rgb", color, strict=True):
                    name = f"material.color[{part}]"
                    target = f"{path}{COVER}/<object>"
                    self._timeline.jump(target, name, value**GAMMA, time)
        self._cover(True, time)

    def _cover(self, covered: bool, time: float) -> None:
        for path in chain.from_iterable(self._links):
            self._timeline.show(f"{path}{COVER}", covered, time)
            self._timeline.show(path, not covered, time)

    def _draw(self, inspector: SceneGraphInspector, frame: FrameId) -> list[str]:
        """Makes copies of a link's meshes and returns their paths."""
        paths = []
        for geometry in inspector.GetGeometries(frame, Role.kIllustration):
            shape = inspector.GetShape(geometry)
            if not isinstance(shape, Mesh) or shape.extension() != ".gltf":
                continue
            names = inspector.GetName(frame), inspector.GetName(geometry)
            path = "/".join([self._prefix, *(n.replace("::", "/") for n in names)])
            vertices, faces = gltf_triangles(Path(shape.source().path()))
            points: Any = np.asfortranarray(vertices)
            self._meshcat.SetTriangleMesh(f"{path}{COVER}", points, faces)
            X_FG = inspector.GetPoseInFrame(geometry)
            self._meshcat.SetTransform(f"{path}{COVER}", X_FG)
            paths.append(path)
        return paths
