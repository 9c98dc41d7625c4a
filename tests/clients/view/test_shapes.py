"""What views show of a record: solids, shapes of the overlays, colors of links."""

import json

import numpy as np
import pytest

from atlas_drake.clients.view.colors import (
    EFFORTS,
    GAMMA,
    OWNERS,
    PAINT,
    joint_colors,
    painted,
    shade,
)
from atlas_drake.clients.view.overlays import (
    LOG_FIELDS,
    OVERLAYS,
    Overlays,
    logged_overlays,
    overlays_from,
)
from atlas_drake.clients.view.shapes import FORCE_SCALE, overlay_shapes, shapes_of
from atlas_drake.clients.view.solids import TUBE_SIDES, polygon, ribbons, tube, turned
from atlas_drake.errors import ScenarioError
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.palette import (
    BEHAVIOR,
    BUSY,
    COM,
    COP,
    DCM,
    FORCE,
    IDLE,
    SHARED,
    SPENT,
    SUPPORT,
    SWING,
    USER,
)
from atlas_drake.records.tick_record import ContactForce
from atlas_drake.scenario.scenario import LogContent

SHAPES = {
    "support": SUPPORT,
    "plan_com": COM,
    "plan_dcm": DCM,
    "swing": SWING,
    "com_line": COM,
    "com_ball": COM,
    "com": COM,
    "dcm": DCM,
    "cop": COP,
    "forces/0": FORCE,
}
"""The shapes of all overlays during a swing, in drawing order, and their colors."""
AHEAD = np.array([[0.0, 0.0], [0.1, 0.0]])
PATHS = PlannedPaths(com=AHEAD, dcm=AHEAD, swing=[[0.0, 0.1, 0.0], [0.1, 0.1, 0.1]])
PUSHING = ContactForce(np.array([0.1, 0.2, 0.0]), np.array([30.0, -40.0, 120.0]))


@pytest.fixture(scope="module")
def stepping(record_of):
    """A record in which every overlay has something to show."""
    return record_of(paths=PATHS, contacts=(PUSHING,))


def test_overlays_are_known_by_name():
    assert overlays_from("com, dcm") == ["com", "dcm"]
    assert overlays_from("none") == []
    overlays = Overlays(overlays_from("all"))
    assert set(OVERLAYS) - overlays.on == {"effort"}
    overlays.switch("effort", True)  # A link has one color.
    assert set(OVERLAYS) - overlays.on == {"owner"}
    overlays.switch("effort", False)
    assert "effort" not in overlays.on
    with pytest.raises(ScenarioError, match="swing"):
        overlays_from("swings")


def test_a_log_has_the_overlays_that_it_has_values_for():
    assert {*OVERLAYS} == {*logged_overlays(LogContent(paths=True, contacts=True))}
    bare = logged_overlays(LogContent(paths=False, contacts=False))
    assert {*OVERLAYS} - {*bare} == {*LOG_FIELDS}


# ---- solids --------------------------------------------------------------------


def normals(triangles):
    """Twice the area of each triangle, along its normal."""
    vertices, faces = triangles
    a, b, c = vertices.T[faces]
    return np.cross(b - a, c - a)


def volume(triangles):
    """Volume inside, by the divergence theorem; positive if all faces look outward."""
    vertices, faces = triangles
    return np.einsum("ij,ij", vertices.T[faces[0]], normals(triangles)) / 6.0


def test_a_ribbon_covers_its_line_and_half_its_width_beyond():
    starts = np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    ends = np.array([[3.0, 1.0], [4.0, 3.0], [0.0, 0.0]])
    triangles = ribbons(starts, ends, 0.2)
    up = 0.5 * normals(triangles)[:, 2]
    assert np.all(up > 0.0)
    assert up.sum() == pytest.approx((5.0 + 0.2) * 0.2 + (2.0 + 0.2) * 0.2)
    across = triangles[0][:2, 0] - triangles[0][:2, 1]
    assert np.linalg.norm(across) == pytest.approx(0.2)
    assert across @ [3.0, 4.0] == pytest.approx(0.0)
    assert np.isfinite(ribbons(starts[:, :1], starts[:, :1], 0.2)[0]).all()


def test_a_polygon_has_its_area():
    corners = np.array(
        [[0.0, 2.0, 2.0, 1.0, 0.0], [0.0, 0.0, 1.0, 2.0, 1.0], 5 * [0.0]]
    )
    np.testing.assert_allclose(0.5 * normals(polygon(corners)).sum(axis=0), [0, 0, 3.0])


@pytest.mark.parametrize("rise", [0.1, 0.0])
def test_a_tube_has_its_radius_everywhere(rise):
    angle = np.linspace(0.0, 3.0, 20)
    points = np.column_stack([np.cos(angle), np.sin(angle), rise * angle])
    for curve in (points, points * [0.0, 0.0, 1.0 if rise else 0.0]):
        vertices, faces = tube(curve, 0.01)
        rings = vertices.T.reshape(len(curve), TUBE_SIDES, 3)
        if np.ptp(curve):  # Also of a vertical one.
            away = np.linalg.norm(rings - curve[:, None], axis=2)
            np.testing.assert_allclose(away, 0.01)
        assert faces.shape == (3, 2 * TUBE_SIDES * (len(curve) - 1))
        assert set(faces.ravel()) == set(range(vertices.shape[1]))


def test_a_turned_profile_is_a_solid_of_revolution():
    cylinder = turned([(0.0, 0.0), (0.5, 0.0), (0.5, 2.0), (0.0, 2.0)])
    assert np.hypot(*cylinder[0][:2]).max() == pytest.approx(0.5)
    assert np.ptp(cylinder[0][2]) == 2.0
    assert volume(cylinder) == pytest.approx(np.pi * 0.25 * 2.0, rel=0.03)


