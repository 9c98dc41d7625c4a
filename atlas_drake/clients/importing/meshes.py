"""Shapes of links: their vertices, and files of them that Drake reads.

Reading, hulls, simplification and writing are trimesh's.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL.Image import Resampling
from trimesh.visual.material import PBRMaterial

from atlas_drake.clients.importing.geometry import Geometry

MOST_FACES = 6000
"""Faces from which a visible shape is simplified: the browser loads it at once."""
MOST_HULL_POINTS = 64
"""Vertices from which a convex hull is simplified: contacts are computed faster."""
ENDINGS = (".stl", ".obj", ".dae", ".gltf", ".glb", ".ply")
"""Endings of files that are read as meshes."""
LARGEST = 50_000_000
"""Size of the largest file that is read [byte]: the largest mesh of the robots in
packages has 29 MB."""
_TO_Y_UP = trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0])
"""glTF files have y up, and are turned back by whoever reads them."""
_ROUGHNESS = 0.8
_PLAIN = np.array([200, 200, 205, 255], dtype=np.uint8)
"""Color of a mesh without one."""

Shape = Sequence[Any]
"""Triangle meshes of one geometry, each of one color."""


class MeshLibrary:
    """Reads each mesh once.

    Attributes:
        lost: Why files could not be read, by their names in the URDF.
    """

    def __init__(self, resolve: Callable[[str], Path]) -> None:
        """Finds files by ``resolve``."""
        self._resolve = resolve
        self._known: dict[Path, Shape] = {}
        self.lost: dict[str, str] = {}

    def shape(self, geometry: Geometry) -> Shape:
        """Returns the meshes of a geometry in its frame; none if it cannot be read."""
        if not geometry.is_mesh:
            return [_primitive(geometry)]
        scale = geometry.numbers.get("scale", (1.0,))
        try:
            path = self._resolve(geometry.file)
            with np.errstate(all="ignore"):  # What overflows is not finite.
                if path not in self._known:
                    self._known[path] = _read(path)
                return _scaled(self._known[path], scale)
        except Exception as error:  # trimesh raises whatever its readers raise.
            self.lost[geometry.file] = " ".join(str(error).split())
            return []

    def vertices(self, shapes: Iterable[Any], X: np.ndarray) -> np.ndarray:
        """Returns the vertices of shapes' convex hulls, moved by X, shape (n, 3)."""
        points = [np.zeros((0, 3))]
        for shape in shapes:
            seen = self.shape(shape.geometry)
            if seen:
                points.append(vertices_of(seen, X @ shape.origin))
        return np.concatenate(points)


def _primitive(geometry: Geometry) -> Any:
    """Returns the triangle mesh of a shape that is no mesh."""
    size = geometry.size
    if geometry.kind == "box":
        return trimesh.creation.box(extents=geometry.numbers["size"])
    if geometry.kind == "sphere":
        return trimesh.creation.icosphere(2, radius=size("radius"))
    if geometry.kind == "ellipsoid":
        X = np.diag([size("a"), size("b"), size("c"), 1.0])
        return trimesh.creation.icosphere(2).apply_transform(X)
    if geometry.kind == "capsule":
        return trimesh.creation.capsule(size("length"), size("radius"), count=(24, 24))
    return trimesh.creation.cylinder(size("radius"), size("length"), sections=24)


def _scaled(shape: Shape, scale: Sequence[float]) -> Shape:
    X = np.diag([*np.broadcast_to(scale, 3), 1.0])
    parts = [one.copy().apply_transform(X) for one in shape]
    if not all(np.isfinite(one.vertices).all() for one in parts):
        raise ValueError("it has vertices that are not finite")
    return parts


