"""Reference of trunk and posture, which each behavior passes on to the next.

The reference starts from the present posture and moves to the nominal posture at
limited speed, so that no hand-over from the user, or between behaviors, is a jump.
References of feet and horizontal center of mass are each behavior's own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.config import Configuration, NotNegative, Positive
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.rotations import orientation, tilt_of, wrap_angle, yaw_of
from atlas_drake.units import MetersPerSecond, RadiansPerSecond, Seconds


@dataclass(frozen=True)
class BodyRates(Configuration):
    """Speed limits of the reference of trunk and posture."""

    joints: NotNegative[RadiansPerSecond] = 0.6
    """Speed of each joint."""
    tilt: NotNegative[RadiansPerSecond] = 0.3
    """Speed of roll and pitch of pelvis and chest."""
    yaw: NotNegative[RadiansPerSecond] = 1.2
    """Speed of the heading."""
    height: NotNegative[MetersPerSecond] = 0.12
    """Speed of the height of the center of mass."""
    lead: NotNegative[MetersPerSecond] = 0.5
    """Speed at which the lead that pelvis and arms follow comes to that of the feet."""
    easing: Positive[Seconds] = 0.1
    """Time in which height and heading reach their speed, and slow down again."""


@dataclass(frozen=True)
class BodyReference:
    """Reference of trunk and posture; n joints in message order."""

    height: float  # Height of the center of mass in W [m]
    height_rate: float  # Rate of the height [m/s]
    yaw: float  # Heading of pelvis and chest [rad]
    yaw_rate: float  # Rate of the heading [rad/s]
    pelvis_tilt: np.ndarray  # Roll and pitch of the pelvis [rad], shape (2,)
    chest_tilt: np.ndarray  # Roll and pitch of the chest [rad], shape (2,)
    joints: np.ndarray  # Posture [rad], shape (n,)
    lead: float = 0.0  # Of the left foot, which pelvis and arms follow [m]
    lead_rate: float = 0.0  # Rate of the lead [m/s]

    def R_WP(self, turn: float) -> np.ndarray:
        """Desired orientation of the pelvis, turned from the heading [rad]."""
        return orientation(self.yaw + turn, self.pelvis_tilt)

    @property
    def R_WC(self) -> np.ndarray:
        """Desired orientation of the chest."""
        return orientation(self.yaw, self.chest_tilt)


@dataclass(frozen=True)
class BodyTarget:
    """Target of the reference of trunk and posture."""

    height: float  # Height of the center of mass in W [m]
    yaw: float  # Heading of pelvis and chest [rad]
    joints: np.ndarray  # Posture [rad], shape (n,)
    pelvis_tilt: np.ndarray  # Roll and pitch of the pelvis [rad], shape (2,)
    chest_tilt: np.ndarray  # Roll and pitch of the chest [rad], shape (2,)
    lead: float = 0.0  # Of the left foot before the right one [m]
    lead_rate: float = 0.0  # Rate of the lead [m/s]


def capture_body(terms: WholeBodyTerms) -> BodyReference:
    """Returns the present posture as the reference, at rest."""
    return BodyReference(
        height=float(terms.com[2]),
        height_rate=0.0,
        yaw=yaw_of(terms.R_WP),
        yaw_rate=0.0,
        pelvis_tilt=tilt_of(terms.R_WP),
        chest_tilt=tilt_of(terms.R_WC),
        joints=terms.q.copy(),
    )


def advance_body(
    body: BodyReference,
    target: BodyTarget,
    rates: BodyRates,
    dt: float,
    measured: np.ndarray,
    user_held: np.ndarray,
) -> BodyReference:
    """Moves the reference towards ``target`` for ``dt`` [s].

    Joints under user control follow their measured positions, so that a behavior takes
    them back from where the user left them.
    """
    height_rate = _eased(
        target.height - body.height, body.height_rate, rates.height, rates.easing, dt
    )
    turn = wrap_angle(target.yaw - body.yaw)
    yaw_rate = _eased(turn, body.yaw_rate, rates.yaw, rates.easing, dt)
    catch_up = (target.lead - body.lead) / dt - target.lead_rate
    lead_rate = target.lead_rate + min(max(catch_up, -rates.lead), rates.lead)
    joints = _approach_all(body.joints, target.joints, rates.joints * dt)
    if user_held.any():
        joints = np.where(user_held, measured, joints)
    tilt = rates.tilt * dt
    return BodyReference(
        height=body.height + height_rate * dt,
        height_rate=height_rate,
        yaw=body.yaw + yaw_rate * dt,
        yaw_rate=yaw_rate,
        pelvis_tilt=_approach_all(body.pelvis_tilt, target.pelvis_tilt, tilt),
        chest_tilt=_approach_all(body.chest_tilt, target.chest_tilt, tilt),
        joints=joints,
        lead=body.lead + lead_rate * dt,
        lead_rate=lead_rate,
    )


def _eased(way: float, rate: float, limit: float, easing: float, dt: float) -> float:
    """Computes the next rate of a reference at distance ``way`` from its goal.

    The rate is at most ``limit``; it rises over ``easing`` [s], and falls near the
    goal: a jump of the rate would be a jump of every effort, because the feedback laws
    damp the difference to the rate. The reference lags a moving goal by ``easing``
    times the goal's speed. With an initial rate it can overshoot a near goal by at most
    limit·easing/2.
    """
    rate = min(max(rate, -limit), limit)
    desired = min(max(way / easing, -limit), limit)
    change = limit * dt / easing
    return min(max(desired, rate - change), rate + change)


def _approach_all(value: np.ndarray, goal: np.ndarray, step: float) -> np.ndarray:
    if value is goal:
        return goal
    way = goal - value
    if max(way.max(), -way.min()) <= step:
        return goal
    return value + np.minimum(np.maximum(way, -step), step)
