"""Where joints have to be so that the palms of hands are where they are wanted.

Inverse kinematics by Drake's ``InverseKinematics``: within the joint limits, and clear
of the robot's own body, the palms come as near to their goals as they can, and with
what is left the hands turn to where they are wanted and the joints stay near where they
were.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.autodiffutils import (
    ExtractGradient,
    ExtractValue,
    InitializeAutoDiff,
)
from pydrake.math import RotationMatrix
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.solvers import MathematicalProgram, SnoptSolver, SolverOptions

from atlas_drake.errors import InvalidMessageError
from atlas_drake.planning.arm_motion import ANGLE, NEARNESS, ArmSteps, range_of
from atlas_drake.planning.hand_goal import HandGoal
from atlas_drake.planning.palms import (
    arms_of,
    context_of,
    frame_of,
    holding_effort,
    palm_of,
    positions_at,
)
from atlas_drake.robot import Robot
from atlas_drake.robot.shapes import CLEAR, shapes_of

TOLERANCE = 5e-3
"""Distance from a goal up to which it counts as reached [m]."""
POSTURE = 1e-2
"""The weight of a joint's way in a search [1/rad²]."""
_WATCHED = 0.03
"""Distance of two links from which the search keeps them apart [m]."""
_ITERATIONS = 60
"""Largest number of steps of a search: where the nearest of several pairs of links
changes from step to step, it may go on for seconds and gains nothing."""
_HELD = 0.9
"""Largest share of a joint's effort that it takes to hold an arm where a hand goes."""
_SMALL = 1e-6
"""Step of a joint for a difference [rad]."""
_CLOSE = 1e-3
"""Violation of a constraint up to which a pose counts as possible."""
_THERE = 2e-3
"""Distance [m] and angle [rad] up to which steps have led to a goal, and no other pose
is looked for: the arms keep the one that they have."""


@dataclass(frozen=True)
class Reach:
    """What can be reached.

    Attributes:
        goals: What was asked for.
        joints: Joint positions [rad], shape (n,), message order.
        positions: Where the palms are then, in the goals' frames [m], shape (k, 3).
        angles: How far the hands then point, or are turned, away from their goals
            [rad], shape (k,); 0 where a goal leaves that open.
    """

    goals: tuple[HandGoal, ...]
    joints: np.ndarray
    positions: np.ndarray
    angles: np.ndarray

    @property
    def distances(self) -> np.ndarray:
        """Distances of the palms from their goals [m], shape (k,)."""
        wanted = np.reshape([goal.position for goal in self.goals], (-1, 3))
        return np.asarray(np.linalg.norm(wanted - self.positions, axis=1))

    def check(self, tolerance: float = TOLERANCE) -> None:
        """Refuses a place that is out of reach.

        How a hand is turned there, ``angles`` say.

        Raises:
            InvalidMessageError: If a palm stays away by more than ``tolerance`` [m].
                The nearest place that was found is named.
        """
        if not self.goals:
            return
        far = self.distances
        worst = int(far.argmax())
        if far[worst] > tolerance:
            goal, nearest = self.goals[worst], self.positions[worst].round(3).tolist()
            problem = (
                f"{goal.hand} cannot reach it, or is too weak to stay there; the "
                f"nearest place found is {nearest}, {far[worst]:.3f} m away; let the "
                "robot stand nearer, or bend"
            )
            raise InvalidMessageError("position", list(goal.position), problem)


