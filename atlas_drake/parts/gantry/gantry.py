"""A gantry that carries the pelvis until it is released, as a crane carries a robot.

The gantry applies the forces of springs and dampers; nothing is welded and no position
is set. The dampers are integrated implicitly, see ``implicit_pull``. A station has a
gantry only if the scenario requests it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import Frame, JacobianWrtVariable, MultibodyForces
from pydrake.systems.framework import Context

from atlas_drake.config import Configuration, NotNegative, Positive
from atlas_drake.control.joints.blend import limited
from atlas_drake.control.joints.joint_pid import MotorLaw
from atlas_drake.frozen import Frozen, replace
from atlas_drake.robot import Robot
from atlas_drake.rotations import rotation_error
from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.units import (
    GRAVITY,
    MetersPerSecond,
    NewtonMeterSecondsPerRadian,
    NewtonMetersPerRadian,
    RadiansPerSecond,
    Ratio,
    Seconds,
)


@dataclass(frozen=True)
class GantryGains(Configuration):
    """Gains that hold the robot; the defaults are stable at every physics step."""

    natural_frequency: Positive[RadiansPerSecond] = 12.0
    """Natural frequency of the robot's mass on the gantry."""
    damping_ratio: NotNegative[Ratio] = 1.0
    """Damping ratio of the robot's mass on the gantry."""
    rotational_stiffness: NotNegative[NewtonMetersPerRadian] = 4000.0
    """Rotational stiffness at the pelvis."""
    rotational_damping: NotNegative[NewtonMeterSecondsPerRadian] = 300.0
    """Rotational damping at the pelvis."""
    lowering_speed: Positive[MetersPerSecond] = 0.10
    """Speed at which a released robot is lowered."""
    fading_time: Positive[Seconds] = 1.0
    """Time in which the gantry transfers its load to the legs after lowering."""


@dataclass(frozen=True)
class GantryState(Frozen):
    """Pose in which the pelvis is held; None for a slack gantry."""

    p_WH: np.ndarray | None = None  # [m], shape (3,).
    R_WH: np.ndarray | None = None
    drop: float = 0.0  # By which the robot is lowered until its feet can stand [m].
    released: float | None = None  # Time of release [s], which may be in the future.


