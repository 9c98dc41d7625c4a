"""Overlays of the controller's state and plan: geometry, and drawing in Meshcat."""

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import AtlasSimulation
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.errors import ErrorCode, ScenarioError
from atlas_drake.logs.balance_figures import _TRACKS
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
    StepStatus,
    WalkStatus,
)
from atlas_drake.messages.controller_status import Plan, PlannedPaths
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
    hex_color,
)
from atlas_drake.visualization.caption import feedback_words
from atlas_drake.visualization.control_colors import (
    COVER,
    effort_colors,
    owner_colors,
)
from atlas_drake.visualization.overlay_marks import PATH, pose_and_length
from atlas_drake.visualization.overlay_shapes import (
    DRAWN,
    FORCE_SCALE,
    ContactForce,
    ShapeKind,
    contact_forces_of,
    overlay_shapes,
)
from atlas_drake.visualization.overlays import LOGGED, OVERLAYS, Overlays, overlays_from
from atlas_drake.visualization.shapes import SIDES, thinned, tube
from atlas_drake.visualization.stroke_font import _GLYPHS

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


def walking(meshcat=None, overlays=None):
    sim = AtlasSimulation(view=meshcat, overlays=overlays)
    command = AtlasSimInterfaceCommand()
    command.behavior = Behavior.WALK
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    return sim


# ---- switches ----------------------------------------------------------------


def test_overlays_are_known_by_name():
    assert overlays_from("com, dcm") == ["com", "dcm"]
    assert overlays_from("none") == []
    Overlays(overlays_from("all"))
    with pytest.raises(ScenarioError, match="Did you mean 'swing'"):
        overlays_from("swings")
    assert "effort" not in overlays_from("all", LOGGED)
    with pytest.raises(ScenarioError, match="not in a log"):
        overlays_from("com,forces", LOGGED)


def test_of_the_colorings_the_later_one_counts():
    overlays = Overlays(["owner", "com"])
    overlays.switch("effort", True)
    assert [name for name in OVERLAYS if overlays.is_on(name)] == ["com", "effort"]


@pytest.fixture(scope="module")
def standing():
    sim = AtlasSimulation()
    sim.advance(0.2)
    return sim


# ---- geometry ----------------------------------------------------------------


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


def test_a_tube_may_run_straight_up():
    vertices, _ = tube(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), 0.1)
    np.testing.assert_allclose(np.hypot(*vertices[:2]), 0.1)


def test_a_thinned_curve_looks_the_same():
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


def test_overlays_are_shapes_from_the_ground_up(standing):
    model = WholeBodyModel(standing.robot)
    terms = model.evaluate(model.create_context(), standing.output("state"))
    ahead = np.array([[0.0, 0.0], [0.1, 0.0]])
    rising = np.array([[0.0, 0.1, 0.0], [0.1, 0.1, 0.1]])
    force = ContactForce(np.array([0.1, 0.2, 0.0]), np.array([30.0, -40.0, 120.0]))
    shapes = overlay_shapes(
        DRAWN,
        terms,
        standing.output("controller_status").plan,
        PlannedPaths(com=ahead, dcm=ahead, swing=rising),
        standing.output("foot_wrenches"),
        [force],
    )
    assert {shape.name: shape.color for shape in shapes} == SHAPES
    assert [shape.name for shape in shapes] == [*SHAPES]
    at = {shape.name: shape for shape in shapes}
    np.testing.assert_allclose(at["com_ball"].points[0], terms.com)
    np.testing.assert_allclose(at["com_line"].points[1], terms.com)
    np.testing.assert_allclose(at["com"].points[0, :2], terms.com[:2])
    np.testing.assert_array_equal(at["swing"].points, rising)
    tail, tip = at["forces/0"].points
    assert at["forces/0"].kind is ShapeKind.ARROW
    np.testing.assert_allclose(tail, force.p_WC)
    np.testing.assert_allclose(tip - tail, FORCE_SCALE * force.force_W)
    for name in ("support", "plan_com", "com", "dcm", "cop"):
        assert 0.0 < at[name].points[0, 2] < 0.02, name


def test_overlays_without_values_have_no_shapes(standing):
    model = WholeBodyModel(standing.robot)
    terms = model.evaluate(model.create_context(), standing.output("state"))
    nothing = Plan(), PlannedPaths(), np.zeros(12), []
    shapes = overlay_shapes(DRAWN - {"com", "dcm"}, terms, *nothing)
    assert shapes == []


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