def reach(
    robot: Robot,
    state: np.ndarray,
    goals: Sequence[HandGoal],
    near: np.ndarray | None = None,
) -> Reach:
    """Finds the positions of the arms' joints with which hands reach their goals.

    Arms keep their pose where ``ArmSteps`` lead from it to the goals, and only else
    another one is searched for.

    Args:
        robot: The robot; the joints of the limbs ``l_arm`` and ``r_arm`` move, those of
            hands with a goal.
        state: Positions of the robot, in the order of its plant, velocities may follow:
            the output port ``state`` of a station.
        goals: At most one for each hand.
        near: Joint positions from which the arms set out, and to which they keep
            [rad], shape (n,), message order; None for those of ``state``.

    Raises:
        InvalidMessageError: If the robot has no such hand, or one has two goals.
    """
    limbs, indices = arms_of(robot, goals), robot.indices(robot.plant)
    q, moving = positions_at(robot, state), indices.q[limbs]
    if near is None:
        near = q[indices.q]
    stops = robot.position_lower[limbs], robot.position_upper[limbs]
    q[moving] = np.clip(near[limbs], *stops)
    lower, upper = range_of(robot, goals, q[moving])
    program = _search(robot, state, goals, q, lower, upper)

    def is_possible(pose: np.ndarray) -> bool:
        constraints = program.GetAllConstraints()
        return all(program.CheckSatisfied(one, pose, _CLOSE) for one in constraints)

    def cost(pose: np.ndarray) -> float:
        costs = program.GetAllCosts()
        return sum(float(program.EvalBinding(one, pose)[0]) for one in costs)

    def cheapest(poses: list[np.ndarray]) -> np.ndarray:
        return min(filter(is_possible, poses), key=cost, default=min(poses, key=cost))

    steps = ArmSteps(robot, goals)

    def stepped(pose: np.ndarray) -> np.ndarray:
        end = pose.copy()
        end[moving] = steps.all_the_way(q, goals, pose[indices.q])[limbs]
        return end

    poses = [stepped(q)]
    found = reached(robot, poses[0], goals)
    off = max([*found.distances, *found.angles], default=0.0)
    if off < _THERE and is_possible(poses[0]):
        return found
    options = SolverOptions()
    options.SetOption(SnoptSolver.id(), "Major iterations limit", _ITERATIONS)
    # From afar: steps end at a limit that they meet on their way.
    for start in (q[moving], robot.stand_prep[limbs], 0.5 * (lower + upper)):
        q[moving] = np.clip(start, lower, upper)
        result = SnoptSolver().Solve(program, q, options)
        # A step of the line search may end beyond the limits by rounding.
        q[moving] = np.clip(result.get_x_val()[moving], lower, upper)
        poses.append(q.copy())
    best = cheapest(poses)
    return reached(robot, cheapest([best, stepped(best)]), goals)


def _search(
    robot: Robot,
    state: np.ndarray,
    goals: Sequence[HandGoal],
    q: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
) -> MathematicalProgram:
    """Returns the search for a pose near positions, and with joints within bounds."""
    limbs = arms_of(robot, goals)
    moving = robot.indices(robot.plant).q[limbs]
    fixed = np.setdiff1d(np.arange(len(q)), moving)
    kinematics = kinematics_of(robot, state, limbs)
    program, variables = kinematics.prog(), kinematics.q()
    program.AddBoundingBoxConstraint(q[fixed], q[fixed], variables[fixed])
    program.AddBoundingBoxConstraint(lower, upper, variables[moving])
    program.AddQuadraticErrorCost(
        POSTURE * np.eye(len(moving)), q[moving], variables[moving]
    )
    add_costs(kinematics, robot, goals)
    add_holding(kinematics, robot, moving, q, goals)
    return program


def kinematics_of(
    robot: Robot, state: np.ndarray, moving: np.ndarray
) -> InverseKinematics:
    """Begins a search for a pose, whose moving links keep clear of all others.

    Args:
        robot: The robot.
        state: Positions of the robot, in the order of its plant, velocities may follow.
        moving: Which joints move, bool, shape (n,), message order.
    """
    shapes = shapes_of(robot)
    context = shapes.context_for(moving)
    shapes.plant.SetPositions(context, positions_at(robot, state))
    # The joints that do not move are where they are, perhaps beyond their limits.
    kinematics = InverseKinematics(shapes.plant, context, with_joint_limits=False)
    kinematics.AddMinimumDistanceLowerBoundConstraint(CLEAR, _WATCHED - CLEAR)
    return kinematics


