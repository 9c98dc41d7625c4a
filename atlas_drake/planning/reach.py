"""Where joints have to be so that the palms of hands are where they are wanted.

Inverse kinematics by Drake's ``InverseKinematics``: within the joint limits, and clear
of the robot's own body, the palms come as near to their goals as they can, and with
what is left the hands turn to where they are wanted and the joints stay near where they
were.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from pydrake.autodiffutils import (
    ExtractGradient,
    ExtractValue,
    InitializeAutoDiff,
)
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.multibody.tree import Frame, JacobianWrtVariable
from pydrake.solvers import SnoptSolver, SolverOptions
from pydrake.systems.framework import Context

from atlas_drake.control.feet.curves import quintic_progress
from atlas_drake.errors import InvalidMessageError, did_you_mean
from atlas_drake.messages.checks import check_number, check_vector
from atlas_drake.robot import Robot
from atlas_drake.robot.shapes import CLEAR, shapes_of
from atlas_drake.units import GRAVITY

TOLERANCE = 5e-3
"""Distance from a goal up to which it counts as reached [m]."""
SOFTEST, STIFFEST = 1.0, 1e5
"""Range of the stiffness of a palm's hold [N/m]."""
NEARNESS, ANGLE, POSTURE = 1e4, 3.0, 1e-2
"""Weights of the distance [1/m²], of an angle [-] and of a joint's way [1/rad²]: a
millimetre counts as much as an axis that is off by 6°."""

STEP = 1.0
"""The weight of a joint's way where the search is a step of a motion [1/rad²]: least
squares damped by 1 cm/rad. An arm that is nearly straight is not thrown about by each
jolt of the trunk. Y. Nakamura and H. Hanafusa, "Inverse kinematic solutions with
singularity robustness for robot manipulator control", J. Dyn. Sys. 1986."""
_WATCHED = 0.03
"""Distance of two links from which the search keeps them apart [m]."""
_ITERATIONS = 60
"""Largest number of steps of a search: where the nearest of several pairs of links
changes from step to step, it may go on for seconds and gains nothing."""
_HELD = 0.9
"""Largest share of a joint's effort that it takes to hold an arm where a hand goes."""
_FREE = 0.02
"""Distance of an arm's joints to their stops where it is open how the hand is turned
[rad]: an elbow that is straight at its stop is at a saddle, where no step bends it. A
hand that is turned needs all that its wrist has, and its turn bends the elbow."""
_SMALL = 1e-6
"""Step of a joint for a difference [rad]."""
_CLOSE = 1e-3
"""Violation of a constraint up to which a pose counts as possible."""

_UNIT = 1e-3
"""Largest difference of a quaternion's length from 1."""


