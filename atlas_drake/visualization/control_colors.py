"""Links colored by the user's share, or by the effort, of the joint that moves them.

The pelvis, which no joint moves, keeps its own colors. Browsers read the robot's meshes
too late to color them, so that their triangles are read here.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import (
    FrameId,
    Mesh,
    Meshcat,
    Role,
    SceneGraphInspector,
)

from atlas_drake.messages.joint_command import share_of
from atlas_drake.palette import BEHAVIOR, BUSY, IDLE, SHARED, SPENT, USER, Color
from atlas_drake.robot import Robot
from atlas_drake.visualization.marks import Timeline
from atlas_drake.visualization.overlays import Overlays

_TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""Types of numbers by the codes of glTF."""
_WIDTHS = {"SCALAR": 1, "VEC3": 3}


def gltf_triangles(file: Path) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Reads all parts of a mesh in glTF 2.0 as one.

    Files are as ``tools/robot_models`` writes them, or those of Drake: one node
    at the origin, data in the file or in another file beside it.

    Returns:
        Vertices with z up [m], shape (3, any), and triangles, shape (3, any).
    """
    document = json.loads(file.read_text())
    buffers = [_data(buffer["uri"], file.parent) for buffer in document["buffers"]]
    vertices: list[NDArray[np.float64]] = []
    faces: list[NDArray[np.int32]] = []
    count = 0
    for mesh in document["meshes"]:
        for part in mesh["primitives"]:
            x, y, z = _values(document, buffers, part["attributes"]["POSITION"]).T
            corners = _values(document, buffers, part["indices"]).reshape(-1, 3).T
            # In glTF the y axis points up.
            vertices.append(np.array([x, -z, y], dtype=float))
            faces.append(corners.astype(np.int32) + np.int32(count))
            count += len(x)
    return np.hstack(vertices), np.hstack(faces)


def _data(uri: str, folder: Path) -> bytes:
    """Returns the data of a buffer, from the text itself or from a file beside it."""
    if uri.startswith("data:"):
        return base64.b64decode(uri.split(",", 1)[1])
    return (folder / unquote(uri)).read_bytes()


def _values(document: Any, buffers: list[bytes], number: int) -> NDArray[Any]:
    """Reads the data of an accessor, one row per element."""
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    kind = np.dtype(_TYPES[accessor["componentType"]])
    width = _WIDTHS[accessor["type"]]
    return np.ndarray(
        shape=(accessor["count"], width),
        dtype=kind,
        buffer=buffers[view["buffer"]],
        offset=view.get("byteOffset", 0) + accessor.get("byteOffset", 0),
        strides=(view.get("byteStride", width * kind.itemsize), kind.itemsize),
    )


SHADES = 20
"""Steps of a color scale: equal colors are not sent again."""
GAMMA = 2.2
"""Exponent of the conversion to light intensities, in which Meshcat takes colors."""
COVER = "_colored"
"""Suffix of the path of a link's copy."""


def joint_colors(
    overlays: Overlays, k_effort: np.ndarray, effort: np.ndarray, limit: np.ndarray
) -> list[Color] | None:
    """Colors joints by the coloring that is switched on; None without one."""
    if overlays.is_on("owner"):
        return owner_colors(k_effort)
    return effort_colors(effort, limit) if overlays.is_on("effort") else None


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


class ControlColors:
    """Colors the links.

    A colored link is hidden behind a copy with one material. Browsers load the link
    itself too late for a recording to reach its materials; without the copy the link
    shows its own colors again.
    """

    def __init__(self, meshcat: Meshcat, prefix: str, robot: Robot) -> None:
        """Colors in ``meshcat``, where Drake draws the links under ``prefix``."""
        self._meshcat = meshcat
        self._prefix = prefix
        self._frame_names = [
            [f"{robot.name}::{link}" for link in links] for links in robot.moved_links
        ]
        self.begin()

    def begin(self) -> None:
        """Begins anew after Drake's visualiser, which also deletes the copies."""
        self._timeline = Timeline(self._meshcat)
        self._links: list[list[str]] = []

    def show(
        self,
        colors: Sequence[Color] | None,
        inspector: SceneGraphInspector,
        time: float,
    ) -> None:
        """Shows colors of the joints' links, or their own, from ``time`` [s] on."""
        if colors is None:
            self._cover(False, time)
            return
        if not self._links:
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
