"""The joint controllers' law: PID with velocity gain and feed-forward, per joint.

Pure. What makes it stable for any damping gain at any step is in ``user_effort``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.whole_body.quadratic_program import (
    INEQUALITY,
    QuadraticProgram,
    solve,
)
from atlas_drake.messages.joint_command import JointCommand


@dataclass(frozen=True)
class PidState:
    """What the law remembers; arrays (n,).

    Attributes:
        integral: Of the position error times its gain [N·m].
        velocity: At the last step [rad/s].
        applied: Effort that the motors gave in the last step, within their limits
            [N·m].
        expected: How much the velocity was expected to change in the last step, by
            the motors and by all other forces [rad/s].
    """

    integral: np.ndarray
    velocity: np.ndarray
    applied: np.ndarray
    expected: np.ndarray


def integrate(
    state: PidState, command: JointCommand, q: np.ndarray, active: np.ndarray, dt: float
) -> np.ndarray:
    """The integral term after a step, within its clamps [N·m], shape (n,).

    It holds still where ``active`` is False, and cannot wind up beyond its clamps.
    """
    grown = state.integral + command.ki_position * (command.position - q) * dt
    clamped = np.minimum(np.maximum(grown, command.i_effort_min), command.i_effort_max)
    return np.where(active, clamped, state.integral)


def static_effort(
    command: JointCommand, integral: np.ndarray, q: np.ndarray
) -> np.ndarray:
    """All of the law but what depends on the joint's velocity [N·m], shape (n,)."""
    return (
        command.kp_position * (command.position - q)
        + integral
        + command.kp_velocity * command.velocity
        + command.effort
    )


DRIFT_TIME = 0.002
"""Time in which the estimate of what is not the motors' doing follows it [s]."""

LIGHT_DAMPING = 1e-3
"""Where motors saturate, no more than this is taken explicitly [N·m·s/rad].

It is far from the bound of stability, which for the lightest joint is 1 at 2 ms.
"""

ROUNDING = 1e-9
"""A motor that lacks no more than this share of its limit is at it [-]."""


@dataclass(frozen=True)
class StepModel:
    """How velocities respond to efforts within a step.

    Attributes:
        response: h·Λ, velocity change per effort [rad/s per N·m], shape (n, n).
        damping: d, all gains on velocity together [N·m·s/rad], shape (n,).
        share: The user's share k of each joint, 0 to 1, shape (n,).
        gain: G = (1 + D·h·Λ·K)⁻¹, shape (n, n).
        blend: How much of a new change of velocity enters the estimate [-].
    """

    response: np.ndarray
    damping: np.ndarray
    share: np.ndarray
    gain: np.ndarray
    blend: float


def step_model(
    damping: np.ndarray, share: np.ndarray, inverse_mass: np.ndarray, dt: float
) -> StepModel:
    """What ``user_effort`` needs to know of the robot.

    Args:
        damping: All gains on velocity together d [N·m·s/rad], shape (n,).
        share: The user's share k of each joint, 0 to 1.
        inverse_mass: Λ, accelerations per effort [rad/s² per N·m], shape (n, n).
        dt: The step h [s].
    """
    response = dt * inverse_mass
    coupling = damping[:, None] * (response * share)
    coupling.reshape(-1)[:: len(damping) + 1] += 1.0
    gain = np.linalg.inv(coupling)
    return StepModel(response, damping, share, gain, dt / (dt + DRIFT_TIME))


def change_without_user(
    state: PidState, v: np.ndarray, others: np.ndarray, model: StepModel
) -> np.ndarray:
    """How velocities would change in this step by all but the user [rad/s], (n,).

    Gravity, contact and the body's own motion are the part of the last change of
    velocity that the motors do not explain, smoothed: an unsmoothed estimate answers
    every jolt twice, and rings. What is smoothed is the whole change, which stays what
    it was when the model becomes another one, such as that of a foot in the air: a
    drift remembered from the old one would belong to efforts many times as large, and
    each change of the model would be a jolt.

    Args:
        state: Of the last step.
        v: Velocities [rad/s].
        others: The behavior's part of the motors' efforts (1 - K)·τ_behavior [N·m].
        model: From ``step_model``.
    """
    change = state.expected + model.blend * (v - state.velocity - state.expected)
    return change + model.response @ (others - state.applied)


