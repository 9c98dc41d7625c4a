"""The joint controllers' law: PID with velocity gain and feed-forward, per joint.

Pure. What makes it stable for any damping gain at any step is the second half: see
``user_effort``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_MAX_STIFFNESS = 0.9
"""Share of its damping that a stiff joint may lose to the lag of the implicit law.

This is s_max: below 1, so that some damping is always left, but near it, so that
few joints see another law than the one written.
"""


@dataclass(frozen=True)
class PidInput:
    """Set-points, gains and measurement; arrays (n,) in message order.

    Units as in ``JointCommand``; ``position`` already within the joints' limits.
    """

    position: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray
    kp_position: np.ndarray
    ki_position: np.ndarray
    kd_position: np.ndarray
    kp_velocity: np.ndarray
    i_effort_min: np.ndarray
    i_effort_max: np.ndarray


@dataclass(frozen=True)
class PidState:
    """What the law remembers; arrays (n,).

    Attributes:
        integral: Of the position error times its gain [N·m].
        velocity: At the last step [rad/s].
        effort: The user's effort at the last step [N·m].
    """

    integral: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray


def integrate(
    state: PidState, command: PidInput, q: np.ndarray, active: np.ndarray, dt: float
) -> np.ndarray:
    """The integral term after a step, within its clamps [N·m], shape (n,).

    It holds still where ``active`` is False, and cannot wind up beyond its clamps.
    """
    grown = state.integral + command.ki_position * (command.position - q) * dt
    clamped = np.minimum(np.maximum(grown, command.i_effort_min), command.i_effort_max)
    return np.where(active, clamped, state.integral)


def explicit_effort(
    command: PidInput, integral: np.ndarray, q: np.ndarray, v: np.ndarray
) -> np.ndarray:
    """The law as written: kp·e + ∫ki·e + kd·ė + kp_velocity·(v_des - v) + effort.

    The set-point is constant between commands, so ė = -v.
    """
    return (
        command.kp_position * (command.position - q)
        + integral
        - command.kd_position * v
        + command.kp_velocity * (command.velocity - v)
        + command.effort
    )


def user_effort(
    state: PidState,
    command: PidInput,
    integral: np.ndarray,
    q: np.ndarray,
    v: np.ndarray,
    share: np.ndarray,
    inertia: np.ndarray,
    effort_limit: np.ndarray,
    dt: float,
) -> np.ndarray:
    """The law with its damping taken implicitly [N·m], shape (n,).

    An explicit torque -d·v at step h diverges when d·h exceeds twice the inertia I,
    which the tutorial's own gains do at the wrists. The implicit law asks for the
    damping of the velocity at the step's end, v⁺ = v + (h/I)·(τ + τ_other). What all
    other forces (gravity, contact, the rest of the body) do is not known, so it is
    taken from the last step: τ_other = I·(v - v_last)/h - τ_last. Solving for τ gives

        τ = τ_last + (τ_law(q, 2v - v_last) - τ_last) / (1 + a),   a = h·k·d / I

    which is the law itself wherever d is small or the joint is at rest, so that
    set-points and gravity droop are those of the gains, and stays stable for any d as
    long as I is not above 4/3 of the joint's true inertia.

    A joint that is much heavier than I lags behind the law by a·h. Its stiffness,
    taken late, then drives it like a negative damping of s·d with s = h²·k·kp / I,
    which would outweigh d from s = 1 on: ankles and shoulders at 2 ms. τ_law
    therefore has the damping (s - s_max)·d added where s is above s_max. That is
    stable for s up to 1 + s_max at the inertia I itself and for more at a greater
    one; a joint's true inertia is three times I and more.

    Args:
        state: Of the last step.
        command: Set-points and gains.
        integral: The integral term now [N·m].
        q: Positions [rad].
        v: Velocities [rad/s].
        share: The user's share k of each joint, 0 to 1.
        inertia: Lower estimate of each joint's inertia, all else free [kg·m²].
        effort_limit: [N·m]
        dt: The step h [s].
    """
    damping = command.kd_position + command.kp_velocity
    a = (dt * share * damping) / inertia
    law = explicit_effort(command, integral, q, 2.0 * v - state.velocity)
    stiffness = (dt * dt * share * command.kp_position) / inertia
    law -= np.maximum(stiffness - _MAX_STIFFNESS, 0.0) * damping * v
    effort = state.effort + (law - state.effort) / (1.0 + a)
    return np.minimum(np.maximum(effort, -effort_limit), effort_limit)


def damping_bound(effort_limit: np.ndarray, velocity_limit: np.ndarray) -> np.ndarray:
    """Largest velocity gain that counts: 50 · effort limit / velocity limit."""
    return 50.0 * effort_limit / velocity_limit
