"""How the joints of arms move so that hands follow their goals.

Resolved motion rate control, D. E. Whitney 1969, damped: of the joints as they are, and
of a trunk that moves under them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable
from pydrake.systems.framework import Context

from atlas_drake.control.feet.curves import quintic_progress
from atlas_drake.control.whole_body.quadratic_program import (
    INEQUALITY,
    SOFT,
    QuadraticProgram,
    solve,
)
from atlas_drake.planning.hand_goal import HandGoal
from atlas_drake.planning.palms import (
    arms_of,
    context_of,
    frame_of,
    palm_of,
    positions_at,
)
from atlas_drake.planning.reach import ANGLE, NEARNESS, range_of
from atlas_drake.robot import Robot
from atlas_drake.robot.shapes import CLEAR, shapes_of

STEP = 1.0
"""The weight of a joint's way [1/rad²]: least squares damped by 1 cm/rad. An arm that
is nearly straight is not thrown about by each jolt of the trunk. Y. Nakamura and H.
Hanafusa, "Inverse kinematic solutions with singularity robustness for robot manipulator
control", J. Dyn. Sys. 1986."""
_WATCHED = 0.08
"""Distance of two links from which a step keeps them apart [m]: they come nearer by
less in one step of a fast motion."""


def joints_between(start: np.ndarray, end: np.ndarray, share: float) -> np.ndarray:
    """Returns joints on the way between two poses, in step with ``goal_between``.

    Args:
        start: Where the way begins [rad].
        end: Where it ends [rad].
        share: Share of the time that has passed, 0 to 1.
    """
    progress, _, _ = quintic_progress(share)
    return start + progress * (end - start)


def arm_step(
    robot: Robot,
    state: np.ndarray,
    goals: Sequence[HandGoal],
    joints: np.ndarray,
    way: np.ndarray,
    most: float,
) -> np.ndarray:
    """Moves the joints of arms by one step of least squares toward their hands' goals.

    They stay within their limits, and links keep ``CLEAR`` of each other.

    Args:
        robot: The robot; the joints of arms whose hands have a goal move.
        state: Positions of the robot, in the order of its plant, velocities may follow.
        goals: At most one for each hand.
        joints: Where the joints are before the step [rad], shape (n,), message order.
        way: Where they go from there as far as hands leave it open [rad], shape (n,).
        most: Largest way of a joint [rad].

    Returns:
        Joint positions [rad], shape (n,), message order; as in ``state`` for joints
        that are of no such arm.
    """
    arms, indices = arms_of(robot, goals), robot.indices(robot.plant)
    q, moving = positions_at(robot, state), indices.q[arms]
    stops = robot.position_lower[arms], robot.position_upper[arms]
    q[moving] = at = np.clip(joints[arms], *stops)
    shapes, columns = shapes_of(robot), indices.v[arms]
    plant, context = shapes.plant, shapes.context_for(arms)
    plant.SetPositions(context, q)

    H, f = STEP * np.eye(len(at)), -STEP * way[arms]
    for goal in goals:
        J, weights = _jacobian(robot, plant, context, goal)[:, columns], _weights(goal)
        H += J.T @ weights @ J
        f -= J.T @ weights @ _way(_present(robot, plant, context, goal), goal)
    distances, J_apart = shapes.distances(context, _WATCHED)
    lowest, highest = range_of(robot, goals, at)
    lower = np.concatenate([np.maximum(lowest - at, -most), CLEAR - distances])
    free = np.full_like(distances, np.inf)
    upper = np.concatenate([np.minimum(highest - at, most), free])
    # Links that are too near already come apart as fast as they can.
    kind = np.repeat([INEQUALITY, SOFT], [len(at), len(distances)]).astype(np.int32)
    step = solve(QuadraticProgram(H, f, J_apart[:, columns], lower, upper, kind))
    q[moving] = np.clip(at + step.x, *stops)
    return np.asarray(q[indices.q])


def arm_speed(
    robot: Robot,
    state: np.ndarray,
    goals: Sequence[HandGoal],
    later: Sequence[HandGoal],
    duration: float,
) -> np.ndarray:
    """Computes the speeds of the arms with which hands follow their goals.

    Least squares with the weights of a step: nearly straight arms stay slow. That the
    pelvis moves in W is left out: hands that press against something would push it
    over.

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
        J = _jacobian(robot, plant, context, goal)
        J_arm, others = J[:, v_indices[arm]], np.zeros(len(v))
        others[v_indices[~arm]] = v[v_indices[~arm]]
        wanted = _way(goal, then) / duration - J @ others
        weights = _weights(goal)
        damped = J_arm.T @ weights @ J_arm + STEP * np.eye(J_arm.shape[1])
        speed[arm] = np.linalg.solve(damped, J_arm.T @ weights @ wanted)
    return speed


def _jacobian(
    robot: Robot, plant: MultibodyPlant, context: Context, goal: HandGoal
) -> np.ndarray:
    """Computes J of a palm's spatial velocity in the goal's frame, (6, velocities)."""
    frame = plant.GetFrameByName(frame_of(robot, goal).name())
    hand, palm = plant.GetFrameByName(goal.hand), palm_of(robot, goal)
    J: np.ndarray = plant.CalcJacobianSpatialVelocity(
        context, JacobianWrtVariable.kV, hand, palm, frame, frame
    )
    return J


def _present(
    robot: Robot, plant: MultibodyPlant, context: Context, goal: HandGoal
) -> HandGoal:
    """Returns the goal that the hand has reached as it is."""
    frame = plant.GetFrameByName(frame_of(robot, goal).name())
    X_FH = plant.GetFrameByName(goal.hand).CalcPose(context, frame)
    R_FH, palm = X_FH.rotation(), palm_of(robot, goal)
    return replace(
        goal,
        position=X_FH @ palm,
        direction=None if goal.direction is None else R_FH @ palm,
        orientation=None if goal.orientation is None else R_FH.ToQuaternion().wxyz(),
    )


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


def _way(goal: HandGoal, later: HandGoal) -> np.ndarray:
    """Computes how far a goal turns and moves in its frame [rad], [m], shape (6,)."""
    turned = np.zeros(3)
    if goal.orientation is not None:
        turn = (later.rotation @ goal.rotation.inverse()).ToAngleAxis()
        turned = turn.angle() * turn.axis()
    elif goal.direction is not None and later.direction is not None:
        ends = np.array([goal.direction, later.direction])
        ends /= np.linalg.norm(ends, axis=1, keepdims=True)
        turned = np.cross(*ends)
    moved = np.array(later.position) - np.array(goal.position)
    return np.concatenate([turned, moved])
