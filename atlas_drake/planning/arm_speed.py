"""How fast the joints of arms have to move so that hands follow their goals.

Resolved motion rate control, D. E. Whitney 1969: of the joints as they are, and of a
trunk that moves under them.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from atlas_drake.planning.hand_goal import HandGoal
from atlas_drake.planning.palms import arms_of, context_of, frame_of, palm_of
from atlas_drake.planning.reach import ANGLE, NEARNESS, STEP
from atlas_drake.robot import Robot


def arm_speed(
    robot: Robot,
    state: np.ndarray,
    goals: Sequence[HandGoal],
    later: Sequence[HandGoal],
    duration: float,
) -> np.ndarray:
    """Computes the speeds of the arms with which hands follow their goals.

    Least squares with the weights of a search's step: nearly straight arms stay slow.
    That the pelvis moves in W is left out: hands that press against something would
    push it over.

    Args:
        robot: The robot.
        state: Positions and velocities of the robot, in the order of its plant.
        goals: At most one for each hand.
        later: The same goals after a while.
        duration: How long that is [s].

    Returns:
        [rad/s], shape (n,), message order; 0 for joints that are of no such arm.
    """
    plant, v_indices = robot.plant, robot.indices(robot.plant).v
    context, v = context_of(robot, state), state[plant.num_positions() :]
    speed = np.zeros(robot.num_joints)
    for goal, then in zip(goals, later, strict=True):
        arm = arms_of(robot, [goal])
        hand, frame = plant.GetFrameByName(goal.hand), frame_of(robot, goal)
        J = plant.CalcJacobianSpatialVelocity(
            context,
            JacobianWrtVariable.kV,
            hand,
            palm_of(robot, goal),
            frame,
            frame,
        )
        J_arm, others = J[:, v_indices[arm]], np.zeros(len(v))
        others[v_indices[~arm]] = v[v_indices[~arm]]
        wanted = _rate(goal, then, duration) - J @ others
        weights = _weights(goal)
        damped = J_arm.T @ weights @ J_arm + STEP * np.eye(J_arm.shape[1])
        speed[arm] = np.linalg.solve(damped, J_arm.T @ weights @ wanted)
    return speed


def _weights(goal: HandGoal) -> np.ndarray:
    """Returns what a spatial velocity that is missed costs, shape (6, 6)."""
    weights = np.diag([0.0, 0.0, 0.0, NEARNESS, NEARNESS, NEARNESS])
    # A search's costs of an angle are 1 - cos, half of its square.
    if goal.orientation is not None:
        weights[:3, :3] = 0.5 * ANGLE * np.eye(3)
    elif goal.direction is not None:
        ahead = np.array(goal.direction) / np.linalg.norm(goal.direction)
        weights[:3, :3] = 0.5 * ANGLE * (np.eye(3) - np.outer(ahead, ahead))
    return weights


def _rate(goal: HandGoal, later: HandGoal, duration: float) -> np.ndarray:
    """Computes the spatial velocity of a goal in its frame, shape (6,)."""
    turned = np.zeros(3)
    if goal.orientation is not None:
        turn = (later.rotation @ goal.rotation.inverse()).ToAngleAxis()
        turned = turn.angle() * turn.axis()
    elif goal.direction is not None and later.direction is not None:
        ends = np.array([goal.direction, later.direction])
        ends /= np.linalg.norm(ends, axis=1, keepdims=True)
        turned = np.cross(*ends)
    way = np.array(later.position) - np.array(goal.position)
    return np.concatenate([turned, way]) / duration