# ---- shapes --------------------------------------------------------------------


def test_overlays_are_shapes_from_the_ground_up(stepping):
    shapes, com = overlay_shapes(stepping, OVERLAYS), stepping.balance.com
    assert [(shape.name, shape.solid.color) for shape in shapes] == [*SHAPES.items()]
    at = {shape.name: shape.X_WS.translation() for shape in shapes}
    named = {shape.name: shape for shape in shapes}
    np.testing.assert_allclose(at["com_ball"], com)
    np.testing.assert_allclose(at["com"][:2], com[:2])
    np.testing.assert_allclose(at["dcm"][:2], stepping.balance.dcm)
    np.testing.assert_allclose(at["cop"][:2], stepping.balance.cop)
    line, top = named["com_line"], np.array([0.0, 0.0, named["com_line"].length])
    np.testing.assert_allclose(line.X_WS @ top, com)
    arrow = named["forces/0"]
    np.testing.assert_allclose(at["forces/0"], PUSHING.p_WC)
    tip = arrow.X_WS @ np.array([0.0, 0.0, arrow.length])
    np.testing.assert_allclose(tip - PUSHING.p_WC, FORCE_SCALE * PUSHING.force_W)
    swing = named["swing"].solid.triangles[0].T.reshape(2, -1, 3).mean(axis=1)
    np.testing.assert_allclose(swing, PATHS.swing, atol=1e-9)
    ground = min(p_WF[2] for p_WF in stepping.feet.positions)
    support = named["support"].solid.triangles[0]
    np.testing.assert_allclose(support[:2].T, stepping.balance.support, atol=2e-3)
    heights = [*support[2], *(at[name][2] for name in ("com", "dcm", "cop"))]
    assert 0.0 < min(heights) - ground < max(heights) - ground < 0.02


def test_a_view_shows_what_is_switched_on(sim, stepping):
    sole = sim.robot.file.sole
    assert shapes_of(stepping, (), sole) == []
    assert joint_colors(stepping, (), sim.robot) is None
    for name in OVERLAYS:
        shapes = {shape.name for shape in shapes_of(stepping, [name], sole)}
        assert shapes == {n for n in SHAPES if n.split("/")[0].split("_")[0] == name}


def test_overlays_without_values_have_no_shapes(record_of):
    balance = {"cop": None, "support": None}
    for paths, contacts in ((None, None), (PlannedPaths(com=AHEAD[:1]), ())):
        record = record_of(balance=balance, paths=paths, contacts=contacts)
        assert overlay_shapes(record, set(OVERLAYS) - {"com", "dcm"}) == []


def test_equal_shapes_have_equal_keys(record_of, stepping):
    balance = stepping.balance
    near = {"com": 1.001 * balance.com, "support": balance.support + 1e-5}
    moved = record_of(paths=PATHS, contacts=(PUSHING,), balance=near)
    again = overlay_shapes(moved, OVERLAYS)
    first = {shape.name: shape for shape in overlay_shapes(stepping, OVERLAYS)}
    for shape in again:
        assert shape.solid.key == first[shape.name].solid.key, shape.name
    assert len({shape.solid.key for shape in first.values()}) == len(first)


def test_the_ground_carries_a_standing_robot_without_a_path(sim, standing):
    weight = sum(force.force_W[2] for force in standing.contacts)
    assert len(standing.contacts) == 8
    assert weight == pytest.approx(sim.robot.mass * 9.81, rel=0.2)
    assert standing.paths == PlannedPaths()
    balance = standing.balance
    assert balance.support.shape[1] == 2
    np.testing.assert_array_equal(balance.dcm_reference, balance.cop_reference)


# ---- colors --------------------------------------------------------------------


def test_joints_are_colored_by_their_owner_and_their_effort(sim, record_of):
    joints = sim.robot.num_joints
    shares = np.resize([0.0, 128.0, 255.0], joints)
    record = record_of(joints={"k_effort": shares, "effort": sim.robot.effort_limit})
    owners = joint_colors(record, ["owner"], sim.robot)
    assert (owners[0], owners[2]) == (BEHAVIOR, USER)
    np.testing.assert_allclose(owners[1], SHARED, atol=0.01)
    assert joint_colors(record, ["effort"], sim.robot) == joints * [SPENT]
    assert [shade(EFFORTS, share) for share in (0.0, 0.5, 1.0)] == [IDLE, BUSY, SPENT]
    between = shade(OWNERS, 0.27)
    assert BEHAVIOR[0] < between[0] < SHARED[0]


def test_a_painted_mesh_has_one_color_and_the_same_triangles(tmp_path):
    document = {
        "buffers": [{"uri": "a%20b.bin", "byteLength": 4}],
        "meshes": [{"primitives": [{"material": 1, "indices": 0}, {"indices": 2}]}],
        "materials": [{"name": "steel"}, {"name": "shell"}],
        "textures": [{"source": 0}],
        "images": [{"uri": "steel.png"}],
    }
    (tmp_path / "a b.bin").write_bytes(b"data")
    file = tmp_path / "link.gltf"
    file.write_text(json.dumps(document))
    mesh = painted(file, USER).source().in_memory()
    text = json.loads(mesh.mesh_file.contents())
    (material,) = text["materials"]
    color = material["pbrMetallicRoughness"]["baseColorFactor"]
    assert color[3] == 1.0
    np.testing.assert_allclose(color[:3], PAINT * np.power(USER, GAMMA))
    parts = text["meshes"][0]["primitives"]
    assert [(part["material"], part["indices"]) for part in parts] == [(0, 0), (0, 2)]
    assert "images" not in text
    assert [*mesh.supporting_files] == ["a%20b.bin"]