class Gantry(CollectableSystem):
    """State and external forces in, external forces with that of the gantry out.

    Input ports:
        state: Positions and velocities of the robot.
        actuation: Efforts of the motors without the springs and dampers of the user's
            law, in the order of the actuators [N·m].
        motor_law: ``MotorLaw``, those springs and dampers.
        foot_wrenches: Wrenches of the ground on the soles [N·m; N], shape (12,).
        other_spatial_force: List of ``ExternallyAppliedSpatialForce``; optional.

    Output ports:
        applied_spatial_force: The list of ``other_spatial_force`` with the force of the
            gantry on the pelvis.
        gantry: ``GantryState``.
    """

    __slots__ = ()

    def __init__(
        self, robot: Robot, plant: MultibodyPlant, gains: GantryGains | None = None
    ):
        """Holds ``robot`` in ``plant``, a discrete one."""
        super().__init__()
        self._gains = gains or GantryGains()
        self._mass = robot.mass
        # Untyped, because pydrake's stubs misname the type of every array.
        self._plant: Any = plant
        self._dt = plant.time_step()
        # The pelvis is the free body: its spatial velocity is among the plant's.
        self._instance = own = robot.instance(plant)
        places = np.arange(plant.num_velocities(), dtype=float)
        in_plant = plant.GetVelocitiesFromArray(own, places).astype(int)
        self._indices = indices = robot.indices(plant)
        self._base = in_plant[indices.generalized[:6]]
        self._joints = in_plant[indices.v]
        self._in_state = plant.num_positions(own)
        self._limit = robot.effort_limit
        self._soles = robot.soles(plant)
        # An index, because a body holds its plant where the garbage collector cannot
        # see it.
        self._pelvis = plant.GetBodyByName(robot.file.pelvis, own).index()
        self._state_input = self.DeclareVectorInputPort(
            "state", plant.num_multibody_states(own)
        )
        self._actuation_input = self.DeclareVectorInputPort(
            "actuation", robot.num_joints
        )
        self._law_input = self.declare_value_input("motor_law")
        self._wrench_input = self.DeclareVectorInputPort("foot_wrenches", 12)
        no_forces = AbstractValue.Make([ExternallyAppliedSpatialForce()])
        self._others = self.DeclareAbstractInputPort("other_spatial_force", no_forces)
        self._scratch = self.declare_scratch_context(plant.CreateDefaultContext)
        self._state = self.declare_value_state(GantryState(), "gantry")
        self.DeclareAbstractOutputPort(
            "applied_spatial_force", no_forces.Clone, self._calc_forces
        )

    def hold(
        self,
        context: Context,
        p_WH: np.ndarray,
        R_WH: np.ndarray,
        drop: float,
        released: float | None = None,
    ) -> None:
        """Holds the pelvis from now on, see ``GantryState``."""
        self._state.set(context, GantryState(p_WH.copy(), R_WH.copy(), drop, released))

    def release(self, context: Context) -> None:
        """Lowers the robot and then unloads the gantry; no effect if it is slack."""
        state, now = self.state(context), context.get_time()
        if state.p_WH is not None and (state.released is None or state.released > now):
            self._state.set(context, replace(state, released=now))

    def let_go(self, context: Context) -> None:
        """Makes the gantry slack from now on."""
        self._state.set(context, GantryState())

    def state(self, context: Context) -> GantryState:
        """Returns the state of the gantry."""
        return self._state.get(context)

    def _calc_forces(self, context: Context, output: AbstractValue) -> None:
        forces = self._others.Eval(context) if self._others.HasValue(context) else []
        own = self._pull(context, forces)
        output.set_value([*forces, own] if own is not None else forces)

    def _pull(
        self, context: Context, others: Sequence[ExternallyAppliedSpatialForce]
    ) -> ExternallyAppliedSpatialForce | None:
        """Computes the force of the gantry on the pelvis; None if it is slack."""
        state, gains = self.state(context), self._gains
        if state.p_WH is None or state.R_WH is None:
            return None
        lowered, strength = 0.0, 1.0
        if state.released is not None:
            since = max(context.get_time() - state.released, 0.0)
            lowered = min(gains.lowering_speed * since, state.drop)
            fading = since - state.drop / gains.lowering_speed
            strength = 1.0 - max(fading, 0.0) / gains.fading_time
            if strength <= 0.0:
                return None
        scratch = self._scratch.Eval(context)
        self._plant.SetPositionsAndVelocities(
            scratch, self._instance, self._state_input.Eval(context)
        )
        pelvis = self._plant.get_body(self._pelvis)
        X_WP = self._plant.EvalBodyPoseInWorld(scratch, pelvis)
        V_WP = self._plant.EvalBodySpatialVelocityInWorld(scratch, pelvis)
        w = gains.natural_frequency
        away = state.p_WH - np.array([0.0, 0.0, lowered]) - X_WP.translation()
        error = rotation_error(state.R_WH, X_WP.rotation().matrix())
        static = np.concatenate(
            [gains.rotational_stiffness * error, self._mass * w * w * away]
        )
        static[5] += self._mass * GRAVITY
        damping = np.repeat(
            [gains.rotational_damping, 2.0 * gains.damping_ratio * w * self._mass], 3
        )
        acceleration, inverse_mass = self._free_motion(context, scratch, others)
        pull = implicit_pull(
            strength * static,
            strength * damping,
            V_WP.get_coeffs() + self._dt * acceleration,
            self._dt * inverse_mass,
        )
        force = ExternallyAppliedSpatialForce()
        force.body_index = self._pelvis
        force.F_Bq_W = SpatialForce(pull[:3], pull[3:])
        return force

    def _free_motion(
        self,
        context: Context,
        scratch: Context,
        others: Sequence[ExternallyAppliedSpatialForce],
    ) -> tuple[np.ndarray, np.ndarray]:
        """Computes the pelvis' acceleration without the gantry, and Λ; spatial, in W.

        Contact forces are those of the last control tick; joint friction is neglected.
        """
        plant = self._plant
        inside = MultibodyForces(plant)
        plant.CalcForceElementsContribution(scratch, inside)
        rest = np.zeros(plant.num_velocities())
        force = -plant.CalcInverseDynamics(scratch, rest, inside)
        effort, damping = self._motors(context)
        force[self._joints] += effort
        mass = plant.CalcMassMatrix(scratch)
        mass[self._joints, self._joints] += self._dt * damping
        wrenches = self._wrench_input.Eval(context)
        for sole, wrench in zip(self._soles, wrenches.reshape(2, 6), strict=True):
            if wrench.any():
                J = self._jacobian(scratch, plant.get_frame(sole), np.zeros(3))
                force += J.T @ wrench
        for other in others:
            frame = plant.get_body(other.body_index).body_frame()
            J = self._jacobian(scratch, frame, other.p_BoBq_B)
            force += J.T @ other.F_Bq_W.get_coeffs()
        given = np.column_stack([force, np.eye(len(force))[:, self._base]])
        answer = np.linalg.solve(mass, given)[self._base]
        return answer[:, 0], answer[:, 1:]

    def _motors(self, context: Context) -> tuple[np.ndarray, np.ndarray]:
        """Computes the motors' efforts at the present velocity, and their damping.

        Both in message order, [N·m] and [N·m·s/rad]; a motor at its limit does not
        damp. As Drake's solver has it, springs act on the position after the step.
        """
        law: MotorLaw = self._law_input.Eval(context)
        state, indices = self._state_input.Eval(context), self._indices
        q, v = state[indices.q], state[self._in_state + indices.v]
        damping = law.damping + self._dt * law.stiffness
        given = self._actuation_input.Eval(context)[indices.actuation]
        effort = given + law.stiffness * (law.position - q) - damping * v
        within = limited(effort, self._limit)
        return within, np.where(within == effort, damping, 0.0)

    def _jacobian(self, scratch: Context, frame: Frame, p: np.ndarray) -> np.ndarray:
        """Computes the Jacobian of a frame's point, spatial, in W, shape (6, nv)."""
        world = self._plant.world_frame()
        return self._plant.CalcJacobianSpatialVelocity(
            scratch, JacobianWrtVariable.kV, frame, p, world, world
        )


def implicit_pull(
    static: np.ndarray, damping: np.ndarray, free: np.ndarray, response: np.ndarray
) -> np.ndarray:
    """Computes spring and damper forces with the velocity at the end of the step.

    The pelvis alone, with free joints, has 0.2 kg·m²: an explicit damper of
    300 N·m·s/rad diverges at a step of 2 ms, and at 1 ms with damped joints. So with
    V⁺ = V_free + h·Λ·F,

        F = F_static - D·V⁺   ⇒   F = (1 + D·h·Λ)⁻¹·(F_static - D·V_free)

    F_static is the force without the dampers [N·m; N], D their coefficients [N·m·s/rad;
    N·s/m], h·Λ the change of velocity per force, shape (6, 6). V_free has to contain
    the effect of the motors in the step, and Λ that of their damping: joint damping of
    similar stiffness would be unstable with a damper on the pelvis' present velocity.
    """
    return np.linalg.solve(
        np.eye(6) + damping[:, None] * response, static - damping * free
    )
