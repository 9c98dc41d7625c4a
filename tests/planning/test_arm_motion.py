"""Arms move so that hands follow their goals on a body that moves."""

from dataclasses import replace

import numpy as np
import pytest
from pydrake.multibody.tree import JacobianWrtVariable

from atlas_drake import HandGoal
from atlas_drake.planning.arm_motion import ArmSteps, arm_speed
from atlas_drake.planning.palms import context_of, frame_of, palm_of
from atlas_drake.planning.reach import reach, reached
from atlas_drake.robot import load_robot
from atlas_drake.robot.shapes import CLEAR, shapes_of

PLACE, LATER, SOON = [0.35, 0.35, 0.2], [0.36, 0.35, 0.19], 0.1
"""Of the left palm from the pelvis [m], and after this time [s]."""
AHEAD = [1.0, 0.0, 0.0]


@pytest.fixture(scope="module")
def robot():
    return load_robot("atlas")


def spatial_velocity(robot, state, goal):
    """Returns the palm's [rad/s, m/s] in the goal's frame, shape (6,)."""
    plant = robot.plant
    J = plant.CalcJacobianSpatialVelocity(
        context_of(robot, state),
        JacobianWrtVariable.kV,
        plant.GetFrameByName(goal.hand),
        palm_of(robot, goal),
        frame_of(robot, goal),
        frame_of(robot, goal),
    )
    return J @ state[plant.num_positions() :]


@pytest.mark.parametrize("frame", ["pelvis", "world"])
def test_the_palm_moves_as_its_goal_while_the_body_moves(robot, frame):
    """What the arms did before does not count, nor that the pelvis moves in W."""
    plant, rng = robot.plant, np.random.default_rng(3)
    q = plant.GetPositions(robot.standing_context())
    q[robot.indices(plant).q] = reach(
        robot, q, [HandGoal("l_hand", PLACE, AHEAD, frame="pelvis")]
    ).joints
    state = np.concatenate([q, rng.uniform(-0.3, 0.3, plant.num_velocities())])
    X_PF = frame_of(robot, HandGoal("l_hand", PLACE, frame="pelvis")).CalcPose(
        context_of(robot, q), frame_of(robot, HandGoal("l_hand", PLACE, frame=frame))
    )
    goals = [
        [HandGoal("l_hand", X_PF @ np.array(p), X_PF.rotation() @ AHEAD, frame=frame)]
        for p in (PLACE, LATER)
    ]
    speed = arm_speed(robot, state, *goals, SOON)
    arm = robot.limb("l_arm")
    assert not speed[~arm].any()
    followed = state.copy()
    followed[plant.num_positions() :][:6] = 0.0
    followed[plant.num_positions() + robot.indices(plant).v[arm]] = speed[arm]
    [[goal], [later]] = goals
    velocity = spatial_velocity(robot, followed, goal)
    expected = (np.array(later.position) - np.array(goal.position)) / SOON
    np.testing.assert_allclose(velocity[3:], expected, atol=0.01)
    # The hand keeps pointing where it has to; about that axis it may turn.
    across = velocity[:3] - (velocity[:3] @ goal.direction) * np.array(goal.direction)
    before = spatial_velocity(robot, state, goal)[:3]
    assert np.linalg.norm(across) < 0.5 * np.linalg.norm(before)


def test_a_stretched_arm_stays_slow(robot):
    plant = robot.plant
    q = plant.GetPositions(robot.standing_context())
    far = HandGoal("l_hand", [2.0, 0.6, 0.4], frame="pelvis")
    found = reach(robot, q, [far])
    q[robot.indices(plant).q] = found.joints
    state = np.concatenate([q, np.zeros(plant.num_velocities())])
    goal = HandGoal("l_hand", found.positions[0], frame="pelvis")
    outward = found.positions[0] * (1.0 + 0.01 / np.linalg.norm(found.positions[0]))
    later = HandGoal("l_hand", outward, frame="pelvis")
    speed = arm_speed(robot, state, [goal], [later], 0.1)
    assert np.abs(speed).max() < 2.0


def step(robot, state, goals, way=0.0, most=0.05):
    q = state[robot.indices(robot.plant).q]
    way = np.full_like(q, way)
    return ArmSteps(robot, goals).step(state, goals, q, way, most)


def test_steps_bring_hands_to_their_goals_and_no_joint_goes_too_far(robot):
    state = robot.plant.GetPositions(robot.standing_context())
    joints, arms = robot.indices(robot.plant).q, robot.limb("l_arm", "r_arm")
    there = state.copy()
    there[joints[arms]] += np.random.default_rng(3).uniform(-0.2, 0.3, arms.sum())
    there[joints] = np.clip(there[joints], robot.position_lower, robot.position_upper)
    context, pelvis = context_of(robot, there), robot.plant.GetFrameByName("pelvis")
    goals = []
    for hand in robot.arms:
        X_PH = robot.plant.GetFrameByName(hand).CalcPose(context, pelvis)
        place, wxyz = X_PH @ robot.palms[hand], X_PH.rotation().ToQuaternion().wxyz()
        goals.append(HandGoal(hand, place, orientation=wxyz, frame="pelvis"))
    goals[0] = replace(
        goals[0], orientation=None, direction=goals[0].rotation @ robot.palms["l_hand"]
    )
    for _ in range(80):
        before, state[joints] = state[joints].copy(), step(robot, state, goals)
        assert np.abs(state[joints] - before).max() <= 0.05 + 1e-9
    found = reached(robot, state, goals)
    assert found.distances.max() < 1e-3
    assert found.angles.max() < 0.02


def test_what_hands_leave_open_goes_its_way_within_the_stops(robot):
    state = robot.plant.GetPositions(robot.standing_context())
    arm = robot.limb("l_arm")
    palm = HandGoal("l_hand", [0.0, 0.0, 0.0], frame="pelvis")
    here = replace(palm, position=reached(robot, state, [palm]).positions[0])
    joints = robot.indices(robot.plant).q
    start = state[joints].copy()
    for _ in range(100):
        state[joints] = step(robot, state, [here], way=0.03)
    moved = state[joints] - start
    assert reached(robot, state, [here]).distances[0] < 2e-3
    assert np.abs(moved[arm]).max() > 0.3
    assert not moved[~arm].any()
    assert (state[joints] <= robot.position_upper + 1e-9).all()
    assert (state[joints] >= robot.position_lower - 1e-9).all()


def test_a_hand_that_is_led_into_the_body_stops_before_it(robot):
    state = robot.plant.GetPositions(robot.standing_context())
    inside = HandGoal("l_hand", [0.05, 0.0, 0.3], frame="pelvis")
    shapes, arm = shapes_of(robot), robot.limb("l_arm")
    nearest = []
    for _ in range(60):
        state[robot.indices(robot.plant).q] = step(robot, state, [inside])
        context = shapes.context_for(arm)
        shapes.plant.SetPositions(context, state)
        distances, _ = shapes.distances(context, 0.05)
        nearest.append(min(distances, default=0.05))
    assert min(nearest) > 0.5 * CLEAR
    # It came as near as it may.
    assert nearest[-1] < 1.5 * CLEAR
