"""Kinematics and dynamics of the controller's model of the robot.

Evaluates every term that the whole-body QP and the behaviors need, once per tick, from
a separate plant without geometry. Control laws are elsewhere.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    Frame,
    FrameIndex,
    JacobianWrtVariable,
    SpatialInertia,
    UnitInertia,
)
from pydrake.systems.framework import Context

from atlas_drake.control.whole_body.terms import FrameTerms, WholeBodyTerms
from atlas_drake.control.wrenches import shift_wrench
from atlas_drake.errors import RobotDescriptionError, did_you_mean, shown
from atlas_drake.frozen import read_only
from atlas_drake.robot import Robot
from atlas_drake.rotations import cross
from atlas_drake.units import GRAVITY

_ORIGIN = np.zeros(3)
_NO_BIAS = read_only(np.zeros(6))
_NO_LOADS, _NO_PULL = read_only(np.zeros(2)), read_only(np.zeros((2, 6)))
_PARTS = (slice(0, 6), slice(6, 12), slice(12, 18))
"""Rows of the frames that every tick needs, stacked."""


class WholeBodyModel:
    """The plant of the controller. Holds no state: the caller owns the contexts."""

    def __init__(self, robot: Robot):
        # Untyped, because pydrake's stubs misname the type of every array.
        plant: Any = robot.plant
        self.robot = robot
        self._plant = plant
        self._indices = robot.indices(plant)
        self._world = plant.world_frame()
        self._pelvis = plant.GetBodyByName(robot.file.pelvis)
        soles = [foot.sole_frame for foot in robot.file.feet]
        self._names = [*soles, robot.file.chest, robot.file.pelvis]
        self._tracked = [plant.GetFrameByName(name) for name in self._names[:3]]
        self._soles = self._tracked[:2]
        generalized = self._indices.generalized
        self._pelvis_jacobian = read_only(np.eye(6, len(generalized)))
        joints = [plant.GetJointByName(name) for name in robot.joint_names]
        self._damping = np.array(
            [joint.default_damping_vector()[0] for joint in joints]
        )
        self._hands = [plant.GetBodyByName(name) for name in robot.file.hands]
        self._num_q = plant.num_positions()
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
        """Creates a scratch context for ``evaluate``."""
        return self._plant.CreateDefaultContext()

    def evaluate(
        self,
        context: Context,
        state: np.ndarray,
        loads: np.ndarray = _NO_LOADS,
        wrenches: np.ndarray = _NO_PULL,
    ) -> WholeBodyTerms:
        """Computes all terms at one state of the robot, positions and velocities.

        The scratch context is overwritten, and read again when ``terms.frame`` computes
        a further frame. ``loads`` are the masses that the left and the right hand carry
        [kg], shape (2,): part of the robot's mass, inertia and center of mass.
        ``wrenches`` are those on the hands at their origins, the weight of the loads
        included [N·m; N], shape (2, 6).
        """
        self._carry(context, loads)
        plant, indices = self._plant, self._indices
        state = np.array(state)
        plant.SetPositionsAndVelocities(context, state)
        velocity = state[self._num_q :]
        order = indices.generalized
        v = read_only(velocity.take(order))

        # Drake's matrices are column-major: their transposes are read in memory order.
        # Any mode but the default one avoids a copy of the result.
        size = len(order)
        M = np.empty((size, size))
        plant.CalcMassMatrix(context).T.take(self._square, out=M, mode="clip")
        h = plant.CalcBiasTerm(context).take(order)
        # Gravity is a uniform acceleration, so its generalized force is the column
        # sum that the mass matrix already holds for the pelvis' vertical motion.
        h += GRAVITY * M[:, 5]
        # A swinging foot is so light about the ankle that the joint's damping counts.
        h[6:] += self._damping * v[6:]
        pull = np.zeros(6)
        if wrenches.any():
            pull = self._pull(context, loads, wrenches, h)

        def compute_frame(name: str) -> FrameTerms:
            if not np.array_equal(plant.GetPositionsAndVelocities(context), state):
                # The context served another state in the meantime.
                plant.SetPositionsAndVelocities(context, state)
            frame = self._frame(name)
            J, bias = self._differential(context, frame)
            parts = read_only((J @ v, J, bias))
            return self._frame_terms(context, frame, *parts)

        J, bias = np.empty((18, size)), np.empty(18)
        for frame, part in zip(self._tracked, _PARTS, strict=True):
            J[part], bias[part] = self._differential(context, frame)
        V = J @ v
        for array in (J, bias, V):  # Parts of them are read-only as well.
            array.setflags(write=False)
        tracked = [
            self._frame_terms(context, frame, V[part], J[part], bias[part])
            for frame, part in zip(self._tracked, _PARTS, strict=True)
        ]
        left, right, chest = tracked
        X_WP = plant.EvalBodyPoseInWorld(context, self._pelvis)
        R_WP, p_WP = X_WP.rotation().matrix(), X_WP.translation()
        pelvis = FrameTerms(p_WP, R_WP, v[:6], self._pelvis_jacobian, _NO_BIAS)
        q = state.take(indices.q)
        com = plant.CalcCenterOfMassPositionInWorld(context)
        mass = self.robot.mass + float(loads.sum())
        com_velocity = (M[3:6] @ v) / mass
        for array in (q, M, h, R_WP, p_WP, com, com_velocity, pull):
            array.setflags(write=False)
        return WholeBodyTerms(
            mass=mass,
            q=q,
            v=v[6:],
            M=M,
            h=h,
            R_WP=R_WP,
            p_WP=p_WP,
            V_WP=v[:6],
            R_WC=chest.R_WF,
            w_WC=chest.V_WF[:3],
            com=com,
            com_velocity=com_velocity,
            pull=pull,
            feet=(left, right),
            frames=dict(zip(self._names, [*tracked, pelvis], strict=True)),
            compute_frame=compute_frame,
        )

    def _carry(self, context: Context, loads: np.ndarray) -> None:
        """Puts loads into the hands of a scratch context, as point masses."""
        for hand, load in zip(self._hands, loads.tolist(), strict=False):
            if hand.get_mass(context) != hand.default_mass() + load:
                # A copy: adding would change the body's own.
                inertia = copy.copy(hand.default_spatial_inertia())
                at = inertia.get_com()
                inertia += SpatialInertia(load, at, UnitInertia.PointMass(at))
                hand.SetSpatialInertiaInBodyFrame(context, inertia)

    def _pull(
        self, context: Context, loads: np.ndarray, wrenches: np.ndarray, h: np.ndarray
    ) -> np.ndarray:
        """Takes the wrenches on the hands into ``h``; returns their sum about W.

        The weight of the loads is there already.
        """
        pull = np.zeros(6)
        for hand, load, felt in zip(self._hands, loads, wrenches, strict=True):
            J, _ = self._differential(context, hand.body_frame())
            X_WH, wrench = hand.EvalPoseInWorld(context), felt.copy()
            lift = np.array([0.0, 0.0, GRAVITY * float(load)])
            at = X_WH.rotation() @ hand.default_com()
            wrench += np.concatenate([cross(at, lift), lift])
            h -= J.T @ wrench
            shift_wrench(wrench, -X_WH.translation())
            pull += wrench
        return pull

    def _frame(self, name: str) -> Frame:
        """The plant's frame of this name."""
        plant = self._plant
        if not plant.HasFrameNamed(name):
            known = [
                plant.get_frame(FrameIndex(i)).name() for i in range(plant.num_frames())
            ]
            raise RobotDescriptionError(
                "frame",
                name,
                f"robot '{self.robot.name}' has no frame {shown(name)}."
                + did_you_mean(name, known),
            )
        return plant.GetFrameByName(name)

    def _differential(
        self, context: Context, frame: Frame
    ) -> tuple[np.ndarray, np.ndarray]:
        """Spatial Jacobian and J̇·v of a frame's origin in W, message order."""
        plant, world = self._plant, self._world
        J = plant.CalcJacobianSpatialVelocity(
            context, JacobianWrtVariable.kV, frame, _ORIGIN, world, world
        )
        bias = plant.CalcBiasSpatialAcceleration(
            context, JacobianWrtVariable.kV, frame, _ORIGIN, world, world
        )
        return J.T.take(self._indices.generalized, axis=0).T, bias.get_coeffs()

    def _frame_terms(
        self,
        context: Context,
        frame: Frame,
        V_WF: np.ndarray,
        J_WF: np.ndarray,
        bias: np.ndarray,
    ) -> FrameTerms:
        """A frame's differential kinematics, read-only, together with its pose."""
        X_WF = frame.CalcPoseInWorld(context)
        p_WF, R_WF = X_WF.translation(), X_WF.rotation().matrix()
        p_WF.setflags(write=False)
        R_WF.setflags(write=False)
        return FrameTerms(p_WF, R_WF, V_WF, J_WF, bias)


def standing_terms(robot: Robot) -> WholeBodyTerms:
    """Evaluates the model of a robot at rest in its stand-prep pose."""
    model, standing = WholeBodyModel(robot), robot.standing_context()
    state = robot.plant.GetPositionsAndVelocities(standing)
    return model.evaluate(model.create_context(), state)
