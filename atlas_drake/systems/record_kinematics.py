"""What records compute from a state: soles, contact wrenches, CoM, DCM and CoP."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.systems.framework import Context

from atlas_drake.control.balance.feedback import pendulum_frequency
from atlas_drake.control.wrenches import center_of_pressure, shift_to_frames
from atlas_drake.frozen import read_only
from atlas_drake.messages.controller_status import Plan
from atlas_drake.records.groups import Balance, Feet, Hands
from atlas_drake.robot import Robot


class RecordKinematics:
    """Kinematics on the model of the robot alone. The caller owns the contexts."""

    def __init__(self, robot: Robot) -> None:
        """Takes the frames of soles and hands."""
        # Untyped, because pydrake's stubs misname the type of every array.
        self._model: Any = robot.plant
        self._soles = robot.soles(self._model)
        hands = [self._model.GetBodyByName(name) for name in robot.file.hands]
        self._touching = [*self._soles, *(body.body_frame().index() for body in hands)]

    def feet_and_hands(
        self,
        scratch: Context,
        state: np.ndarray,
        measured: np.ndarray,
        contact_wrenches: np.ndarray,
    ) -> tuple[Feet, Hands]:
        """Computes poses of the soles as measured, and true wrenches on feet and hands.

        ``contact_wrenches`` are about W's origin [N·m; N], shape (24,); ``scratch`` has
        the measured state afterwards.
        """
        wrenches = contact_wrenches.reshape(4, 6).copy()
        self._model.SetPositionsAndVelocities(scratch, state)
        frames = map(self._model.get_frame, self._touching)
        shift_to_frames(wrenches, frames, scratch)
        if not np.array_equal(state, measured):
            self._model.SetPositionsAndVelocities(scratch, measured)
        left, right = (
            self._model.get_frame(sole).CalcPoseInWorld(scratch) for sole in self._soles
        )
        torques, forces = wrenches[:, :3], wrenches[:, 3:]
        feet = Feet(
            left_position=left.translation(),
            left_orientation=left.rotation().ToQuaternion().wxyz(),
            right_position=right.translation(),
            right_orientation=right.rotation().ToQuaternion().wxyz(),
            left_torque=torques[0],
            left_force=forces[0],
            right_torque=torques[1],
            right_force=forces[1],
        )
        return read_only((feet, Hands(torques[2], forces[2], torques[3], forces[3])))

    def balance(self, scratch: Context, feet: Feet, plan: Plan) -> Balance:
        """Computes CoM, DCM and CoP at the state of the model, in ``scratch``.

        The plan's natural frequency defines the DCM.
        """
        com = self._model.CalcCenterOfMassPositionInWorld(scratch)
        velocity = self._model.CalcCenterOfMassTranslationalVelocityInWorld(scratch)
        omega = plan.omega
        if omega is None:
            ground = 0.5 * sum(float(p_WF[2]) for p_WF in feet.positions)
            omega = pendulum_frequency(float(com[2]) - ground)
        wrenches = np.concatenate(
            [feet.left_torque, feet.left_force, feet.right_torque, feet.right_force]
        )
        cop = center_of_pressure(feet.positions, wrenches)
        balance = Balance(
            com=com,
            com_velocity=velocity,
            dcm=com[:2] + velocity[:2] / omega,
            cop=None if cop is None else cop[:2],
            cmp=plan.cmp,
            com_reference=plan.com_reference,
            dcm_reference=plan.dcm_reference,
            cop_reference=plan.cop_reference,
            cmp_reference=plan.cmp_reference,
            support=plan.support,
            omega=plan.omega,
        )
        return read_only(balance)
