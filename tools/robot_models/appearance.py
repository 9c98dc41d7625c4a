"""Appearance of the robots: materials, and a mesh for every link.

The shapes themselves are in `appearance_trunk` and `appearance_limbs`.
"""

from __future__ import annotations

from collections.abc import Mapping

from robot_models.appearance_limbs import ARM, LEG
from robot_models.appearance_trunk import (
    HEAD,
    LTORSO,
    MTORSO,
    PELVIS,
    utorso,
)
from robot_models.collisions import BACKPACKS
from robot_models.gltf import Material, to_gltf
from robot_models.parts import Mesh
from robot_models.surfaces import Surface
from robot_models.triangles import merge

MATERIALS = {
    "shell": Material((0.80, 0.81, 0.82), roughness=0.45),
    "graphite": Material((0.035, 0.037, 0.042), roughness=0.55),
    "steel": Material((0.42, 0.43, 0.45), metallic=0.2, roughness=0.4),
    "accent": Material((0.015, 0.13, 0.50), roughness=0.4),
    "lens": Material((0.01, 0.015, 0.02), roughness=0.1),
    "rubber": Material((0.015, 0.015, 0.016), roughness=0.9),
}
"""Two tones, light shells on dark mechanics, and one accent color."""

_Parts = Mapping[str, tuple[Surface, ...]]

_SHARED: dict[str, _Parts] = {
    "pelvis": PELVIS,
    "ltorso": LTORSO,
    "mtorso": MTORSO,
    "head": HEAD,
}

_CHESTS: dict[str, _Parts] = {
    robot: utorso(backpack) for robot, backpack in BACKPACKS.items()
}


def visuals(robot: str) -> dict[str, Mesh]:
    """Returns the mesh of every link of a robot, `"atlas"` or `"atlas_v3"`."""
    links = {link: Mesh(f"meshes/{link}.gltf") for link in _SHARED}
    links["utorso"] = Mesh(f"meshes/{robot}_utorso.gltf")
    for side in "lr":
        for link in (*LEG, *ARM):
            links[f"{side}_{link}"] = Mesh(f"meshes/{side}_{link}.gltf")
    return links


def meshes() -> dict[str, str]:
    """Returns the glTF text of every mesh by its path."""
    files = {f"meshes/{link}.gltf": _text(parts) for link, parts in _SHARED.items()}
    for robot, parts in _CHESTS.items():
        files[f"meshes/{robot}_utorso.gltf"] = _text(parts)
    for link, parts in {**LEG, **ARM}.items():
        files[f"meshes/l_{link}.gltf"] = _text(parts)
        files[f"meshes/r_{link}.gltf"] = _text(parts, mirror=True)
    return files


def _text(parts: _Parts, *, mirror: bool = False) -> str:
    triangles = {
        name: merge(*(surface.triangles() for surface in surfaces))
        for name, surfaces in parts.items()
    }
    if mirror:
        triangles = {name: mesh.mirrored() for name, mesh in triangles.items()}
    return to_gltf(triangles, MATERIALS)
