"""The generator of the models: its files are up to date and its parts are right."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest
from build_models import build
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from robot_models.appearance import MATERIALS
from robot_models.appearance_limbs import LEG
from robot_models.collisions import FILTER_GROUPS
from robot_models.curves import interpolate
from robot_models.forms import block, drum, hull
from robot_models.gltf import Material, to_gltf
from robot_models.inertias import combine
from robot_models.parts import Inertial
from robot_models.skeleton import LINKS, SOLE_CENTER
from robot_models.surfaces import Panel, Tube
from robot_models.triangles import Triangles, merge

from .conftest import MODELS

LARGEST_MESH = 250_000
"""Size that no mesh file may exceed [bytes]."""


def _volume(mesh: Triangles) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def test_files_are_what_the_generator_writes_and_no_mesh_is_left_over():
    files = build()
    for path, text in files.items():
        written = (MODELS / path).read_text(encoding="utf-8")
        assert written == text, f"{path} is out of date: run tools/build_models.py"
        assert len(text) < LARGEST_MESH
    present = {f"meshes/{path.name}" for path in (MODELS / "meshes").iterdir()}
    assert present == {path for path in files if path.startswith("meshes/")}


def test_every_link_is_in_one_filter_group():
    grouped = [link for links in FILTER_GROUPS.values() for link in links]
    assert sorted(grouped) == sorted(LINKS)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_drum_is_a_closed_cylinder(axis):
    radius, length = 0.05, 0.12
    mesh = drum(axis, (0.1, -0.2, 0.3), radius, length, rim=1e-5).triangles()
    # An inscribed prism with 22 sides is 1.4 % smaller than the cylinder.
    volume = np.pi * radius**2 * length
    assert _volume(mesh) == pytest.approx(volume, rel=0.02)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0)
    along = mesh.vertices[:, "xyz".index(axis)] - (0.1, -0.2, 0.3)["xyz".index(axis)]
    assert np.ptp(along) == pytest.approx(length)


def test_block_has_its_size():
    mesh = block("z", (0.0, 0.1, 0.0), (0.2, 0.3, 0.4)).triangles()
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), (0.2, 0.3, 0.4))


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_panel_lies_outside_its_hull(axis):
    lift, radius = 0.004, 0.1
    loft = drum(axis, (0.0, 0.0, 0.0), radius, 0.5)
    mesh = Panel(loft, (-0.1, 0.1), (-40.0, 70.0), lift=lift).triangles()
    across = np.delete(mesh.vertices, "xyz".index(axis), axis=1)
    heights = np.linalg.norm(across, axis=1) - radius
    assert heights.max() == pytest.approx(lift, rel=1e-3)
    assert heights.min() == pytest.approx(-lift / 2, rel=1e-3), "a sunken rim"
    degrees = np.degrees(np.arctan2(across[:, 1], across[:, 0]))
    assert degrees.min() == pytest.approx(-40.0)
    assert degrees.max() == pytest.approx(70.0)


def test_straight_tube_is_a_closed_cylinder():
    mesh = Tube(((0.0, 0.0, 0.0), (0.0, 0.3, 0.4)), 0.01, segments=40).triangles()
    assert _volume(mesh) == pytest.approx(np.pi * 0.01**2 * 0.5, rel=0.02)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0)


def test_closed_tube_is_a_torus():
    ring, radius = 0.2, 0.01
    angles = np.linspace(0.0, 2 * np.pi, 17)[:-1]
    points = [(ring * np.cos(a), ring * np.sin(a), 0.0) for a in angles]
    mesh = Tube((*points, points[0]), radius, segments=40).triangles()
    volume = 2 * np.pi**2 * ring * radius**2
    assert _volume(mesh) == pytest.approx(volume, rel=0.02)


def test_mirror_image_keeps_the_outside_outside():
    mesh = hull(
        "x", ((0.0, (0.2, 0.0), (0.1, 0.1)), (0.3, (0.3, 0.1), (0.05, 0.1)))
    ).triangles()
    image = mesh.mirrored()
    assert _volume(image) == pytest.approx(_volume(mesh))
    assert _volume(image) > 0.0
    np.testing.assert_array_equal(image.vertices[:, 1], -mesh.vertices[:, 1])


def test_curve_passes_through_its_samples_without_overshoot():
    knots = np.array([0.0, 1.0, 2.5, 3.0])
    values = np.array([1.0, 2.0, 2.0, -1.0])
    np.testing.assert_allclose(interpolate(knots, values, knots), values)
    between = interpolate(knots, values, np.linspace(0.0, 3.0, 200))
    assert between.max() <= 2.0 + 1e-12
    assert between.min() >= -1.0 - 1e-12


def test_drawn_sole_ends_where_the_foot_touches_the_ground():
    parts = [s.triangles() for surfaces in LEG["foot"].values() for s in surfaces]
    lowest = merge(*parts).vertices[:, 2].min()
    assert lowest == pytest.approx(SOLE_CENTER[2], abs=1e-9)


def test_gltf_holds_the_mesh_with_y_up():
    mesh = block("z", (0.0, 0.0, 0.1), (0.1, 0.2, 0.4)).triangles()
    document = json.loads(to_gltf({"paint": mesh}, {"paint": Material((0, 1, 0))}))
    data = base64.b64decode(document["buffers"][0]["uri"].partition(",")[2])
    assert len(data) == document["buffers"][0]["byteLength"]
    (primitive,) = document["meshes"][0]["primitives"]

    def read(accessor: int, kind: str) -> np.ndarray:
        view = document["bufferViews"][document["accessors"][accessor]["bufferView"]]
        start, length = view["byteOffset"], view["byteLength"]
        return np.frombuffer(data[start : start + length], kind)

    positions = read(primitive["attributes"]["POSITION"], "<f4").reshape(-1, 3)
    np.testing.assert_allclose(positions[:, 0], mesh.vertices[:, 0], atol=1e-5)
    np.testing.assert_allclose(positions[:, 1], mesh.vertices[:, 2], atol=1e-5)
    np.testing.assert_allclose(positions[:, 2], -mesh.vertices[:, 1], atol=1e-5)
    faces = read(primitive["indices"], "<u2").reshape(-1, 3)
    np.testing.assert_array_equal(faces, mesh.faces)


def test_materials_have_two_tones():
    shell, graphite = (sum(MATERIALS[name].color) for name in ("shell", "graphite"))
    assert shell > 5.0 * graphite


def test_combined_inertia_is_that_of_the_parts():
    parts = [
        Inertial(2.0, (0.1, 0.2, 0.3), (0.05, 0.06, 0.07), (0.001, -0.002, 0.003)),
        Inertial(0.5, (-0.4, 0.0, 0.2), (0.01, 0.02, 0.02), (0.0, 0.004, 0.0)),
    ]

    def spatial(part: Inertial) -> SpatialInertia:
        unit = np.array([*part.moments, *part.products]) / part.mass
        about_center = SpatialInertia(part.mass, np.zeros(3), UnitInertia(*unit))
        return about_center.Shift(-np.array(part.center_of_mass))

    expected = spatial(parts[0])
    expected += spatial(parts[1])
    np.testing.assert_allclose(
        spatial(combine(parts)).CopyToFullMatrix6(),
        expected.CopyToFullMatrix6(),
        atol=1e-12,
    )
