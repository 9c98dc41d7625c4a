"""How the pelvis has to be so that hands get where they are wanted.

Inverse kinematics of the whole robot: both feet stay where they are, the center of mass
stays over the middle between them, and the trunk turns with the pelvis, its back as in
the stand-prep pose, as in MANIPULATE.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from pydrake.autodiffutils import AutoDiffXd
from pydrake.common.eigen_geometry import Quaternion_
from pydrake.math import RollPitchYaw_, RotationMatrix, RotationMatrix_
from pydrake.multibody.inverse_kinematics import (
    ComPositionConstraint,
)
from pydrake.solvers import SnoptSolver

from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import AtlasBehaviorPelvisServoParams
from atlas_drake.planning.hand_goal import HandGoal
from atlas_drake.planning.palms import arms_of
from atlas_drake.planning.reach import (
    POSTURE,
    Reach,
    add_costs,
    add_holding,
    kinematics_of,
    reached,
)
from atlas_drake.robot import Robot
from atlas_drake.robot.shapes import shapes_of
from atlas_drake.rotations import mean_yaw, yaw_of

_TURNED, _RAISED = 1.0, 5.0
"""Weights of a turn of the pelvis [-] and of a change of its height [1/m²]: the arms
reach first."""
_MARGIN = 0.12
"""Distance of arms and legs to their end stops [rad]: what MANIPULATE keeps of the
legs, and what the arms need to make up for its errors."""
_OFF = 1e-3
"""Tolerance of the center of mass [m], of the soles' orientation [rad], and of what is
found."""


class AllowedPelvis(Protocol):
    """Least and greatest values of the pelvis, as in ``controller.manipulate.range``.

    Attributes:
        height: Above the pelvis in the stand-prep pose [m].
        yaw: From the mean heading of the feet [rad].
        pitch: Forward and down [rad].
        roll: To the right [rad].
    """

    height: tuple[float, float]
    yaw: tuple[float, float]
    pitch: tuple[float, float]
    roll: tuple[float, float]


def whole_body_reach(
    robot: Robot, state: np.ndarray, goals: Sequence[HandGoal], allowed: AllowedPelvis
) -> tuple[Reach, AtlasBehaviorPelvisServoParams]:
    """Finds a pose of the pelvis, and positions of all joints, for goals of the hands.

    Args:
        robot: The robot; arms of hands with a goal, legs and pelvis move.
        state: Positions of the robot, in the order of its plant, velocities may follow:
            the output port ``state`` of a station.
        goals: At most one for each hand.
        allowed: Poses of the pelvis.

    Returns:
        What is reached, and the parameters of MANIPULATE for it.

    Raises:
        InvalidMessageError: If the robot has no such hand, one has two goals, or no
            pose is found.
    """
    moves = arms_of(robot, goals) | robot.limb("l_leg", "r_leg")
    kinematics = kinematics_of(robot, state, moves)
    plant, context = shapes_of(robot).plant, kinematics.context()
    q, indices = plant.GetPositions(context), robot.indices(robot.plant)
    program, variables = kinematics.prog(), kinematics.q()
    world, pelvis = plant.world_frame(), plant.GetFrameByName(robot.file.pelvis)

    back = robot.limb("back")
    q[indices.q[back]] = robot.stand_prep[back]
    moving, fixed = indices.q[moves], indices.q[~moves]
    program.AddBoundingBoxConstraint(q[fixed], q[fixed], variables[fixed])
    program.AddBoundingBoxConstraint(
        robot.position_lower[moves] + _MARGIN,
        robot.position_upper[moves] - _MARGIN,
        variables[moving],
    )
    program.AddQuadraticErrorCost(
        POSTURE * np.eye(len(moving)), q[moving], variables[moving]
    )

    soles = [plant.get_frame(index) for index in robot.soles(plant)]
    X_WS = [sole.CalcPoseInWorld(context) for sole in soles]
    for sole, X_WF in zip(soles, X_WS, strict=True):
        p_WF = X_WF.translation()
        kinematics.AddPositionConstraint(sole, [0.0, 0.0, 0.0], world, p_WF, p_WF)
        kinematics.AddOrientationConstraint(
            world, X_WF.rotation(), sole, RotationMatrix(), _OFF
        )
    middle = 0.5 * (X_WS[0].translation() + X_WS[1].translation())
    com = program.NewContinuousVariables(3, "com")
    program.AddBoundingBoxConstraint(middle[:2] - _OFF, middle[:2] + _OFF, com[:2])
    program.AddConstraint(
        ComPositionConstraint(plant, None, world, context),
        np.concatenate([variables, com]),
    )

    heading = mean_yaw(*(yaw_of(X_WF.rotation().matrix()) for X_WF in X_WS))
    turned = variables[indices.pelvis.orientation]
    height = variables[indices.pelvis.position][2:]
    limits = np.array([allowed.roll, allowed.pitch, allowed.yaw])
    program.AddConstraint(
        lambda wxyz: _roll_pitch_yaw(wxyz, heading), *limits.T, turned
    )
    upright = float(middle[2]) + robot.pelvis_height
    program.AddBoundingBoxConstraint(*(upright + np.array([*allowed.height])), height)
    R_WP = pelvis.CalcPoseInWorld(context).rotation()
    kinematics.AddOrientationCost(world, R_WP, pelvis, RotationMatrix(), _TURNED)
    program.AddQuadraticErrorCost(
        _RAISED * np.eye(1), q[indices.pelvis.position][2:], height
    )
    add_costs(kinematics, robot, goals)
    looked_for = np.setdiff1d(np.arange(len(q)), fixed)
    add_holding(kinematics, robot, looked_for, q, goals)

    program.SetInitialGuess(variables, q)
    program.SetInitialGuess(com, plant.CalcCenterOfMassPositionInWorld(context))
    result = SnoptSolver().Solve(program)
    if result.GetInfeasibleConstraints(program, _OFF):
        problem = "no pose of the whole body is found that comes near"
        raise InvalidMessageError("goals", [goal.position for goal in goals], problem)
    q = result.GetSolution(variables)
    roll, pitch, yaw = _roll_pitch_yaw(q[indices.pelvis.orientation], heading).tolist()
    params = AtlasBehaviorPelvisServoParams(
        pelvis_height=float(q[indices.pelvis.position][2] - middle[2]),
        pelvis_yaw=yaw,
        pelvis_pitch=pitch,
        pelvis_roll=roll,
    )
    return reached(robot, q, goals), params


def _roll_pitch_yaw(wxyz: np.ndarray, heading: float) -> np.ndarray:
    """Computes the turn of the pelvis from a heading, with derivatives if given."""
    number = AutoDiffXd if wxyz.dtype == object else float
    R_WP = RotationMatrix_[number](Quaternion_[number](wxyz / np.sqrt(wxyz @ wxyz)))
    R_FW = RotationMatrix_[number].MakeZRotation(number(-heading))
    return np.asarray(RollPitchYaw_[number](R_FW @ R_WP).vector())