def user_effort(
    static: np.ndarray,
    coasting: np.ndarray,
    others: np.ndarray,
    model: StepModel,
    effort_limit: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """The law with its damping taken implicitly, and what the motors then give.

    An explicit torque -d·v at step h diverges when d·h exceeds twice the inertia of
    the joint, which the tutorial's own gains do at the wrists. The implicit law asks
    for the damping of the velocity at the step's end,

        v⁺ = v_c + h·Λ·K·τ,

    where v_c is what it would be without the user's efforts:

        τ = τ_static - D·v⁺   ⇒   τ = G·(τ_static - D·v_c),   G = (1 + D·h·Λ·K)⁻¹

    When joints move steadily v⁺ is v, and this is the law itself: set-points and
    gravity droop are those of the gains, whatever the step. The scalar loop is stable
    for any damping as long as Λ is not below 3/4 of the true inverse mass matrix.

    A motor gives the blend of both efforts within its limit. Where that limit cuts, v⁺
    is another one for all joints, and ``_saturated`` finds it.

    Args:
        static: The law without its velocity terms, ``static_effort`` [N·m].
        coasting: v_c, velocities and ``change_without_user`` together [rad/s].
        others: The behavior's part of the motors' efforts (1 - K)·τ_behavior [N·m].
        model: From ``step_model``.
        effort_limit: [N·m]

    Returns:
        The user's effort τ, not limited, and the motors' effort, within the limits of
        all joints that the user has a share of [N·m], shapes (n,).
    """
    effort = model.gain @ (static - model.damping * coasting)
    total = others + model.share * effort
    exceeds = np.abs(total) > effort_limit
    if not (exceeds.any() and exceeds[model.share > 0.0].any()):
        return effort, total
    return _saturated(static, coasting, others, model, effort_limit)


def _saturated(
    static: np.ndarray,
    coasting: np.ndarray,
    others: np.ndarray,
    model: StepModel,
    effort_limit: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """``user_effort`` where a motor reaches its limit L.

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
    wanted = share * static + others
    total = np.clip(wanted - damping * coasting, -effort_limit, effort_limit)
    damped = np.flatnonzero(damping > LIGHT_DAMPING)
    total[damped] = 0.0
    total[damped] = _saturated_damped(
        wanted[damped],
        (idle + response @ total)[damped],
        damping[damped],
        response[np.ix_(damped, damped)],
        effort_limit[damped],
    )
    effort = static - model.damping * (idle + response @ total)
    # The same for a motor within its limit, without the rounding of a large damping.
    within = (np.abs(total) < effort_limit) & (share > 0.0)
    effort[within] = (total - others)[within] / share[within]
    return effort, total


def _saturated_damped(
    wanted: np.ndarray,
    idle: np.ndarray,
    damping: np.ndarray,
    response: np.ndarray,
    limit: np.ndarray,
) -> np.ndarray:
    """The program of ``_saturated`` for damped joints; arrays (m,) and (m, m).

    Args:
        wanted: K·τ_static + others [N·m].
        idle: v_0 [rad/s].
        damping: E, positive [N·m·s/rad].
        response: h·Λ [rad/s per N·m].
        limit: L [N·m]

    Returns:
        Efforts t [N·m].
    """
    # An effort beyond all that the damping can take back is as good as any larger one,
    # which could cost the solver its digits.
    beyond = limit + damping * (np.abs(idle) + np.abs(response) @ limit + 1.0)
    wanted = np.clip(wanted, -beyond, beyond)
    # In units in which the Hessian's diagonal is 1.
    unit = 1.0 / np.sqrt(1.0 / damping + response.diagonal())
    H = unit[:, None] * response * unit
    H.reshape(-1)[:: len(unit) + 1] = 1.0
    program = QuadraticProgram(
        H=H,
        f=unit * (idle - wanted / damping),
        A=np.zeros((0, len(unit))),
        lower=-limit / unit,
        upper=limit / unit,
        kind=np.full(len(unit), INEQUALITY, dtype=np.int32),
    )
    effort = unit * solve(program).x
    # To the bit: whether a motor is at its limit must not be a matter of rounding.
    at_limit = np.abs(effort) >= limit * (1.0 - ROUNDING)
    return np.where(at_limit, np.sign(effort) * limit, effort)
