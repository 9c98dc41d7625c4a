"""Control law of the joints: PID with velocity gain and feed-forward, per joint.

    τ = kp·(q_d - q) + clamp(∫ki·e) + kp_velocity·(v_d - v⁺) - kd·v⁺ + effort

The damping acts on the velocity v⁺ at the end of a physics step. Drake's contact solver
finds v⁺ together with the forces of the ground and with motors that saturate: it is
given the law as gains and feed-forward of the plant's own motors (``motor_law``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.frozen import Frozen, read_only, replace
from atlas_drake.messages.joint_command import JointCommand


@dataclass(frozen=True)
class MotorLaw(Frozen):
    """The user's part of the motors' efforts in a step h, read-only.

        k·τ = p·(q_d - q⁺) - d·v⁺ + u,   q⁺ = q + h·v⁺

    Attributes:
        stiffness: p [N·m/rad], shape (n,), message order.
        damping: d [N·m·s/rad], shape (n,).
        position: q_d [rad], shape (n,).
        feed_forward: u [N·m], shape (n,).
    """

    stiffness: np.ndarray
    damping: np.ndarray
    position: np.ndarray
    feed_forward: np.ndarray


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
    integral: np.ndarray, command: JointCommand, q: np.ndarray, dt: float
) -> np.ndarray:
    """Advances the integral term by ``dt``, within its clamps [N·m], shape (n,).

    The term is constant for a joint without a user share, and cannot wind up beyond its
    clamps.
    """
    grown = integral + command.ki_position * (command.position - q) * dt
    clamped = np.minimum(np.maximum(grown, command.i_effort_min), command.i_effort_max)
    return np.where(command.k > 0.0, clamped, integral)


def constant_effort(command: JointCommand, integral: np.ndarray) -> np.ndarray:
    """Computes the terms of the law that the joint's motion does not change [N·m]."""
    return integral + command.kp_velocity * command.velocity + command.effort


def step_damping(command: JointCommand, step: float) -> np.ndarray:
    """Computes the damping D of the law in a physics step h [N·m·s/rad], shape (n,).

    The spring acts on the position at the beginning of the step, as it would at a finer
    one, so that it neither gains nor loses energy. That is stable for any inertia, any
    coupling of the joints and any contact if D ≥ h·kp/2; the law is given D ≥ h·kp.
    """
    damping = command.kd_position + command.kp_velocity
    return np.maximum(damping, step * command.kp_position)


def motor_law(command: JointCommand, integral: np.ndarray, step: float) -> MotorLaw:
    """Returns the law as a motor of Drake's takes it, which has the spring at q⁺.

    A spring at q⁺ acts as a spring at q with a damping of h·kp; D contains that.
    """
    k, kp = command.k, command.kp_position
    law = MotorLaw(
        k * kp,
        k * (step_damping(command, step) - step * kp),
        command.position,
        k * constant_effort(command, integral),
    )
    return read_only(law)


def user_effort(
    command: JointCommand,
    integral: np.ndarray,
    q: np.ndarray,
    v_next: np.ndarray,
    step: float,
) -> np.ndarray:
    """Computes the law's efforts in a step that ends with ``v_next`` [N·m], (n,)."""
    spring = command.kp_position * (command.position - q)
    damping = step_damping(command, step) * v_next
    return spring + constant_effort(command, integral) - damping
