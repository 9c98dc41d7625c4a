"""The joint controllers' law: PID with velocity gain and feed-forward, per joint.

Pure. What makes it stable for any damping gain at any step is in ``user_effort``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.joint_command import JointCommand


@dataclass(frozen=True)
class PidState:
    """What the law remembers; arrays (n,).

    Attributes:
        integral: Of the position error times its gain [N·m].
        velocity: At the last step [rad/s].
        applied: Effort that the motors were to give in the last step [N·m].
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


def explicit_effort(
    command: JointCommand, integral: np.ndarray, q: np.ndarray, v: np.ndarray
) -> np.ndarray:
    """The law as written: kp·e + ∫ki·e + kd·ė + kp_velocity·(v_des - v) + effort.

    The set-point is constant between commands, so ė = -v.
    """
    damping = command.kd_position + command.kp_velocity
    return static_effort(command, integral, q) - damping * v


DRIFT_TIME = 0.002
"""Time in which the estimate of what is not the motors' doing follows it [s]."""


@dataclass(frozen=True)
class StepModel:
    """How velocities respond to efforts within a step; arrays (n, n).

    Attributes:
        response: h·Λ, velocity change per effort [rad/s per N·m].
        gain: G = (1 + D·h·Λ·K)⁻¹.
        damping_gain: G·D [N·m·s/rad].
        dt: The step h [s].
    """

    response: np.ndarray
    gain: np.ndarray
    damping_gain: np.ndarray
    dt: float


def step_model(
    damping: np.ndarray, share: np.ndarray, mobility: np.ndarray, dt: float
) -> StepModel:
    """What ``user_effort`` needs to know of the robot.

    Args:
        damping: All gains on velocity together d [N·m·s/rad], shape (n,).
        share: The user's share k of each joint, 0 to 1.
        mobility: Λ, accelerations per effort [rad/s² per N·m], shape (n, n).
        dt: The step h [s].
    """
    response = dt * mobility
    coupling = damping[:, None] * (response * share)
    coupling.reshape(-1)[:: len(damping) + 1] += 1.0
    gain = np.linalg.inv(coupling)
    return StepModel(response, gain, gain * damping, dt)


def estimate_drift(state: PidState, v: np.ndarray, model: StepModel) -> np.ndarray:
    """What gravity, contact and the body's own motion do to velocities per step.

    The part of the last change of velocity that the motors do not explain, smoothed:
    an unsmoothed estimate answers every jolt twice, and rings. What is smoothed is the
    whole change, which stays what it was when the model becomes another one, such as
    that of a foot in the air: a drift remembered from the old one would belong to
    efforts many times as large, and each change of the model would be a jolt.
    """
    blend = model.dt / (model.dt + DRIFT_TIME)
    change = state.expected + blend * (v - state.velocity - state.expected)
    return change - model.response @ state.applied


def user_effort(
    static: np.ndarray,
    v: np.ndarray,
    drift: np.ndarray,
    others: np.ndarray,
    model: StepModel,
    effort_limit: np.ndarray,
) -> np.ndarray:
    """The law with its damping taken implicitly [N·m], shape (n,).

    An explicit torque -d·v at step h diverges when d·h exceeds twice the inertia of
    the joint, which the tutorial's own gains do at the wrists. The implicit law asks
    for the damping of the velocity at the step's end,

        v⁺ = v + o + h·Λ·((1 - K)·τ_behaviour + K·τ),

    where o is what no motor does, and the behaviour's efforts are known:

        τ = τ_static - D·v⁺   ⇒
        τ = G·(τ_static - D·(v + o + h·Λ·(1 - K)·τ_behaviour)),   G = (1 + D·h·Λ·K)⁻¹

    When joints move steadily v⁺ is v, and this is the law itself: set-points and
    gravity droop are those of the gains, whatever the step. The scalar loop is stable
    for any damping as long as Λ is not below 3/4 of the true mobility.

    Args:
        static: The law without its velocity terms, ``static_effort`` [N·m].
        v: Velocities [rad/s].
        drift: o from ``estimate_drift``.
        others: The behaviour's part of the motors' efforts (1 - K)·τ_behaviour [N·m].
        model: From ``step_model``.
        effort_limit: [N·m]
    """
    coasting = v + drift + model.response @ others
    effort = model.gain @ static - model.damping_gain @ coasting
    return np.minimum(np.maximum(effort, -effort_limit), effort_limit)


def damping_bound(effort_limit: np.ndarray, velocity_limit: np.ndarray) -> np.ndarray:
    """Largest velocity gain that counts: 50 · effort limit / velocity limit."""
    return 50.0 * effort_limit / velocity_limit
