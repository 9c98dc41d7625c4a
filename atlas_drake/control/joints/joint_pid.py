"""Control law of the joints: PID with velocity gain and feed-forward, per joint.

The damping is implicit, after Tan, Liu, Turk, "Stable proportional-derivative
controllers", IEEE Computer Graphics and Applications 2011; ``user_effort`` adds motors
that saturate and joints that the user shares with the behavior. The constants are no
settings: they are bounds of stability and numerical tolerances of the law at the
physics steps that are offered; the gains are the user's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.systems.framework import Context

from atlas_drake.control.whole_body.quadratic_program import (
    INEQUALITY,
    QuadraticProgram,
    solve,
)
from atlas_drake.frozen import replace
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.robot import Robot


@dataclass(frozen=True)
class PidState:
    """State of the law; arrays (n,)."""

    integral: np.ndarray  # Integral of the position error times its gain [N·m]
    velocity: np.ndarray  # Velocity at the last step [rad/s]
    applied: np.ndarray  # Effort of the motors in the last step, limited [N·m]
    expected: np.ndarray  # Change of velocity expected in the last step [rad/s]
    static: np.ndarray  # ``static_effort`` of the last step [N·m]


def within_limits(
    command: JointCommand, lower: np.ndarray, upper: np.ndarray
) -> JointCommand:
    """Clamps set-points to the joints' limits, positions [rad], shape (n,).

    A set-point at a limit, or beyond it, has no velocity outward either, which would
    drive the joint into its stop.
    """
    at_lower, at_upper = command.position <= lower, command.position >= upper
    velocity = np.clip(
        command.velocity,
        np.where(at_lower, 0.0, -np.inf),
        np.where(at_upper, 0.0, np.inf),
    )
    position = np.clip(command.position, lower, upper)
    return replace(command, position=position, velocity=velocity)


def integrate(
    state: PidState, command: JointCommand, q: np.ndarray, active: np.ndarray, dt: float
) -> np.ndarray:
    """Advances the integral term by one step, within its clamps [N·m], shape (n,).

    The term is constant where ``active`` is False, and cannot wind up beyond its
    clamps.
    """
    grown = state.integral + command.ki_position * (command.position - q) * dt
    clamped = np.minimum(np.maximum(grown, command.i_effort_min), command.i_effort_max)
    return np.where(active, clamped, state.integral)


def static_effort(
    command: JointCommand, integral: np.ndarray, q: np.ndarray
) -> np.ndarray:
    """Computes the terms of the law that do not depend on velocity [N·m], (n,)."""
    return (
        command.kp_position * (command.position - q)
        + integral
        + command.kp_velocity * command.velocity
        + command.effort
    )


DRIFT_TIME = 0.001
"""Time constant of the estimate of velocity changes not caused by the motors [s]."""

LAGGING_STIFFNESS = 0.5
"""Greatest stiffness that may answer with the estimate's delay, over the one at which
a joint far heavier than in the model begins to oscillate [-]."""

PROMPT_STIFFNESS = 0.5
"""Greatest stiffness that may act without that delay, in units of I/h² with the model's
inertia I [-]. A joint as light as in the model diverges from 1 on, one lighter by 15 %
from 0.6 on."""

MAX_CHANGE = 10.0
"""Largest change of a joint's static effort in a step that may act without that delay,
over the one that its own motion causes [-]. A set-point that is sent every few steps
moves in jumps of several; one that jumps while the joint rests is answered with
damping."""

LIGHT_DAMPING = 1e-3
"""Greatest damping that is taken explicitly where motors saturate [N·m·s/rad].

