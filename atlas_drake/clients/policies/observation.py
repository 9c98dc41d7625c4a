"""The terms of a policy's observation, by the field's names."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from atlas_drake.messages import Imu


@dataclass(frozen=True)
class Seen:
    """What the terms of an observation are made of.

    Attributes:
        imu: Measurement at the pelvis.
        position: Of the policy's joints from its default position [rad], shape (m,).
        velocity: Of the same joints [rad/s], shape (m,).
        action: The last action of the network, shape (m,).
        desired_velocity: Ahead, left [m/s] and turn [rad/s], shape (3,).
        time: Since the policy took its joints [s].
        gait_period: Of a policy with a clock [s].
    """

    imu: Imu
    position: np.ndarray
    velocity: np.ndarray
    action: np.ndarray
    desired_velocity: np.ndarray
    time: float
    gait_period: float


Term = Callable[[Seen], np.ndarray]
"""Computes one term, of any size that stays the same."""


def base_ang_vel(seen: Seen) -> np.ndarray:
    """Angular velocity of the pelvis, in its own frame [rad/s], shape (3,)."""
    w = seen.imu.angular_velocity
    return np.array([w.x, w.y, w.z])


def projected_gravity(seen: Seen) -> np.ndarray:
    """Direction of gravity in the frame of the pelvis, shape (3,)."""
    q = seen.imu.orientation
    return np.array(
        [
            2.0 * (q.w * q.y - q.x * q.z),
            -2.0 * (q.y * q.z + q.w * q.x),
            1.0 - 2.0 * (q.w**2 + q.z**2),
        ]
    )


def phase(seen: Seen) -> np.ndarray:
    """Sine and cosine of the gait's clock, shape (2,)."""
    angle = 2.0 * math.pi * (seen.time / seen.gait_period % 1.0)
    return np.array([math.sin(angle), math.cos(angle)])


def desired_velocity(seen: Seen) -> np.ndarray:
    """Desired velocity ahead, to the left and of turning, shape (3,)."""
    return seen.desired_velocity


def joint_pos(seen: Seen) -> np.ndarray:
    """Joint positions from the default position [rad], shape (m,)."""
    return seen.position


def joint_vel(seen: Seen) -> np.ndarray:
    """Joint velocities [rad/s], shape (m,)."""
    return seen.velocity


def actions(seen: Seen) -> np.ndarray:
    """The last action, shape (m,)."""
    return seen.action


TERMS: Mapping[str, Term] = {
    "base_ang_vel": base_ang_vel,
    "projected_gravity": projected_gravity,
    "velocity_commands": desired_velocity,
    "command": desired_velocity,
    "joint_pos": joint_pos,
    "joint_vel": joint_vel,
    "actions": actions,
    "phase": phase,
}
"""The terms that a description may name; exporters call one of them by two names."""
