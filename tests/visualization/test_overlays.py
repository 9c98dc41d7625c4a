"""Overlays of the controller's state and plan: geometry, and drawing in Meshcat."""

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Behavior
from atlas_drake.errors import ScenarioError
from atlas_drake.messages.behavior_catalog import SHIPPED
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
from atlas_drake.visualization.control_colors import (
    COVER,
    effort_colors,
    owner_colors,
)
from atlas_drake.visualization.overlay_marks import PATH, pose_and_length
from atlas_drake.visualization.overlay_shapes import (
    DRAWN,
    FORCE_SCALE,
    ShapeKind,
    overlay_shapes,
)
from atlas_drake.visualization.overlays import (
    OVERLAYS,
    Overlays,
    logged_overlays,
    overlays_from,
    why_not_logged,
)
from atlas_drake.visualization.seen import see
from atlas_drake.visualization.shapes import SIDES, thinned, tube

SHAPES = {
    "support": SUPPORT,
    "plan_com": COM,
    "plan_dcm": DCM,
    "swing": SWING,
    "com_line": COM,
    "com": COM,
    "com_ball": COM,
    "dcm": DCM,
    "cop": COP,
    "forces/0": FORCE,
}
"""The shapes of all overlays during a swing, in drawing order, and their colors."""
LINK = "/drake/visualizer/atlas/l_uarm/atlas/l_uarm_visual"
SWINGING = 1.5
"""When a foot is in the air if WALK is asked for at the start [s]."""
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
    assert [n for n in OVERLAYS if not overlays.is_on(n)] == ["effort"]
    overlays.switch("effort", True)  # A link has one color.
    assert not overlays.is_on("owner")
    with pytest.raises(ScenarioError, match="'swing'"):
        overlays_from("swings")


def test_a_replay_has_the_overlays_that_its_log_has_values_for():
    assert {*OVERLAYS} == {*logged_overlays(LogContent(paths=True, contacts=True))}
    lacking = {"plan": "paths", "swing": "paths", "forces": "contacts"}
    bare = logged_overlays(LogContent(paths=False, contacts=False))
    assert {*OVERLAYS} - {*bare} == lacking.keys()
    for name, field in lacking.items():
        assert name in why_not_logged(name)
        assert f"log.{field}" in why_not_logged(name)


def test_a_tube_has_its_radius_everywhere():
    angle = np.linspace(0.0, 3.0, 20)
    points = np.column_stack([np.cos(angle), np.sin(angle), 0.1 * angle])
    vertices, faces = tube(points, 0.01)
    rings = vertices.T.reshape(len(points), SIDES, 3)
    away = np.linalg.norm(rings - points[:, None], axis=2)
    np.testing.assert_allclose(away, 0.01)
    assert faces.shape == (3, 2 * SIDES * (len(points) - 1))
    assert faces.min() == 0
    assert faces.max() == vertices.shape[1] - 1
    vertices, _ = tube(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), 0.1)
    np.testing.assert_allclose(np.hypot(*vertices[:2]), 0.1)


def test_a_thinned_curve_stays_within_its_tolerance():
    along = np.linspace(0.0, 1.0, 200)
    curve = np.column_stack([along, 0.2 * np.sin(6.0 * along), 0.0 * along])
    fewer = thinned(curve, 0.002)
    assert len(fewer) < 30
    np.testing.assert_array_equal(fewer[[0, -1]], curve[[0, -1]])
    away = curve[:, 1] - np.interp(along, fewer[:, 0], fewer[:, 1])
    assert np.abs(away).max() < 0.004
    straight = np.outer(along, [1.0, 2.0, 3.0])
    np.testing.assert_array_equal(thinned(straight, 0.002), straight[[0, -1]])
    still = np.ones((5, 3))
    np.testing.assert_array_equal(thinned(still, 0.002), still[:2])


def test_a_rod_points_from_its_tail_to_its_tip():
    tail, tip = np.array([1.0, 2.0, 3.0]), np.array([1.3, 1.6, 4.2])
    X_WA, length = pose_and_length(tail, tip)
    np.testing.assert_allclose(X_WA.translation(), tail)
    np.testing.assert_allclose(X_WA @ np.array([0.0, 0.0, length]), tip)


