"""Triangles of the robot's meshes, which browsers read too late to color them.

Reads files as ``tools/robot_models`` writes them, and those of Drake's models: one node
at the origin, data in the file or in another file beside it.
"""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

_TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
"""Types of numbers by the codes of glTF."""
_WIDTHS = {"SCALAR": 1, "VEC3": 3}


def gltf_triangles(file: Path) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Reads all parts of a mesh in glTF 2.0 as one.

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
