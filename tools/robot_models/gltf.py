"""Writes triangle meshes as self-contained glTF 2.0 text.

Materials come in as values; which colors the robot has is in `appearance`.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from robot_models.triangles import Array, Triangles

_ARRAY_BUFFER, _ELEMENT_ARRAY_BUFFER = 34962, 34963
_FLOAT, _UNSIGNED_SHORT = 5126, 5123

_POSITION_DECIMALS = 5
_NORMAL_DECIMALS = 3


@dataclass(frozen=True)
class Material:
    """Physically based material.

    Attributes:
        color: Red, green and blue, 0 to 1, linear.
        metallic: 0 for paint, plastic and rubber, 1 for bare metal.
        roughness: 0 for a mirror, 1 for chalk.
    """

    color: tuple[float, float, float]
    metallic: float = 0.0
    roughness: float = 0.6


def to_gltf(meshes: Mapping[str, Triangles], materials: Mapping[str, Material]) -> str:
    """Returns one glTF text that holds a mesh per material.

    Args:
        meshes: Triangles by name of their material, in a frame whose z axis is up.
        materials: Materials by name.
    """
    buffer = bytearray()
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []
    primitives = []

    def add(values: np.ndarray, kind: str, component: int, target: int) -> int:
        accessor: dict[str, Any] = {
            "bufferView": len(views),
            "componentType": component,
            "count": values.size if kind == "SCALAR" else len(values),
            "type": kind,
        }
        if target == _ARRAY_BUFFER:
            accessor["min"] = [float(value) for value in values.min(axis=0)]
            accessor["max"] = [float(value) for value in values.max(axis=0)]
        data = values.tobytes()
        views.append(
            {
                "buffer": 0,
                "byteOffset": len(buffer),
                "byteLength": len(data),
                "target": target,
            }
        )
        # Every view starts at a multiple of four bytes, as float data must.
        buffer.extend(data + bytes(-len(data) % 4))
        accessors.append(accessor)
        return len(accessors) - 1

    for number, mesh in enumerate(meshes.values()):
        positions = _y_up(mesh.vertices, _POSITION_DECIMALS)
        normals = _y_up(mesh.normals, _NORMAL_DECIMALS)
        faces = mesh.faces.astype("<u2").ravel()
        primitives.append(
            {
                "attributes": {
                    "POSITION": add(positions, "VEC3", _FLOAT, _ARRAY_BUFFER),
                    "NORMAL": add(normals, "VEC3", _FLOAT, _ARRAY_BUFFER),
                },
                "indices": add(faces, "SCALAR", _UNSIGNED_SHORT, _ELEMENT_ARRAY_BUFFER),
                "material": number,
            }
        )
    encoded = base64.b64encode(bytes(buffer)).decode()
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": [_material(name, materials[name]) for name in meshes],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [
            {
                "byteLength": len(buffer),
                "uri": f"data:application/octet-stream;base64,{encoded}",
            }
        ],
    }
    return json.dumps(document, indent=1) + "\n"


def _y_up(vectors: Array, decimals: int) -> np.ndarray:
    """Turns z-up vectors into glTF's y-up ones.

    Rounding makes the file the same wherever it is written: it hides how the last
    bit of a sine depends on the machine.
    """
    turned = np.stack([vectors[:, 0], vectors[:, 2], -vectors[:, 1]], axis=-1)
    return (np.round(turned, decimals) + 0.0).astype("<f4")


def _material(name: str, material: Material) -> dict[str, Any]:
    return {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*material.color, 1.0],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        },
    }