def add_costs(
    kinematics: InverseKinematics, robot: Robot, goals: Sequence[HandGoal]
) -> None:
    """Adds what it costs that hands are not where they are wanted.

    Args:
        kinematics: Of the robot's shapes.
        robot: The robot.
        goals: At most one for each hand.

    Raises:
        InvalidMessageError: If a hand has to point somewhere whose palm is not known.
    """
    named = shapes_of(robot).plant.GetFrameByName
    for goal in goals:
        frame, hand = named(frame_of(robot, goal).name()), named(goal.hand)
        palm = palm_of(robot, goal)
        kinematics.AddPositionCost(
            frame, goal.position, hand, palm, NEARNESS * np.eye(3)
        )
        if goal.direction is not None:
            if not palm.any():
                problem = f"{goal.hand} points nowhere: give the robot's file its palms"
                raise InvalidMessageError("direction", goal.direction, problem)
            kinematics.AddAngleBetweenVectorsCost(
                hand, palm, frame, goal.direction, ANGLE
            )
        if goal.orientation is not None:
            kinematics.AddOrientationCost(
                frame, goal.rotation, hand, RotationMatrix(), ANGLE
            )


def add_holding(
    kinematics: InverseKinematics,
    robot: Robot,
    moving: np.ndarray,
    q: np.ndarray,
    goals: Sequence[HandGoal],
) -> None:
    """Keeps arms to poses in which they can hold themselves, and what hands exert.

    Args:
        kinematics: Of the robot's shapes.
        robot: The robot.
        moving: Indices of the positions that are looked for.
        q: All positions, in the order of the robot's plant.
        goals: At most one for each hand.
    """
    if not goals:
        return
    context, arms = context_of(robot, q), arms_of(robot, goals)
    q, most = q.copy(), np.full(arms.sum(), _HELD)

    def shares(at: np.ndarray) -> np.ndarray:
        q[moving] = at
        robot.plant.SetPositions(context, q)
        effort = holding_effort(robot, context, goals)
        return np.asarray((effort / robot.effort_limit)[arms])

    def with_gradient(at: np.ndarray) -> np.ndarray:
        if at.dtype != object:
            return shares(at)
        point, gradient = ExtractValue(at).ravel(), ExtractGradient(at)
        here, steps = shares(point), _SMALL * np.eye(len(point))
        J = np.array([shares(point + step) - here for step in steps]).T / _SMALL
        return np.asarray(InitializeAutoDiff(here, J @ gradient)).ravel()

    variables = kinematics.q()[moving]
    kinematics.prog().AddConstraint(with_gradient, -most, most, variables)


def reached(robot: Robot, q: np.ndarray, goals: Sequence[HandGoal]) -> Reach:
    """Computes what hands reach of their goals in a pose.

    Args:
        robot: The robot.
        q: Positions of the robot, in the order of its plant.
        goals: At most one for each hand.
    """
    plant, context = robot.plant, context_of(robot, q)
    positions, angles = [], []
    for goal in goals:
        hand, palm = plant.GetFrameByName(goal.hand), palm_of(robot, goal)
        X_FH = hand.CalcPose(context, frame_of(robot, goal))
        positions.append(X_FH @ palm)
        angles.append(_angle_off(goal, X_FH.rotation(), palm))
    joints = q[robot.indices(plant).q]
    return Reach(tuple(goals), joints, np.reshape(positions, (-1, 3)), np.array(angles))


def _angle_off(goal: HandGoal, R_FH: RotationMatrix, palm: np.ndarray) -> float:
    if goal.orientation is not None:
        return float((goal.rotation.inverse() @ R_FH).ToAngleAxis().angle())
    if goal.direction is None:
        return 0.0
    way, wanted = R_FH @ palm, np.array(goal.direction)
    return math.atan2(float(np.linalg.norm(np.cross(way, wanted))), float(way @ wanted))
