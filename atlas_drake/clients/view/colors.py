"""Colors of links: by the user's share, or by the effort, of the joint that moves them.

The pelvis, which no joint moves, keeps its own colors.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import (
    GeometryId,
    InMemoryMesh,
    Mesh,
    Meshcat,
    Role,
    SceneGraphInspector,
)

from atlas_drake.clients.view.meshcat_shapes import Visibility
from atlas_drake.palette import BEHAVIOR, BUSY, IDLE, SHARED, SPENT, USER, Color
from atlas_drake.records import TickRecord
from atlas_drake.robot import Robot

OWNERS, EFFORTS = (BEHAVIOR, SHARED, USER), (IDLE, BUSY, SPENT)
"""Colors at the begin, in the middle and at the end of both scales."""
SHADES = 4
"""Steps of a scale: Meshcat has a copy of each link for each color."""
GAMMA = 2.2
"""Exponent of the conversion to light intensities, in which glTF has colors."""
PAINT = 0.5
"""Share of the light that paint reflects: in the light of the scene a link then has the
color of the palette."""
COVER = "_colored"
"""Suffix of the path of a link's copies."""


def joint_colors(
    record: TickRecord, on: Collection[str], robot: Robot
) -> list[Color] | None:
    """Returns the colors of the joints' links; None if no coloring is switched on."""
    joints = record.joints
    if "owner" in on:
        return [shade(OWNERS, k) for k in joints.k]
    if "effort" in on:
        shares = np.minimum(np.abs(joints.effort) / robot.effort_limit, 1.0)
        return [shade(EFFORTS, share) for share in shares]
    return None


def shade(scale: Sequence[Color], share: float) -> Color:
    """Returns the color at a point of a scale, 0 to 1, in discrete shades."""
    at = round(SHADES * float(share)) / SHADES
    places = np.linspace(0.0, 1.0, len(scale))
    r, g, b = (float(np.interp(at, places, part)) for part in zip(*scale, strict=True))
    return r, g, b


class LinkColors:
    """Colors the links in Meshcat.

    A colored link is hidden behind one of its copies, each of one color: browsers load
    meshes too late for a recording to change their colors.
    """

    def __init__(self, meshcat: Meshcat, prefix: str, robot: Robot) -> None:
        """Colors in ``meshcat``, where Drake draws the links under ``prefix``."""
        self._meshcat = meshcat
        self._prefix = prefix
        self._frames = [
            [f"{robot.name}::{link}" for link in links] for links in robot.moved_links
        ]
        self.begin()

    def begin(self) -> None:
        """Begins anew after Drake's visualizer, which also deletes the copies."""
        self._visibility = Visibility(self._meshcat)
        self._copies: dict[str, dict[Color, str]] = {}
        self._shown: Sequence[Color] | None = None

    def show(
        self,
        colors: Sequence[Color] | None,
        inspector: SceneGraphInspector,
        time: float,
    ) -> None:
        """Shows colors of the joints' links, or their own, from ``time`` [s] on."""
        if colors == self._shown:
            return
        self._shown = colors
        if colors is None:
            for path in self._copies:
                self._uncover(path, None, time)
            return
        frames = {inspector.GetName(f): f for f in inspector.GetAllFrameIds()}
        for names, color in zip(self._frames, colors, strict=True):
            for name in names:
                for geometry in inspector.GetGeometries(
                    frames[name], Role.kIllustration
                ):
                    self._paint(inspector, name, geometry, color, time)

    def _paint(
        self,
        inspector: SceneGraphInspector,
        link: str,
        geometry: GeometryId,
        color: Color,
        time: float,
    ) -> None:
        """Shows a mesh in a color."""
        mesh = inspector.GetShape(geometry)
        if not isinstance(mesh, Mesh) or mesh.extension() != ".gltf":
            return
        names = self._prefix, link, inspector.GetName(geometry)
        path = "/".join(name.replace("::", "/") for name in names)
        copies = self._copies.setdefault(path, {})
        if color not in copies:
            copies[color] = copy = f"{path}{COVER}/{len(copies)}"
            self._meshcat.SetObject(copy, painted(Path(mesh.source().path()), color))
            self._meshcat.SetTransform(copy, inspector.GetPoseInFrame(geometry))
        self._uncover(path, color, time)

    def _uncover(self, path: str, color: Color | None, time: float) -> None:
        """Shows the copy of one color, or with None the link itself."""
        self._visibility.show(path, color is None, time)
        for other, copy in self._copies[path].items():
            self._visibility.show(copy, other == color, time)


def painted(file: Path, color: Color) -> Mesh:
    """Returns a mesh of a glTF file with one color in place of its materials."""
    document = json.loads(file.read_text())
    light = [*(PAINT * part**GAMMA for part in color), 1.0]
    paint = {"baseColorFactor": light, "metallicFactor": 0.0, "roughnessFactor": 0.6}
    document["materials"] = [{"pbrMetallicRoughness": paint}]
    for mesh in document["meshes"]:
        for part in mesh["primitives"]:
            part["material"] = 0
    for name in ("textures", "images", "samplers"):
        document.pop(name, None)
    files = [buffer["uri"] for buffer in document["buffers"]]
    return Mesh(
        InMemoryMesh(
            mesh_file=MemoryFile(json.dumps(document), ".gltf", file.stem),
            supporting_files={
                name: file.parent / unquote(name)
                for name in files
                if not name.startswith("data:")
            },
        )
    )