def _read(path: Path) -> Shape:
    _check_file(path)
    scene = trimesh.load_scene(path)
    parts = [one for one in scene.dump() if len(getattr(one, "faces", ()))]
    if not parts:
        raise ValueError(f"{path} has no triangles")
    kind = path.suffix.lower()
    head = path.read_bytes() if kind == ".dae" else b""
    turned = b"Y_UP" in head or kind in (".gltf", ".glb")
    unit = re.search(rb'<unit\b[^>]*\bmeter="([^"]+)"', head)
    for part in parts:
        if unit is not None:
            part.apply_scale(float(unit[1]))
        color = _color(part.visual)
        part.visual = trimesh.visual.ColorVisuals(part, face_colors=color)
        if turned:
            part.apply_transform(np.linalg.inv(_TO_Y_UP))
    return parts


def _check_file(path: Path) -> None:
    """Refuses, unread, what is no mesh: an archive may unpack to any size."""
    if path.suffix.lower() not in ENDINGS:
        raise ValueError(f"{path} is no mesh: must end in one of {', '.join(ENDINGS)}")
    size = path.stat().st_size
    if size > LARGEST:
        raise ValueError(
            f"{path} has {size / 1e6:.0f} MB; must have at most {LARGEST / 1e6:.0f}"
        )


def _color(visual: Any) -> np.ndarray:
    """Returns the color of a mesh, of a texture its mean."""
    material = getattr(visual, "material", None)
    image = getattr(material, "image", None) or getattr(
        material, "baseColorTexture", None
    )
    if image is not None:
        mean = image.convert("RGB").resize((1, 1), Resampling.BOX).getpixel((0, 0))
        return np.array([*mean, 255], dtype=np.uint8)
    color = getattr(material or visual, "main_color", None)
    return _PLAIN if color is None else np.asarray(color, dtype=np.uint8)


def vertices_of(shape: Shape, X: np.ndarray) -> np.ndarray:
    """Returns the vertices of the convex hull of a shape, moved by X, shape (n, 3)."""
    points = np.concatenate([np.asarray(one.vertices) for one in shape])
    if len(points) > MOST_HULL_POINTS:
        try:
            points = np.asarray(trimesh.convex.hull_points(points))
        except Exception:  # A flat shape has no hull.
            points = np.unique(points, axis=0)
    moved: np.ndarray = points @ X[:3, :3].T + X[:3, 3]
    return moved


def write_visible(shape: Shape, path: Path, color: np.ndarray | None) -> None:
    """Writes a shape as glTF, simplified if it is large, in one color or its own."""
    share = MOST_FACES / sum(len(one.faces) for one in shape)
    scene = trimesh.Scene()
    for one in shape:
        own = one.visual.main_color / 255.0 if color is None else color
        wanted = max(int(share * len(one.faces)), 20)
        if wanted < len(one.faces):
            simpler = one.simplify_quadric_decimation(face_count=wanted)
            one = simpler if len(simpler.faces) else one
        one.fix_normals()
        material = PBRMaterial(
            baseColorFactor=[*map(float, own)],
            metallicFactor=0.0,
            roughnessFactor=_ROUGHNESS,
        )
        one.visual = trimesh.visual.TextureVisuals(material=material)
        scene.add_geometry(one.apply_transform(_TO_Y_UP))
    data = trimesh.exchange.gltf.export_gltf(
        scene, merge_buffers=True, embed_buffers=True, include_normals=True
    )
    path.write_bytes(data["model.gltf"])


def write_hull(points: np.ndarray, path: Path) -> bool:
    """Writes the convex hull of points as .obj; returns False for a flat shape."""
    try:
        hull = trimesh.convex.convex_hull(points)
        if len(hull.vertices) > MOST_HULL_POINTS:
            directions = trimesh.creation.icosphere(1).vertices
            far = np.unique((hull.vertices @ directions.T).argmax(axis=0))
            hull = trimesh.convex.convex_hull(hull.vertices[far])
    except Exception:  # Qhull and trimesh raise several kinds.
        return False
    lines = [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in hull.vertices]
    lines += [f"f {i} {j} {k}" for i, j, k in hull.faces + 1]
    path.write_text("\n".join(lines) + "\n")
    return True
