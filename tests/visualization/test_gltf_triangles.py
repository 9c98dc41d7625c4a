"""Triangles of the robot's meshes, against those that Drake reads."""

import json
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Mesh

import atlas_drake
from atlas_drake.visualization.control_colors import gltf_triangles

MESHES = Path(atlas_drake.__file__).parent / "models" / "meshes"


@pytest.mark.parametrize("name", ["l_uarm", "r_foot", "atlas_utorso"])
def test_a_mesh_is_read_as_drake_reads_it(name):
    file = MESHES / f"{name}.gltf"
    vertices, faces = gltf_triangles(file)
    hull = Mesh(str(file)).GetConvexHull()
    corners = np.array([hull.vertex(i) for i in range(hull.num_vertices())])
    np.testing.assert_allclose(vertices.min(axis=1), corners.min(axis=0), atol=1e-6)
    np.testing.assert_allclose(vertices.max(axis=1), corners.max(axis=0), atol=1e-6)
    assert set(faces.ravel()) == set(range(vertices.shape[1]))


def test_the_triangles_close_around_the_mesh():
    vertices, faces = gltf_triangles(MESHES / "l_uarm.gltf")
    a, b, c = vertices.T[faces]
    across = np.cross(b - a, c - a)
    # The sides of a closed surface point everywhere alike.
    area = np.linalg.norm(across, axis=1).sum()
    assert np.linalg.norm(across.sum(axis=0)) < 0.01 * area
    assert np.einsum("ij,ij", a, across) > 0.0


def test_data_may_lie_in_a_file_beside_and_between_others(tmp_path):
    # A triangle whose corners are four floats apart.
    corners = np.array([[0, 0, 0, 9], [1, 0, 0, 9], [0, 2, 3, 9]], dtype="<f4")
    indices = np.array([0, 1, 2], dtype="<u2")
    data = corners.tobytes() + indices.tobytes()
    (tmp_path / "the data.bin").write_bytes(data)
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": "the%20data.bin", "byteLength": len(data)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48, "byteStride": 16},
            {"buffer": 0, "byteOffset": 48, "byteLength": 6},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    }
    file = tmp_path / "triangle.gltf"
    file.write_text(json.dumps(document))
    vertices, faces = gltf_triangles(file)
    np.testing.assert_array_equal(vertices.T, [[0, 0, 0], [1, 0, 0], [0, -3, 2]])
    np.testing.assert_array_equal(faces.T, [[0, 1, 2]])