def test_overlays_are_shapes_from_the_ground_up(stepping):
    shapes, com = overlay_shapes(DRAWN, stepping), stepping.balance.com
    assert [(shape.name, shape.color) for shape in shapes] == [*SHAPES.items()]
    at = {shape.name: shape for shape in shapes}
    np.testing.assert_allclose(at["com_ball"].points[0], com)
    np.testing.assert_allclose(at["com_line"].points[1], com)
    np.testing.assert_allclose(at["com"].points[0, :2], com[:2])
    np.testing.assert_allclose(at["dcm"].points[0, :2], stepping.balance.dcm)
    np.testing.assert_array_equal(at["swing"].points, PATHS.swing)
    tail, tip = at["forces/0"].points
    assert at["forces/0"].kind is ShapeKind.ARROW
    np.testing.assert_allclose(tail, PUSHING.p_WC)
    np.testing.assert_allclose(tip - tail, FORCE_SCALE * PUSHING.force_W)
    for name in ("support", "plan_com", "com", "dcm", "cop"):
        assert 0.0 < at[name].points[0, 2] < 0.02, name


def test_overlays_without_values_have_no_shapes(record_of):
    balance = {"cop": None, "support": None}
    for paths, contacts in ((None, None), (PlannedPaths(), ())):
        record = record_of(balance=balance, paths=paths, contacts=contacts)
        assert overlay_shapes(DRAWN - {"com", "dcm"}, record) == []


def test_a_view_shows_what_is_switched_on(sim, stepping):
    def seen(*names):
        return see(stepping, sim.robot, SHIPPED, Overlays(names))

    nothing = seen()
    assert (nothing.shapes, nothing.joint_colors) == ([], None)
    for name in DRAWN:
        shapes = {shape.name for shape in seen(name).shapes}
        assert shapes == {n for n in SHAPES if n.split("/")[0].split("_")[0] == name}
    assert len(seen("flags").notes) == 1 + len(nothing.notes)
    for name in ("owner", "effort"):
        assert len(seen(name).joint_colors) == sim.robot.num_joints


def test_the_ground_carries_a_standing_robot_without_a_path(sim, standing):
    weight = sum(force.force_W[2] for force in standing.contacts)
    assert len(standing.contacts) == 8
    assert weight == pytest.approx(sim.robot.mass * 9.81, rel=0.2)
    assert standing.paths == PlannedPaths()
    balance = standing.balance
    assert balance.support.shape[1] == 2
    np.testing.assert_array_equal(balance.dcm_reference, balance.cop_reference)


def test_owners_and_efforts_have_colors():
    behavior, shared, user = owner_colors(np.array([0.0, 128.0, 255.0]))
    assert (behavior, user) == (BEHAVIOR, USER)
    np.testing.assert_allclose(shared, SHARED, atol=0.01)
    effort, limit = np.array([0.0, -50.0, 100.0, 900.0]), np.full(4, 100.0)
    assert effort_colors(effort, limit) == [IDLE, BUSY, SPENT, SPENT]


@pytest.mark.slow
def test_a_walk_has_a_plan_and_a_swing_that_overlays_show_once_switched_on():
    meshcat, overlays = Meshcat(), Overlays()
    sim = AtlasSimulation(view=meshcat, overlays=overlays)
    command = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    sim.advance_to(SWINGING)
    record, planned = sim.record, sim.output("planned_paths")
    assert len(planned.com) == len(planned.dcm) == len(planned.cop) > 10
    np.testing.assert_allclose(planned.dcm[0], record.balance.dcm_reference, atol=0.01)
    # Both come to rest over the same point.
    np.testing.assert_allclose(planned.com[-1], planned.dcm[-1], atol=0.05)
    step = record.footsteps[0]
    foot = record.feet.positions[step.foot]
    assert np.linalg.norm(planned.swing - foot, axis=1).min() < 0.03
    np.testing.assert_allclose(planned.swing[-1][:2], step.p_WF[:2], atol=0.005)
    assert planned.swing[:, 2].max() > 0.05
    assert record.balance.support.shape[1] == 2
    paths = [f"{PATH}/{name}" for name in SHAPES]
    assert not [path for path in paths if meshcat.HasPath(path)]
    for name in overlays_from("all"):
        overlays.switch(name, True)
    sim.advance(0.15)
    assert [path for path in paths if not meshcat.HasPath(path)] == []
    assert meshcat.HasPath(f"{LINK}{COVER}")
    sim.reset()
    sim.advance(0.1)
    # Drake's visualiser began anew, and the link is colored again.
    assert meshcat.HasPath(f"{LINK}{COVER}")