It is far below the bound of stability, which for the lightest joint is 1 at 2 ms.
"""

ROUNDING = 1e-9
"""Distance from the effort limit, as a share of it, within which a motor counts as
saturated [-]."""


@dataclass(frozen=True)
class StepModel:
    """Response of the velocities to efforts within a step."""

    response: np.ndarray  # h·Λ, velocity change per effort [rad/s per N·m], (n, n)
    damping: np.ndarray  # Sum d of all gains on velocity [N·m·s/rad], shape (n,)
    share: np.ndarray  # Blend weight k of the user for each joint, 0 to 1, shape (n,)
    gain: np.ndarray  # G = (1 + D·h·Λ·K)⁻¹, shape (n, n)
    blend: float  # Weight b of a new change of velocity in the estimate [-]
    prompt: np.ndarray  # k times the part of a static effort that acts at once, (n,)
    stiffness: np.ndarray  # h·kp, static effort per velocity [N·m·s/rad], (n,)


def step_model(
    stiffness: np.ndarray,
    damping: np.ndarray,
    share: np.ndarray,
    inverse_mass: np.ndarray,
    dt: float,
) -> StepModel:
    """Makes the model of the robot that ``user_effort`` needs.

    The gains are kp [N·m/rad] and the sum d of all gains on velocity [N·m·s/rad].
    """
    response = dt * inverse_mass
    coupling = damping[:, None] * (response * share)
    coupling.reshape(-1)[:: len(damping) + 1] += 1.0
    gain = np.linalg.inv(coupling)
    blend = dt / (dt + DRIFT_TIME)
    # Change of the static effort in a step, per velocity, and what the user's share of
    # it does to the velocity of a joint as light as in the model.
    change = dt * stiffness
    yields = share * change * response.diagonal()
    part = np.clip(yields - LAGGING_STIFFNESS * blend, 0.0, PROMPT_STIFFNESS)
    prompt = share * np.divide(part, yields, out=np.zeros_like(part), where=part > 0.0)
    return StepModel(response, damping, share, gain, blend, prompt, change)


def change_without_user(
    state: PidState,
    static: np.ndarray,
    v: np.ndarray,
    others: np.ndarray,
    model: StepModel,
) -> np.ndarray:
    """Predicts the change of velocity in this step without the user's effort, (n,).

    Gravity, contact and the motion of the body cause the part of the last change of
    velocity that the motors do not explain. The estimate is smoothed: an unsmoothed
    estimate answers every jolt twice. The smoothed quantity is the whole change of
    velocity, which is continuous when the model changes. The unexplained part is not:
    under the old model it belongs to efforts many times as large, so that smoothing it
    would cause a jolt at each change of the model.

    A foot that stands is thousands of times as heavy as in the model, in which no sole
    touches the ground. It does not yield, and the estimate needs about d·h·Λ/b steps to
    attribute that to the ground: the law is right, but late. Late damping is still
    damping; late stiffness drives an oscillation if kp·h²·Λ exceeds b. Of such a
    stiffness a part is taken to be balanced by whatever keeps the joint from yielding:
    its change acts at once, as in the explicit law (``StepModel.prompt``).

    ``others`` is the behavior's part of the motors' efforts (1 - K)·τ_behavior [N·m].
    """
    change = state.expected + model.blend * (v - state.velocity - state.expected)
    most = MAX_CHANGE * model.stiffness * np.abs(v)
    balanced = np.minimum(np.maximum(static - state.static, -most), most)
    return change + model.response @ (others - state.applied - model.prompt * balanced)


def user_effort(
    static: np.ndarray,
    coasting: np.ndarray,
    others: np.ndarray,
    model: StepModel,
    effort_limit: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Computes the law with implicit damping, and the resulting effort of the motors.

    An explicit torque -d·v at step h diverges when d·h exceeds twice the inertia of
    the joint, as it does with the tutorial's own gains at the wrists. The implicit law
    damps the velocity at the end of the step,

        v⁺ = v_c + h·Λ·K·τ,

    where v_c is the velocity without the user's efforts:

        τ = τ_static - D·v⁺   ⇒   τ = G·(τ_static - D·v_c),   G = (1 + D·h·Λ·K)⁻¹

    When joints move steadily v⁺ equals v, and this is the explicit law: set-points and
    gravity droop follow from the gains for any step. The scalar loop is stable for any
    damping as long as Λ is not below 3/4 of the true inverse mass matrix; it may be any
    number of times as large (``change_without_user``).

    A motor gives the blend of both efforts within its limit. Where a motor saturates,
    v⁺ changes for all joints, and ``_saturated`` computes it.

    ``static`` is τ_static [N·m]; ``coasting`` is v_c, the velocities and
    ``change_without_user`` together [rad/s]; ``others`` is the behavior's part of the
    motors' efforts [N·m]. Returns the user's effort τ, not limited, and the motors'
    effort, limited for all joints with a user share above 0 [N·m].
    """
    effort = model.gain @ (static - model.damping * coasting)
    total = others + model.share * effort
    if not ((np.abs(total) > effort_limit) & (model.share > 0.0)).any():
        return effort, total
    return _saturated(static, coasting, others, model, effort_limit)


