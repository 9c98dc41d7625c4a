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
from atlas_drake.robot import Robot
from atlas_drake.robot.shapes import CLEAR, shapes_of

NEARNESS, ANGLE = 1e4, 3.0
"""Weights of the distance [1/m²] and of an angle [-]: a millimetre counts as much as an
axis that is off by 6°."""
STEP = 1.0
"""The weight of a joint's way [1/rad²]: least squares damped by 1 cm/rad. An arm that
is nearly straight is not thrown about by each jolt of the trunk. Y. Nakamura and H.
Hanafusa, "Inverse kinematic solutions with singularity robustness for robot manipulator
control", J. Dyn. Sys. 1986."""
_FREE = 0.02
"""Distance of an arm's joints to their stops where it is open how the hand is turned
[rad]: an elbow that is straight at its stop is at a saddle, where no step bends it. A
hand that is turned needs all that its wrist has, and its turn bends the elbow."""
_LONGEST, _SHORTEST, _MOST_STEPS = 0.1, 1e-4, 60
"""Longest step on the way to a goal, the shortest one that leads on [rad], and how many
there are at most."""
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


def range_of(
    robot: Robot, goals: Sequence[HandGoal], positions: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Returns the least and greatest positions of the arms' joints, message order.

    A joint that is nearer to its stop may stay there.

    Args:
        robot: The robot.
        goals: At most one for each hand.
        positions: Where the joints of their arms are [rad].
    """
    limbs = arms_of(robot, goals)
    open_turn = [g for g in goals if g.direction is None and g.orientation is None]
    margin = _FREE * arms_of(robot, open_turn)[limbs]
    lowest = np.minimum(robot.position_lower[limbs] + margin, positions)
    highest = np.maximum(robot.position_upper[limbs] - margin, positions)
    return lowest, highest


class ArmSteps:
    """Steps of least squares with which arms bring hands to their goals.

    The rest of the robot stays where it is. Joints stay within their limits, and links
    keep ``CLEAR`` of each other.
    """

    def __init__(self, robot: Robot, goals: Sequence[HandGoal]):
        """Prepares steps of the arms whose hands have a goal.

        Args:
            robot: The robot.
            goals: At most one for each hand.

        Raises:
            InvalidMessageError: If the robot has no such hand, or one has two goals.
        """
        indices, shapes = robot.indices(robot.plant), shapes_of(robot)
        self._robot, self._arms, self._joints = robot, arms_of(robot, goals), indices.q
        self._moving, self._columns = indices.q[self._arms], indices.v[self._arms]
        self._shapes, self._context = shapes, shapes.context_for(self._arms)
        limits = robot.position_lower, robot.position_upper
        self._stops = [limit[self._arms] for limit in limits]

    def step(
        self,
        state: np.ndarray,
        goals: Sequence[HandGoal],
        joints: np.ndarray,
        way: np.ndarray,
        most: float,
    ) -> np.ndarray:
        """Takes a step.

        Args:
            state: Positions of the robot, in the order of its plant, velocities may
                follow.
            goals: Where the same hands go.
            joints: Where their arms are [rad], shape (n,), message order.
            way: Where they go from there as far as hands leave it open [rad], (n,).
            most: Largest way of a joint [rad].

        Returns:
            Joint positions [rad], shape (n,), message order; as in the state for joints
            that are of no such arm.
        """
        robot, q, columns = self._robot, positions_at(self._robot, state), self._columns
        shapes, context = self._shapes, self._context
        q[self._moving] = at = np.clip(joints[self._arms], *self._stops)
        plant = shapes.plant
        plant.SetPositions(context, q)
        H, f = STEP * np.eye(len(at)), -STEP * way[self._arms]
        for goal in goals:
            J = _jacobian(robot, plant, context, goal)[:, columns]
            weighted = J.T @ _weights(goal)
            H += weighted @ J
            f -= weighted @ _way(_present(robot, plant, context, goal), goal)
        distances, J_apart = shapes.distances(context, _WATCHED)
        lowest, highest = range_of(robot, goals, at)
        lower = np.concatenate([np.maximum(lowest - at, -most), CLEAR - distances])
        free = np.full_like(distances, np.inf)
        upper = np.concatenate([np.minimum(highest - at, most), free])
        # Links that are too near already come apart as fast as they can.
        kind = np.repeat([INEQUALITY, SOFT], [len(at), len(distances)])
        problem = QuadraticProgram(
            H, f, J_apart[:, columns], lower, upper, kind.astype(np.int32)
        )
        q[self._moving] = np.clip(at + solve(problem).x, *self._stops)
        return np.asarray(q[self._joints])

    def all_the_way(
        self, state: np.ndarray, goals: Sequence[HandGoal], joints: np.ndarray
    ) -> np.ndarray:
        """Takes steps until they lead no farther; see ``step``."""
        still = np.zeros_like(joints)
        for _ in range(_MOST_STEPS):
            before = joints
            joints = self.step(state, goals, joints, still, _LONGEST)
            if np.abs(joints - before).max() < _SHORTEST:
                break
        return joints


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
