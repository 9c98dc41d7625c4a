"""The joint controllers' law: PID with velocity gain and feed-forward, per joint.

Pure. What makes it stable for any damping gain at any step is the second half: see
``user_effort``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


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


def static_effort(command: PidInput, integral: np.ndarray, q: np.ndarray) -> np.ndarray:
    """All of the law but what depends on the joint's velocity [N·m], shape (n,)."""
    return (
        command.kp_position * (command.position - q)
        + integral
        + command.kp_velocity * command.velocity
        + command.effort
    )


def explicit_effort(
    command: PidInput, integral: np.ndarray, q: np.ndarray, v: np.ndarray
) -> np.ndarray:
    """The law as written: kp·e + ∫ki·e + kd·ė + kp_velocity·(v_des - v) + effort.

    The set-point is constant between commands, so ė = -v.
    """
    damping = command.kd_position + command.kp_velocity
    return static_effort(command, integral, q) - damping * v


def implicit_gain(
    damping: np.ndarray, share: np.ndarray, mobility: np.ndarray, dt: float
) -> np.ndarray:
    """The matrix G = (1 + h·D·Λ·K)⁻¹ of ``user_effort``, shape (n, n).

    Args:
        damping: All gains on velocity together d [N·m·s/rad], shape (n,).
        share: The user's share k of each joint, 0 to 1.
        mobility: Λ, accelerations per effort [rad/s² per N·m], shape (n, n).
        dt: The step h [s].
    """
    coupling = dt * damping[:, None] * mobility * share
    coupling.reshape(-1)[:: len(damping) + 1] += 1.0
    return np.linalg.inv(coupling)


def user_effort(
    state: PidState,
    command: PidInput,
    integral: np.ndarray,
    q: np.ndarray,
    v: np.ndarray,
    gain: np.ndarray,
    effort_limit: np.ndarray,
) -> np.ndarray:
    """The law with its damping taken implicitly [N·m], shape (n,).

    An explicit torque -d·v at step h diverges when d·h exceeds twice the inertia of
    the joint, which the tutorial's own gains do at the wrists. The implicit law asks
    for the damping of the velocity at the step's end, v⁺ = v + h·Λ·(K·τ + τ_other).
    What all other forces (gravity, contact, the behaviour) do is not known, so it is
    taken from the last step: h·Λ·τ_other = v - v_last - h·Λ·K·τ_last. Solving for τ,

        τ = τ_last + G·(τ_law(q, 2v - v_last) - τ_last),   G = (1 + h·D·Λ·K)⁻¹

    This is the law itself wherever damping is small or joints move steadily, so that
    set-points and gravity droop are those of the gains, and it is stable for any
    damping. A limb that the ground holds moves less than Λ says: its effort then
    follows the law with a lag of a few steps.

    Args:
        state: Of the last step.
        command: Set-points and gains.
        integral: The integral term now [N·m].
        q: Positions [rad].
        v: Velocities [rad/s].
        gain: G from ``implicit_gain``.
        effort_limit: [N·m]
    """
    law = explicit_effort(command, integral, q, 2.0 * v - state.velocity)
    effort = state.effort + gain @ (law - state.effort)
    return np.minimum(np.maximum(effort, -effort_limit), effort_limit)


def damping_bound(effort_limit: np.ndarray, velocity_limit: np.ndarray) -> np.ndarray:
    """Largest velocity gain that counts: 50 · effort limit / velocity limit."""
    return 50.0 * effort_limit / velocity_limit
