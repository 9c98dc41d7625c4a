"""Kinematics and dynamics of the robot as the controller believes it to be.

Evaluates every term that the whole-body QP and the behaviours need, once per tick,
from a plant of its own without geometry. Makes no decision about control.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, JacobianWrtVariable
from pydrake.systems.framework import Context

from atlas_drake.robot import Robot

GRAVITY = 9.81
"""Magnitude of the gravitational acceleration [m/s²]."""

_ORIGIN = np.zeros(3)


@dataclass(frozen=True)
class FootTerms:
    """Kinematics of one sole frame F.

    Attributes:
        p_WF: Position of the sole's centre [m], shape (3,).
        R_WF: Orientation, shape (3, 3).
        V_WF: Spatial velocity [rad/s; m/s] in W, shape (6,).
        J_WF: Its Jacobian with respect to the generalized velocities, (6, 6 + n).
        bias: J̇·v [rad/s²; m/s²] in W, shape (6,).
    """

    p_WF: np.ndarray
    R_WF: np.ndarray
    V_WF: np.ndarray
    J_WF: np.ndarray
    bias: np.ndarray


@dataclass(frozen=True)
class WholeBodyTerms:
    """All model terms at one state; n joints in message order.

    Generalized velocities are [ω_WP, v_WP, joints]: the pelvis' angular and
    translational velocity in W, then the joints.

    Attributes:
        q: Joint positions [rad], shape (n,).
        v: Joint velocities [rad/s], shape (n,).
        stack: Rows of ``M``, then those of ``J``, shape (6 + n + 15, 6 + n).
        h: Coriolis, centrifugal and gravity forces and the damping of the joints
            [N·m; N], shape (6 + n,).
        R_WP: Orientation of the pelvis.
        p_WP: Position of the pelvis [m].
        V_WP: Spatial velocity of the pelvis [rad/s; m/s] in W.
        R_WC: Orientation of the chest.
        w_WC: Its angular velocity in W [rad/s].
        bias: J̇·v of the rows of ``J`` [rad/s²; m/s²], shape (15,).
        com: Centre of mass in W [m].
        com_velocity: Its velocity in W [m/s].
        feet: Left and right sole.
    """

    q: np.ndarray
    v: np.ndarray
    stack: np.ndarray
    h: np.ndarray
    R_WP: np.ndarray
    p_WP: np.ndarray
    V_WP: np.ndarray
    R_WC: np.ndarray
    w_WC: np.ndarray
    bias: np.ndarray
    com: np.ndarray
    com_velocity: np.ndarray
    feet: tuple[FootTerms, FootTerms]

    @property
    def M(self) -> np.ndarray:
        """Mass matrix, shape (6 + n, 6 + n)."""
        return self.stack[: -len(self.bias)]

    @property
    def J(self) -> np.ndarray:
        """Jacobians of left sole, right sole and the chest's angular velocity in W.

        Shape (15, 6 + n).
        """
        return self.stack[-len(self.bias) :]


class WholeBodyModel:
    """The controller's own plant. Holds no state: contexts are the caller's."""

    def __init__(self, robot: Robot):
        # Untyped, because pydrake's stubs misname the type of every array.
        plant: Any = robot.make_plant()
        self.robot = robot
        self._plant = plant
        self._indices = robot.indices(plant)
        self._world = plant.world_frame()
        self._pelvis = plant.GetBodyByName(robot.file.pelvis)
        self._chest = plant.GetFrameByName(robot.file.chest)
        self._soles = [plant.GetFrameByName(f.sole_frame) for f in robot.file.feet]
        generalized = self._indices.generalized
        joints = [plant.GetJointByName(name) for name in robot.joint_names]
        self._damping = np.array(
            [joint.default_damping_vector()[0] for joint in joints]
        )
        self._square = generalized[:, None] * plant.num_velocities() + generalized

    @property
    def num_states(self) -> int:
        """Length of the state vector, positions and velocities."""
        return self._plant.num_multibody_states()

    @property
    def plant(self) -> MultibodyPlant:
        """The plant behind the model, without geometry."""
        return self._plant

    def create_context(self) -> Context:
        """A scratch context for ``evaluate``."""
        return self._plant.CreateDefaultContext()

    def evaluate(self, context: Context, state: np.ndarray) -> WholeBodyTerms:
        """Computes all terms at one state of the robot.

        Args:
            context: A scratch context from ``create_context``; overwritten.
            state: Positions and velocities in plant order, the free pelvis first.
        """
        plant, indices = self._plant, self._indices
        plant.SetPositionsAndVelocities(context, state)
        velocity = state[plant.num_positions() :]
        order = indices.generalized
        v = velocity.take(order)

        # Drake's matrices come column by column: their transposes are read in order.
        size = len(order)
        stack = np.empty((size + 15, size))
        M, J = stack[:size], stack[size:]
        plant.CalcMassMatrix(context).T.take(self._square, out=M)
        h = plant.CalcBiasTerm(context).take(order)
        # Gravity is a uniform acceleration, so its generalized force is the column
        # sum that the mass matrix already holds for the pelvis' vertical motion.
        h += GRAVITY * M[:, 5]
        # A swinging foot is so light about the ankle that the joint's damping counts.
        h[6:] += self._damping * v[6:]

        bias = np.empty(15)
        for foot, sole in enumerate(self._soles):
            part = slice(6 * foot, 6 * foot + 6)
            J[part], bias[part] = self._differential(context, sole, order)
        J_chest, chest_bias = self._differential(context, self._chest, order)
        J[12:], bias[12:] = J_chest[:3], chest_bias[:3]
        velocities = J @ v

        X_WP = plant.EvalBodyPoseInWorld(context, self._pelvis)
        return WholeBodyTerms(
            q=state.take(indices.q),
            v=v[6:],
            stack=stack,
            h=h,
            R_WP=X_WP.rotation().matrix(),
            p_WP=X_WP.translation(),
            V_WP=v[:6],
            R_WC=self._chest.CalcPoseInWorld(context).rotation().matrix(),
            w_WC=velocities[12:],
            bias=bias,
            com=plant.CalcCenterOfMassPositionInWorld(context),
            com_velocity=plant.CalcCenterOfMassTranslationalVelocityInWorld(context),
            feet=(
                self._foot(context, 0, velocities, J, bias),
                self._foot(context, 1, velocities, J, bias),
            ),
        )

    def _differential(
        self, context: Context, frame: Frame, order: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Spatial Jacobian and J̇·v of a frame's origin in W, message order."""
        plant, world = self._plant, self._world
        J = plant.CalcJacobianSpatialVelocity(
            context, JacobianWrtVariable.kV, frame, _ORIGIN, world, world
        )
        bias = plant.CalcBiasSpatialAcceleration(
            context, JacobianWrtVariable.kV, frame, _ORIGIN, world, world
        )
        return J.T.take(order, axis=0).T, bias.get_coeffs()

    def _foot(
        self,
        context: Context,
        foot: int,
        velocities: np.ndarray,
        J: np.ndarray,
        bias: np.ndarray,
    ) -> FootTerms:
        X_WF = self._soles[foot].CalcPoseInWorld(context)
        part = slice(6 * foot, 6 * foot + 6)
        return FootTerms(
            p_WF=X_WF.translation(),
            R_WF=X_WF.rotation().matrix(),
            V_WF=velocities[part],
            J_WF=J[part],
            bias=bias[part],
        )


def mean_sole_height(terms: WholeBodyTerms) -> float:
    """Height of the middle between both soles in W [m]."""
    return 0.5 * float(terms.feet[0].p_WF[2] + terms.feet[1].p_WF[2])


def nominal_com_height(model: WholeBodyModel) -> float:
    """Height of the CoM above the soles in the stand-prep pose [m]."""
    context = model.create_context()
    state: Any = model.plant.GetPositionsAndVelocities(context)
    state[model.robot.indices(model.plant).q] = model.robot.stand_prep
    terms = model.evaluate(context, state)
    return float(terms.com[2]) - mean_sole_height(terms)