@dataclass(frozen=True)
class HandGoal:
    """Where the palm of a hand has to be, and how the hand has to be turned there.

    Attributes:
        hand: Body of the hand, of those in the robot's file.
        position: Goal of the palm [m], shape (3,).
        direction: Where the hand has to point, shape (3,); None leaves it open.
        force: What the hand exerts there, for a load its weight upward [N], shape (3,).
        frame: Body of the robot in whose frame position, direction, force and
            orientation are given, and with which they move; ``trunk`` is the chest's
            link on every robot, ``world`` stands for W.
        orientation: How the body's frame has to be turned, a unit quaternion
            [w, x, y, z], in place of a direction; None leaves it open.
        palm: Another point than the robot's palm, in the body's frame [m], shape (3,).
            The hand points from the body's origin there.
        stiffness: Of the palm's hold in its softest direction, at least 1 [N/m]; None,
            or more than the arm can give, for as stiff as it can.
    """

    hand: str
    position: Sequence[float]
    direction: Sequence[float] | None = None
    force: Sequence[float] = (0.0, 0.0, 0.0)
    frame: str = "world"
    orientation: Sequence[float] | None = None
    palm: Sequence[float] | None = None
    stiffness: float | None = None

    def __post_init__(self) -> None:
        """Checks the numbers: Drake would end the process at NaN."""
        if self.stiffness is not None:
            check_number(self.stiffness, "stiffness", SOFTEST, STIFFEST)
        for name in ("position", "direction", "force", "orientation", "palm"):
            value = getattr(self, name)
            if value is None:
                continue
            numbers = check_vector(value, name, 4 if name == "orientation" else 3)
            if name in ("direction", "palm") and not numbers.any():
                problem = "must not be zero: the hand points nowhere"
                raise InvalidMessageError(name, value, problem)
            if name == "orientation" and abs(np.linalg.norm(numbers) - 1.0) > _UNIT:
                raise InvalidMessageError(name, value, "must be of length 1")
        if self.direction is not None and self.orientation is not None:
            problem = "a direction is given as well: the hand is turned by one of them"
            raise InvalidMessageError("orientation", self.orientation, problem)

    @property
    def rotation(self) -> RotationMatrix:
        """The orientation as a matrix."""
        wxyz = np.array(self.orientation)
        return RotationMatrix(Quaternion(wxyz / np.linalg.norm(wxyz)))

    def in_world(self, X_WF: RigidTransform) -> HandGoal:
        """Returns the same goal in W, where its frame is now.

        Args:
            X_WF: Pose of its frame.
        """
        R_WF, direction, orientation = X_WF.rotation(), self.direction, self.orientation
        if direction is not None:
            direction = R_WF @ np.array(direction)
        if orientation is not None:
            orientation = (R_WF @ self.rotation).ToQuaternion().wxyz()
        return replace(
            self,
            position=X_WF @ np.array(self.position),
            direction=direction,
            force=R_WF @ np.array(self.force),
            frame="world",
            orientation=orientation,
        )


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
    within: float = math.inf,
) -> Reach:
    """Finds the positions of the arms' joints with which hands reach their goals.

    Args:
        robot: The robot; the joints of the limbs ``l_arm`` and ``r_arm`` move, those of
            hands with a goal.
        state: Positions of the robot, in the order of its plant, velocities may follow:
            the output port ``state`` of a station.
        goals: At most one for each hand.
        near: Joint positions from which the search begins, and to which it keeps [rad],
            shape (n,), message order; None for those of ``state``.
        within: Largest way of a joint from there [rad], for a step of a motion.

    Raises:
        InvalidMessageError: If the robot has no such hand, or one has two goals.
    """
    limbs, indices = arms_of(robot, goals), robot.indices(robot.plant)
    q, moving = positions_at(robot, state), indices.q[limbs]
    if near is not None:
        q[moving] = near[limbs]
    fixed = np.setdiff1d(np.arange(len(q)), moving)
    lowest, highest = robot.position_lower[limbs], robot.position_upper[limbs]
    q[moving] = np.clip(q[moving], lowest, highest)
    open_turn = [g for g in goals if g.direction is None and g.orientation is None]
    margin = _FREE * arms_of(robot, open_turn)[limbs]
    # A joint that is nearer to its stop may stay there.
    lowest = np.minimum(lowest + margin, q[moving])
    highest = np.maximum(highest - margin, q[moving])
    lower = np.maximum(lowest, q[moving] - within)
    upper = np.minimum(highest, q[moving] + within)
    kinematics = kinematics_of(robot, state, limbs)
    program, variables = kinematics.prog(), kinematics.q()
    program.AddBoundingBoxConstraint(q[fixed], q[fixed], variables[fixed])
    program.AddBoundingBoxConstraint(lower, upper, variables[moving])
    from_afar = math.isinf(within)
    posture = (POSTURE if from_afar else STEP) * np.eye(len(moving))
    program.AddQuadraticErrorCost(posture, q[moving], variables[moving])
    add_costs(kinematics, robot, goals)
    # From afar a search may get stuck at a limit that it meets on its way.
    starts = [q[moving]]
    if from_afar:
        starts += [robot.stand_prep[limbs], 0.5 * (lower + upper)]
        add_holding(kinematics, robot, moving, q, goals)
    options = SolverOptions()
    options.SetOption(SnoptSolver.id(), "Major iterations limit", _ITERATIONS)
    results = []
    for start in starts:
        q[moving] = np.clip(start, lower, upper)
        results.append(SnoptSolver().Solve(program, q, options))
    clear = [r for r in results if not r.GetInfeasibleConstraints(program, _CLOSE)]
    best = min(clear or results, key=lambda result: result.get_optimal_cost())
    # A step of the line search may end beyond the limits by rounding.
    q[moving] = np.clip(best.GetSolution(variables)[moving], lower, upper)
    return reached(robot, q, goals)


def positions_at(robot: Robot, state: np.ndarray) -> np.ndarray:
    """Returns the positions of the robot's own plant, with a quaternion of length 1.

    Args:
        robot: The robot.
        state: Positions of the robot, in the order of its plant, velocities may follow.
    """
    plant = robot.plant
    q = np.array(state[: plant.num_positions()])
    # Integration leaves a quaternion of not quite length 1, which no solution has.
    turned = robot.indices(plant).pelvis.orientation
    q[turned] /= np.linalg.norm(q[turned])
    return q


def context_of(
    robot: Robot, state: np.ndarray, joints: np.ndarray | None = None
) -> Context:
    """Creates a Context of the robot's own plant.

    Args:
        robot: The robot.
        state: Positions of the robot, in the order of its plant, velocities may follow.
        joints: Joint positions in place of those [rad], shape (n,), message order.
    """
    plant, q = robot.plant, positions_at(robot, state)
    if joints is not None:
        q[robot.indices(plant).q] = joints
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, q)
    return context


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


