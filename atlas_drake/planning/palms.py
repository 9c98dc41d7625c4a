"""Palms of a robot: where its arms have them, how stiffly, and with which efforts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydrake.multibody.tree import Frame, JacobianWrtVariable
from pydrake.systems.framework import Context

from atlas_drake.errors import InvalidMessageError, did_you_mean
from atlas_drake.planning.hand_goal import HandGoal
from atlas_drake.robot import Robot
from atlas_drake.units import GRAVITY


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
