"""Goals of the hands become positions of the arms' joints."""

import numpy as np
import pytest

from atlas_drake import HandGoal, InvalidMessageError, reach
from atlas_drake.planning.arm_motion import ArmSteps
from atlas_drake.planning.palms import context_of
from atlas_drake.planning.reach import reached
from atlas_drake.robot import load_robot
from atlas_drake.robot.shapes import CLEAR, shapes_of


@pytest.fixture(scope="module")
def robot():
    return load_robot("atlas")


@pytest.fixture(scope="module")
def state(robot):
    return robot.plant.GetPositions(robot.standing_context())


def palm(robot, state, joints):
    """Returns place and axis of the left palm in W."""
    context = context_of(robot, state, joints)
    X_WH = robot.plant.GetFrameByName("l_hand").CalcPoseInWorld(context)
    return X_WH @ np.array(robot.palms["l_hand"]), X_WH.rotation().matrix()[:, 1]


@pytest.mark.parametrize(
    "place", [[0.5, 0.3, 1.0], [0.45, 0.25, 1.0], [0.4, 0.25, 0.95]]
)
def test_the_palm_is_where_it_has_to_be_and_points_ahead(robot, state, place):
    goal = HandGoal("l_hand", place, (1.0, 0.0, 0.0))
    found = reach(robot, state, [goal])
    found.check()
    p, axis = palm(robot, state, found.joints)
    np.testing.assert_allclose(p, place, atol=1e-3)
    np.testing.assert_allclose(p, found.positions[0], atol=1e-9)
    assert axis[0] > np.cos(0.2)


def test_a_hand_takes_a_pose_that_it_can_have(robot, state):
    """The pose comes from joints somewhere within their limits."""
    joints = state[robot.indices(robot.plant).q].copy()
    arm = robot.limb("l_arm")
    joints[arm] = 0.7 * robot.stand_prep[arm] + 0.3 * robot.position_lower[arm]
    context = context_of(robot, state, joints)
    hand = robot.plant.GetFrameByName("l_hand")
    X_WG = hand.CalcPoseInWorld(context)
    wxyz = X_WG.rotation().ToQuaternion().wxyz()
    found = reach(
        robot,
        state,
        [HandGoal("l_hand", X_WG @ robot.palms["l_hand"], orientation=wxyz)],
    )
    found.check()
    X_WH = hand.CalcPoseInWorld(context_of(robot, state, found.joints))
    off = (X_WG.rotation().inverse() @ X_WH.rotation()).ToAngleAxis().angle()
    assert abs(off) < np.radians(1.0)


def test_only_the_arm_of_the_hand_moves_and_within_its_limits(robot, state):
    found = reach(robot, state, [HandGoal("l_hand", [0.35, 0.3, 1.0])])
    before = state[robot.indices(robot.plant).q]
    moved = np.abs(found.joints - before) > 1e-9
    assert moved.any()
    assert not (moved & ~robot.limb("l_arm")).any()
    assert (found.joints >= robot.position_lower - 1e-9).all()
    assert (found.joints <= robot.position_upper + 1e-9).all()


BESIDE_THE_BODY = [
    [x, y, z] for x in (0.15, 0.25, 0.35) for y in (-0.1, 0.1) for z in (0.9, 1.1)
]


@pytest.mark.slow
@pytest.mark.parametrize("place", BESIDE_THE_BODY)
def test_no_arm_is_within_the_body(robot, state, place):
    """Most of these places are reached only through the chest, or around it."""
    found = reach(robot, state, [HandGoal("l_hand", place)])
    shapes, arm = shapes_of(robot), robot.limb("l_arm")
    context, posed = shapes.context_for(arm), context_of(robot, state, found.joints)
    shapes.plant.SetPositions(context, robot.plant.GetPositions(posed))
    query = shapes.plant.get_geometry_query_input_port().Eval(context)
    near = query.ComputeSignedDistancePairwiseClosestPoints(0.5)
    assert near
    assert min(pair.distance for pair in near) > 0.9 * CLEAR


def test_a_place_that_only_the_chest_hides_is_refused(robot, state):
    with pytest.raises(InvalidMessageError, match="the nearest place found is"):
        reach(robot, state, [HandGoal("l_hand", [0.15, 0.1, 0.9])]).check()


def test_a_state_that_integration_has_left_unnormalized_is_solved(robot, state):
    drifted = state.copy()
    drifted[robot.indices(robot.plant).pelvis.orientation] *= 1.0 + 2e-6
    reach(robot, drifted, [HandGoal("l_hand", [0.35, 0.3, 1.0])]).check()


def test_joints_that_are_not_the_arms_may_be_beyond_their_limits(robot, state):
    beyond = state.copy()
    knee = robot.joint_index("l_leg_kny")
    beyond[robot.indices(robot.plant).q[knee]] = robot.position_lower[knee] - 0.01
    reach(robot, beyond, [HandGoal("l_hand", [0.35, 0.3, 1.0])]).check()