# ---- colors and words -------------------------------------------------------


def test_owners_have_colors():
    behavior, shared, user = owner_colors(np.array([0.0, 128.0, 255.0]))
    assert behavior == BEHAVIOR
    assert user == USER
    np.testing.assert_allclose(shared, SHARED, atol=0.01)


def test_effort_has_colors():
    effort, limit = np.array([0.0, -50.0, 100.0, 900.0]), np.full(4, 100.0)
    colors = effort_colors(effort, limit)
    assert colors == [IDLE, BUSY, SPENT, SPENT]


MY_WALK = Behavior.named(160, "MY_WALK")


def report(behavior=Behavior.STAND, transition=0, walk=0, step=0, error=0):
    message = AtlasSimInterfaceState()
    message.current_behavior = behavior
    message.behavior_feedback.status_flags = transition
    message.walk_feedback.status_flags = walk
    message.step_feedback.status_flags = step
    message.error_code = error
    return message


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (report(), "ok"),
        (report(transition=BehaviorStatus.TRANSITION_SUCCESS), "ok"),
        (
            report(transition=BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR),
            "illegal transition",
        ),
        (
            report(Behavior.WALK, walk=WalkStatus.SUBSTATE_SWAYING),
            "swaying",
        ),
        (
            report(
                Behavior.WALK,
                BehaviorStatus.TRANSITION_IN_PROGRESS,
                WalkStatus.SUBSTATE_CATCHING
                | WalkStatus.WARNING_INSUFFICIENT_STEP_DATA,
            ),
            "catching, out of steps, transition in progress",
        ),
        (report(Behavior.STEP, step=StepStatus.SUBSTATE_STEPPING), "stepping"),
        # A behavior of one's own that is derived from WALK has its flags, too.
        (report(MY_WALK, walk=WalkStatus.SUBSTATE_STEPPING), "stepping"),
        (
            report(error=ErrorCode.VALUE_OUT_OF_RANGE),
            "error: VALUE OUT OF RANGE",
        ),
    ],
)
def test_flags_in_words(message, words):
    assert feedback_words(message) == words


def test_manipulate_says_whether_the_pelvis_has_arrived():
    message = report(Behavior.MANIPULATE)
    assert feedback_words(message) == "ok"
    message.manipulate_feedback.clamped.pelvis_yaw = 0.1
    assert feedback_words(message) == "pelvis moves"
    assert set("PELVIS MOVES") <= set(_GLYPHS)
    message.manipulate_feedback.internal_desired.pelvis_yaw = 0.1
    assert feedback_words(message) == "ok"


def test_the_font_has_every_letter_of_every_word():
    everything = [
        report(Behavior.WALK, sum(BehaviorStatus), sum(WalkStatus), sum(StepStatus), e)
        for e in ErrorCode
    ]
    for message in everything:
        assert set(feedback_words(message).upper()) <= set(_GLYPHS)


# ---- plans and the scene -----------------------------------------------------


@pytest.mark.slow
def test_a_walk_has_a_plan_and_a_swing():
    sim = walking()
    sim.advance_to(SWINGING)
    plan = sim.output("controller_status").plan
    paths = sim.output("planned_paths")
    assert len(paths.com) == len(paths.dcm) == len(paths.cop) > 10
    np.testing.assert_allclose(paths.dcm[0], plan.dcm_reference, atol=0.01)
    # Both come to rest over the same point.
    np.testing.assert_allclose(paths.com[-1], paths.dcm[-1], atol=0.05)
    step = plan.footsteps[0]
    foot = sim.atlas_sim_interface_state.foot_pos_est[step.foot].position.to_array()
    assert np.linalg.norm(paths.swing - foot, axis=1).min() < 0.03
    np.testing.assert_allclose(paths.swing[-1][:2], step.p_WF[:2], atol=0.005)
    assert paths.swing[:, 2].max() > 0.05
    assert plan.support.shape[1] == 2


@pytest.mark.slow
def test_overlays_reach_the_scene_and_can_be_switched_while_running():
    meshcat, overlays = Meshcat(), Overlays()
    sim = walking(meshcat, overlays)
    sim.advance_to(SWINGING)
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


def test_figures_have_the_colors_of_the_view():
    in_figures = {label: color for _, color, label, _ in _TRACKS if label}
    for name in ("com", "dcm", "cop"):
        label = {"com": "CoM", "dcm": "DCM", "cop": "CoP"}[name]
        assert in_figures[label] == hex_color(SHAPES[name])