def holding_effort(
    robot: Robot, context: Context, goals: Sequence[HandGoal]
) -> np.ndarray:
    """Computes the efforts that hold the robot's limbs and exert the goals' forces.

    Args:
        robot: The robot.
        context: Of the robot's own plant.
        goals: At most one for each hand.

    Returns:
        [N·m], shape (n,), message order; right for limbs that touch nothing else.
    """
    plant, world = robot.plant, robot.plant.world_frame()
    com = plant.CalcJacobianCenterOfMassTranslationalVelocity(
        context, JacobianWrtVariable.kV, world, world
    )
    effort = GRAVITY * robot.mass * com[2]
    for goal in goals:
        X_WF = frame_of(robot, goal).CalcPoseInWorld(context)
        force = X_WF.rotation() @ np.array(goal.force)
        effort = effort + palm_jacobian(robot, context, goal).T @ force
    return np.asarray(effort[robot.indices(plant).v])


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


def goal_between(start: HandGoal, end: HandGoal, share: float) -> HandGoal:
    """Returns the goal on a straight way, with the least jerk from rest to rest.

    T. Flash and N. Hogan, "The coordination of arm movements", J. Neurosci. 1985.

    Args:
        start: Where the way begins, in the frame of its end.
        end: Where it ends.
        share: Share of the time that has passed, 0 to 1.
    """
    progress, _, _ = quintic_progress(share)

    def between(start: Sequence[float], end: Sequence[float]) -> list[float]:
        way: list[float] = (
            np.array(start) + progress * (np.array(end) - np.array(start))
        ).tolist()
        return way

    direction = end.direction
    if start.direction is not None and direction is not None:
        direction = between(start.direction, direction)
    return replace(
        end,
        position=between(start.position, end.position),
        direction=direction,
        force=between(start.force, end.force),
        orientation=_turned(start, end, progress),
    )


def _turned(start: HandGoal, end: HandGoal, progress: float) -> list[float] | None:
    if end.orientation is None:
        return None
    first = start.rotation.ToQuaternion()
    between = first.slerp(progress, end.rotation.ToQuaternion())
    wxyz: list[float] = between.wxyz().tolist()
    return wxyz


def arms_of(robot: Robot, goals: Sequence[HandGoal]) -> np.ndarray:
    """Returns which joints are of the arms whose hands have a goal, bool, shape (n,).

    Args:
        robot: The robot.
        goals: At most one for each hand.

    Raises:
        InvalidMessageError: If the robot has no such hand, or one has two goals.
    """
    names = [goal.hand for goal in goals]
    for hand in names:
        if hand not in robot.arms:
            known = ", ".join(robot.arms) or "none"
            problem = f"{robot.name} has no such hand; its hands are {known}"
            raise InvalidMessageError("hand", hand, problem)
    if len(set(names)) < len(names):
        raise InvalidMessageError("hand", names, "a hand has one goal at a time")
    return robot.limb(*(robot.arms[hand] for hand in names))


def palm_of(robot: Robot, goal: HandGoal) -> np.ndarray:
    """Returns the point of a hand that has a goal, in the body's frame [m].

    Args:
        robot: The robot.
        goal: The goal, of one of the robot's hands.
    """
    return np.array(robot.palms[goal.hand] if goal.palm is None else goal.palm)


def palm_jacobian(robot: Robot, context: Context, goal: HandGoal) -> np.ndarray:
    """Computes J of a palm's velocity in W, shape (3, number of velocities).

    Args:
        robot: The robot.
        context: Of the robot's own plant.
        goal: The goal, of one of the robot's hands.
    """
    plant, world = robot.plant, robot.plant.world_frame()
    hand, palm = plant.GetFrameByName(goal.hand), palm_of(robot, goal)
    J: np.ndarray = plant.CalcJacobianTranslationalVelocity(
        context, JacobianWrtVariable.kV, hand, palm, world, world
    )
    return J


def palm_stiffness(
    robot: Robot, context: Context, goal: HandGoal, kp: np.ndarray
) -> float:
    """Computes how stiffly joints hold a palm in its softest direction [N/m].

    A force F moves the palm by J K⁻¹ Jᵀ F: J. K. Salisbury, "Active stiffness control
    of a manipulator in Cartesian coordinates", CDC 1980.

    Args:
        robot: The robot.
        context: Of the robot's own plant.
        goal: The goal, of one of the robot's hands.
        kp: Stiffness of the joints [N·m/rad], shape (n,), message order.
    """
    arm = arms_of(robot, [goal])
    J = palm_jacobian(robot, context, goal)[:, robot.indices(robot.plant).v[arm]]
    return float(1.0 / np.linalg.eigvalsh((J / kp[arm]) @ J.T).max())


def frame_of(robot: Robot, goal: HandGoal) -> Frame:
    """Returns the frame in which a goal is given, of the robot's own plant.

    Args:
        robot: The robot.
        goal: The goal.

    Raises:
        InvalidMessageError: If the robot has no such body.
    """
    plant, name = robot.plant, robot.pushed_link(goal.frame)
    if not plant.HasFrameNamed(name):
        own = plant.GetBodyIndices(robot.instance(plant))
        bodies = [plant.get_body(index).name() for index in own]
        problem = f"{robot.name} has no such body.{did_you_mean(name, bodies)}"
        raise InvalidMessageError("frame", goal.frame, problem)
    return plant.GetFrameByName(name)
