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


DRIFT_TIME = 0.002
"""Time in which the estimate of what is not the motors' doing follows it [s]."""


@dataclass(frozen=True)
class StepModel:
    """How velocities respond to efforts within a step.

    Attributes:
        response: h·Λ, velocity change per effort [rad/s per N·m], shape (n, n).
        damping: d, all gains on velocity together [N·m·s/rad], shape (n,).
        gain: G = (1 + D·h·Λ·K)⁻¹, shape (n, n).
        blend: How much of a new change of velocity enters the estimate [-].
    """

    response: np.ndarray
    damping: np.ndarray
    gain: np.ndarray
    blend: float


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
    return StepModel(response, damping, gain, dt / (dt + DRIFT_TIME))


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
        others: The behaviour's part of the motors' efforts (1 - K)·τ_behaviour [N·m].
        model: From ``step_model``.
    """
    change = state.expected + model.blend * (v - state.velocity - state.expected)
    return change + model.response @ (others - state.applied)


def user_effort(
    static: np.ndarray, coasting: np.ndarray, model: StepModel, effort_limit: np.ndarray
) -> np.ndarray:
    """The law with its damping taken implicitly [N·m], shape (n,).

    An explicit torque -d·v at step h diverges when d·h exceeds twice the inertia of
    the joint, which the tutorial's own gains do at the wrists. The implicit law asks
    for the damping of the velocity at the step's end,

        v⁺ = v_c + h·Λ·K·τ,

    where v_c is what it would be without the user's efforts:

        τ = τ_static - D·v⁺   ⇒   τ = G·(τ_static - D·v_c),   G = (1 + D·h·Λ·K)⁻¹

    When joints move steadily v⁺ is v, and this is the law itself: set-points and
    gravity droop are those of the gains, whatever the step. The scalar loop is stable
    for any damping as long as Λ is not below 3/4 of the true mobility.

    Args:
        static: The law without its velocity terms, ``static_effort`` [N·m].
        coasting: v_c, velocities and ``change_without_user`` together [rad/s].
        model: From ``step_model``.
        effort_limit: [N·m]
    """
    effort = model.gain @ (static - model.damping * coasting)
    return np.minimum(np.maximum(effort, -effort_limit), effort_limit)


def damping_bound(effort_limit: np.ndarray, velocity_limit: np.ndarray) -> np.ndarray:
    """Largest velocity gain that counts: 50 · effort limit / velocity limit."""
    return 50.0 * effort_limit / velocity_limit
