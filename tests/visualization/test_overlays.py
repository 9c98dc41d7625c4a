"""Overlays of the controller's state and plan: geometry, and drawing in Meshcat."""

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import AtlasSimulation
from atlas_drake.errors import ScenarioError
from atlas_drake.logs.balance_figures import _TRACKS
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    Behavior,
)
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.palette import BEHAVIOR, BUSY, IDLE, SHARED, SPENT, USER, hex_color
from atlas_drake.visualization.balance_marks import _COLORS
from atlas_drake.visualization.balance_marks import PATH as BALANCE
from atlas_drake.visualization.contact_forces import PATH as FORCES
from atlas_drake.visualization.contact_forces import (
    ContactForce,
    arrow_pose,
    contact_forces_of,
)
from atlas_drake.visualization.control_colors import (
    COVER,
    effort_colors,
    owner_colors,
)
from atlas_drake.visualization.overlays import LOGGED, Overlays, overlays_from
from atlas_drake.visualization.shapes import SIDES, thinned, tube

BALANCE_MARKS = {
    "com": ["com", "com_ball", "com_line"],
    "dcm": ["dcm"],
    "cop": ["cop"],
    "support": ["support"],
    "plan": ["plan_com", "plan_dcm"],
    "swing": ["swing"],
}
LINK = "/drake/visualizer/atlas/l_uarm/atlas/l_uarm_visual"
SWINGING = 1.5
"""When a foot is in the air if WALK is asked for at the start [s]."""


def walking(meshcat, overlays):
    sim = AtlasSimulation(view=meshcat, overlays=overlays)
    command = AtlasSimInterfaceCommand()
    command.behavior = Behavior.WALK
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    return sim


def test_overlays_are_known_by_name():
    assert overlays_from("com, dcm") == ["com", "dcm"]
    assert overlays_from("none") == []
    Overlays(overlays_from("all"))
    with pytest.raises(ScenarioError, match="Did you mean 'swing'"):
        overlays_from("swings")
    assert "effort" not in overlays_from("all", LOGGED)
    with pytest.raises(ScenarioError, match="not in a log"):
        overlays_from("com,forces", LOGGED)


@pytest.fixture(scope="module")
def standing():
    sim = AtlasSimulation()
    sim.advance(0.2)
    return sim


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


def test_an_arrow_points_along_its_force():
    force = ContactForce(np.array([1.0, 2.0, 3.0]), np.array([30.0, -40.0, 120.0]))
    X_WA, length = arrow_pose(force), np.linalg.norm(force.force_W)
    np.testing.assert_allclose(X_WA.translation(), force.p_WC)
    tip = X_WA @ np.array([0.0, 0.0, length]) - force.p_WC
    np.testing.assert_allclose(tip, force.force_W)


def test_the_ground_carries_a_standing_robot_without_a_path(standing):
    forces = contact_forces_of(
        standing.output("contact_results"), standing.output("query_object").inspector()
    )
    weight = sum(force.force_W[2] for force in forces)
    assert len(forces) == 8
    assert weight == pytest.approx(standing.robot.mass * 9.81, rel=0.2)
    plan = standing.output("controller_status").plan
    assert plan.support.shape[1] == 2
    assert standing.output("planned_paths") == PlannedPaths()
    np.testing.assert_array_equal(plan.dcm_reference, plan.cop_reference)


def test_owners_have_colors():
    behavior, shared, user = owner_colors(np.array([0.0, 128.0, 255.0]))
    assert behavior == BEHAVIOR
    assert user == USER
    np.testing.assert_allclose(shared, SHARED, atol=0.01)


def test_effort_has_colors():
    effort, limit = np.array([0.0, -50.0, 100.0, 900.0]), np.full(4, 100.0)
    colors = effort_colors(effort, limit)
    assert colors == [IDLE, BUSY, SPENT, SPENT]


@pytest.mark.slow
def test_a_walk_has_a_plan_and_a_swing_that_overlays_show_once_switched_on():
    meshcat, overlays = Meshcat(), Overlays()
    sim = walking(meshcat, overlays)
    sim.advance_to(SWINGING)
    plan = sim.output("controller_status").plan
    planned = sim.output("planned_paths")
    assert len(planned.com) == len(planned.dcm) == len(planned.cop) > 10
    np.testing.assert_allclose(planned.dcm[0], plan.dcm_reference, atol=0.01)
    # Both come to rest over the same point.
    np.testing.assert_allclose(planned.com[-1], planned.dcm[-1], atol=0.05)
    step = plan.footsteps[0]
    foot = sim.atlas_sim_interface_state.foot_pos_est[step.foot].position.to_array()
    assert np.linalg.norm(planned.swing - foot, axis=1).min() < 0.03
    np.testing.assert_allclose(planned.swing[-1][:2], step.p_WF[:2], atol=0.005)
    assert planned.swing[:, 2].max() > 0.05
    assert plan.support.shape[1] == 2
    paths = [f"{BALANCE}/{mark}" for marks in BALANCE_MARKS.values() for mark in marks]
    paths.append(f"{FORCES}/0")
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


def test_figures_have_the_colors_of_the_view():
    in_figures = {label: color for _, color, label, _ in _TRACKS if label}
    for name, label in (("com", "CoM"), ("dcm", "DCM"), ("cop", "CoP")):
        color = _COLORS[name]
        assert in_figures[label] == hex_color((color.r(), color.g(), color.b()))
