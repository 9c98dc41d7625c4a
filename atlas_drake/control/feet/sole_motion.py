"""The motion of a sole at one instant, and its pitch about its toes or its heel.

Which sole pitches, and when, is decided by ``foot_roll`` and the behaviors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from atlas_drake.messages.footstep import FootPose
from atlas_drake.rotations import cross, rotation_y

_STILL = np.zeros(3)


class Pitch(NamedTuple):
    """Angle by which a sole is pitched from flat, positive with its heel up."""

    angle: float = 0.0  # [rad]
    rate: float = 0.0  # [rad/s]
    acceleration: float = 0.0  # [rad/s²]


FLAT = Pitch()
"""The pitch of a sole that lies flat, or moves level."""


@dataclass(frozen=True)
class SoleMotion:
    """Reference of a sole at one instant: pose, velocity, acceleration in W."""

    p_WF: np.ndarray  # Of the sole's center: position, velocity, acceleration
    v_WF: np.ndarray
    a_WF: np.ndarray
    R_WF: np.ndarray  # Orientation, angular velocity and acceleration
    w_WF: np.ndarray
    alpha_WF: np.ndarray

    def pitched(self, pitch: Pitch, edge: float) -> SoleMotion:
        """Returns the motion with the sole pitched about an edge, which stays.

        ``edge`` is the distance of the edge ahead of the sole's center [m].
        """
        angle, rate, acceleration = pitch
        w, alpha = self.w_WF, self.alpha_WF
        x, y = self.R_WF[:, 0], self.R_WF[:, 1]
        R_WF = self.R_WF @ rotation_y(angle)
        w_pitched = w + rate * y
        alpha_pitched = alpha + acceleration * y + rate * cross(w, y)
        if edge == 0.0:
            return SoleMotion(
                self.p_WF, self.v_WF, self.a_WF, R_WF, w_pitched, alpha_pitched
            )
        to_edge, back = edge * x, -edge * R_WF[:, 0]
        turned, turned_back = cross(w, to_edge), cross(w_pitched, back)
        return SoleMotion(
            p_WF=self.p_WF + to_edge + back,
            v_WF=self.v_WF + turned + turned_back,
            a_WF=self.a_WF
            + (cross(alpha, to_edge) + cross(w, turned))
            + (cross(alpha_pitched, back) + cross(w_pitched, turned_back)),
            R_WF=R_WF,
            w_WF=w_pitched,
            alpha_WF=alpha_pitched,
        )


def at_rest(pose: FootPose) -> SoleMotion:
    """Returns the motion of a sole that stays where it is."""
    return SoleMotion(pose.p_WF, _STILL, _STILL, pose.R_WF, _STILL, _STILL)


def pitched_pose(flat: FootPose, angle: float, edge: float) -> FootPose:
    """Computes the pose of a sole pitched by ``angle`` about an edge, see above."""
    R_WF = flat.R_WF @ rotation_y(angle)
    return FootPose(flat.p_WF + edge * (flat.R_WF[:, 0] - R_WF[:, 0]), R_WF)


def pitch_from(pose: FootPose, normal: np.ndarray) -> float:
    """Computes the pitch of a sole from the ground with this normal [rad]."""
    return -math.asin(min(max(float(pose.R_WF[:, 0] @ normal), -1.0), 1.0))