def test_a_goal_of_the_pelvis_moves_with_it(robot, state):
    moved, indices = state.copy(), robot.indices(robot.plant)
    moved[indices.pelvis.position] += [1.0, 2.0, 0.0]
    goal = HandGoal("l_hand", [0.4, 0.3, 0.1], frame="pelvis")
    joints = [reach(robot, q, [goal]).joints for q in (state, moved)]
    np.testing.assert_allclose(joints[0], joints[1], atol=1e-3)


def test_out_of_reach_is_refused_with_the_nearest_place(robot, state):
    found = reach(robot, state, [HandGoal("l_hand", [1.5, 0.3, 1.0])])
    assert 0.3 < found.distances[0] < 1.2
    with pytest.raises(
        InvalidMessageError, match=r"l_hand cannot reach .* nearest .* bend"
    ):
        found.check()


def test_a_place_where_the_arm_cannot_hold_its_load_is_refused(robot, state):
    far, near = [0.5, 0.3, 1.0], [0.25, 0.35, 0.8]
    for place, load, within in [(far, 0, True), (near, 400, True), (far, 500, False)]:
        [away] = reach(
            robot, state, [HandGoal("l_hand", place, force=[0.0, 0.0, load])]
        ).distances
        assert bool(away < 1e-3) is within, (place, load)


def test_no_joint_goes_to_its_stop_where_no_step_bends_it_again(robot, state):
    arm = robot.limb("l_arm")
    found = reach(robot, state, [HandGoal("l_hand", [1.5, 0.3, 1.0])]).joints[arm]
    ends = robot.position_lower[arm], robot.position_upper[arm]
    assert min(abs(found - end).min() for end in ends) > 0.01


@pytest.mark.parametrize("direction", [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
def test_it_is_told_how_far_a_direction_is_missed(robot, state, direction):
    found = reach(robot, state, [HandGoal("l_hand", [0.42, 0.3, 1.05], direction)])
    found.check()
    _, axis = palm(robot, state, found.joints)
    assert found.angles[0] == pytest.approx(np.arccos(axis @ direction), abs=0.06)


def test_a_hand_that_the_robot_has_not_is_refused(robot, state):
    with pytest.raises(InvalidMessageError, match="its hands are l_hand, r_hand"):
        reach(robot, state, [HandGoal("l_hnd", [0.5, 0.3, 1.0])])


@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"position": [0.4, 0.3]}, "position"),
        ({"position": [0.4, 0.3, np.nan]}, "position"),
        ({"palm": "palm"}, "palm"),
        ({"direction": (0.0, 0.0, 0.0)}, "direction"),
        ({"force": [np.inf, 0.0, 0.0]}, "force"),
        ({"orientation": [1.0, 0.0, 0.0]}, "orientation"),
        ({"orientation": [1.0, 1.0, 0.0, 0.0]}, "length 1"),
        (
            {"orientation": [1.0, 0.0, 0.0, 0.0], "direction": (0.0, 1.0, 0.0)},
            "by one of them",
        ),
    ],
)
def test_a_goal_that_is_none_is_refused_by_field(fields, named):
    given = {"position": [0.35, 0.3, 1.0], **fields}
    with pytest.raises(InvalidMessageError, match=named):
        HandGoal("l_hand", **given)


def test_a_frame_that_the_robot_has_not_is_refused(robot, state):
    goal = HandGoal("l_hand", [0.5, 0.3, 1.0], frame="pelvs")
    with pytest.raises(InvalidMessageError, match=r"frame.*pelvis"):
        reach(robot, state, [goal])


def test_a_hand_has_one_goal(robot, state):
    goals = [HandGoal("l_hand", [0.35, 0.3, z]) for z in (1.0, 1.1)]
    with pytest.raises(InvalidMessageError, match="one goal"):
        reach(robot, state, goals)


def test_arms_keep_the_pose_from_which_steps_lead_to_the_goal(robot, state):
    first = reach(robot, state, [HandGoal("l_hand", [0.42, 0.3, 1.05])])
    near = first.joints.copy()
    near[robot.limb("l_arm")] += 0.05
    found = reach(robot, state, [HandGoal("l_hand", [0.42, 0.3, 1.05])], near)
    assert found.distances[0] < 1e-3
    assert np.abs(found.joints - near).max() < 0.1


def test_where_steps_end_at_a_stop_a_pose_is_looked_for_from_afar(robot, state):
    """The wrist is at its stop, and the hand has to turn that way."""
    aside = [np.cos(0.4), np.sin(0.4), 0.0]
    goal = HandGoal("l_hand", [0.3855, 0.2248, 0.95], aside)
    q = state.copy()
    joints = robot.indices(robot.plant).q
    steps = ArmSteps(robot, [goal])
    q[joints] = steps.all_the_way(state, [goal], state[joints])
    assert reached(robot, q, [goal]).angles[0] > 0.3
    assert reach(robot, state, [goal]).angles[0] < 0.05