def _saturated(
    static: np.ndarray,
    coasting: np.ndarray,
    others: np.ndarray,
    model: StepModel,
    effort_limit: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Computes ``user_effort`` if a motor reaches its limit L.

    With v_0 the velocities without any motor, the motors' efforts solve

        t = clamp(K·τ_static + others - E·(v_0 + h·Λ·t), ±L),   E = K·D,

    that is, t minimises ½ tᵀ(E⁻¹ + h·Λ)t + tᵀ(v_0 - E⁻¹(K·τ_static + others))
    within ±L: a strictly convex program, with exactly one solution for any gains. It is
    solved by an active-set method to rounding; a joint within 1e-4 N·m of its limit
    may count as either. Arguments and result are those of ``user_effort``.
    """
    share, response = model.share, model.response
    idle = coasting - response @ others
    damping = share * model.damping
    desired = share * static + others
    total = np.clip(desired - damping * coasting, -effort_limit, effort_limit)
    damped = np.flatnonzero(damping > LIGHT_DAMPING)
    total[damped] = 0.0
    total[damped] = _saturated_damped(
        desired[damped],
        (idle + response @ total)[damped],
        damping[damped],
        response[np.ix_(damped, damped)],
        effort_limit[damped],
    )
    effort = static - model.damping * (idle + response @ total)
    # The same effort for a motor within its limit, without the rounding error of a
    # large damping.
    within = (np.abs(total) < effort_limit) & (share > 0.0)
    effort[within] = (total - others)[within] / share[within]
    return effort, total


def _saturated_damped(
    desired: np.ndarray,
    idle: np.ndarray,
    damping: np.ndarray,
    response: np.ndarray,
    limit: np.ndarray,
) -> np.ndarray:
    """Solves the program of ``_saturated`` for damped joints: efforts t [N·m], (m,).

    The arguments are K·τ_static + others, v_0, E, h·Λ and L.
    """
    # Efforts beyond all that the damping can compensate are equivalent; a smaller one
    # keeps the solver accurate.
    beyond = limit + damping * (np.abs(idle) + np.abs(response) @ limit + 1.0)
    desired = np.clip(desired, -beyond, beyond)
    # In units in which the Hessian's diagonal is 1.
    unit = 1.0 / np.sqrt(1.0 / damping + response.diagonal())
    H = unit[:, None] * response * unit
    H.reshape(-1)[:: len(unit) + 1] = 1.0
    program = QuadraticProgram(
        H=H,
        f=unit * (idle - desired / damping),
        A=np.zeros((0, len(unit))),
        lower=-limit / unit,
        upper=limit / unit,
        kind=np.full(len(unit), INEQUALITY, dtype=np.int32),
    )
    effort = unit * solve(program).x
    # Exact to the bit: rounding must not decide if a motor is at its limit.
    at_limit = np.abs(effort) >= limit * (1.0 - ROUNDING)
    return np.where(at_limit, np.sign(effort) * limit, effort)


class InverseMass:
    """The joints' block of M⁻¹, the pelvis free and no sole on the ground.

    The ground makes joints heavier than they are here, never lighter, and the law
    tolerates that. It holds no state.
    """

    def __init__(self, robot: Robot):
        # Untyped, because pydrake's stubs misname the type of every array.
        self._plant: Any = robot.plant
        indices = robot.indices(self._plant)
        self._block = np.ix_(indices.v, indices.v)

    def create_context(self) -> Context:
        """Creates a scratch context for ``evaluate``."""
        return self._plant.CreateDefaultContext()

    def evaluate(self, context: Context, positions: np.ndarray) -> np.ndarray:
        """Computes Λ, joint accelerations per effort [rad/s² per N·m], shape (n, n).

        Overwrites the scratch context; ``positions`` are in plant order.
        """
        self._plant.SetPositions(context, positions)
        return np.linalg.inv(self._plant.CalcMassMatrix(context))[self._block]
