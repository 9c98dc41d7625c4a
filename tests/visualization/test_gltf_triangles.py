"""Triangles of the robot's meshes, against what Drake reads."""

from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Mesh

import atlas_drake
from atlas_drake.visualization.gltf_triangles import gltf_triangles

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
