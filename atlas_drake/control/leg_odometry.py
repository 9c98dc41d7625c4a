"""Where the robot is and how fast, from its accelerometer and its legs.

A linear Kalman filter on top of an orientation that is taken as known: after Bloesch
et al., "State estimation for legged robots" (RSS 2012), with the orientation left to
``attitude``. Pure: what it remembers is a frozen value.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.attitude import (
    rotation_matrix,
    turned,
    turned_in_world,
    upright_correction,
)
from atlas_drake.control.whole_body_model import GRAVITY
from atlas_drake.frozen import Frozen

_P, _V, _BIAS = slice(0, 3), slice(3, 6), slice(6, 9)
_FEET = (slice(9, 12), slice(12, 15))
_SIZE = 15
_EYE = np.eye(_SIZE)


@dataclass(frozen=True)
class OdometryTuning:
    """How far each source is trusted; standard deviations.

    White noise is given per √s, so that it does not depend on the control period.
    """

    gravity_settling: float = 100.0
    """In which a tilt that contradicts gravity is forgotten [s]."""
    acceleration: float = 0.02
    """Of the accelerometer's white noise [m/s² √s]."""
    bias: float = 0.1
    """Of its constant bias before anything is known [m/s²]."""
    slip: float = 0.002
    """Of a fully loaded foot [m/√s]."""
    foot_position: float = 0.001
    """Of a sole seen from the pelvis by kinematics [m]."""
    foot_velocity: float = 0.05
    """Likewise [m/s]."""
    no_load: float = 0.03
    """A foot that carries less of the weight is in the air [-]."""
    full_load: float = 0.30
    """One that carries more stands as firmly as it ever does [-]."""
    landing_slip: float = 0.2
    """Of a foot that has just begun to carry something [m/√s]."""
    landing_velocity: float = 0.5
    """How fast such a foot may still be turning over an edge [m/s]."""
    rest: float = 1.0
    """Of a robot without a foot on the ground, which is believed to hang still, for
    want of anything better to go by [m/s]."""


@dataclass(frozen=True)
class OdometryState(Frozen):
    """What the filter believes. I is the IMU's place, P the pelvis' axes.

    Attributes:
        q_WP: Orientation of the pelvis, unit quaternion [w, x, y, z], shape (4,).
        mean: p_WI [m], v_WI [m/s], the accelerometer's bias in P [m/s²], and the left
            and the right sole's p_WF [m]; shape (15,).
        covariance: Of ``mean``, shape (15, 15).
    """

    q_WP: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray

    @property
    def p_WI(self) -> np.ndarray:
        """Position of the IMU [m], shape (3,)."""
        return self.mean[_P]

    @property
    def v_WI(self) -> np.ndarray:
        """Its velocity [m/s], shape (3,)."""
        return self.mean[_V]

    @property
    def bias_P(self) -> np.ndarray:
        """The accelerometer's bias [m/s²], shape (3,)."""
        return self.mean[_BIAS]

    def p_WF(self, foot: int) -> np.ndarray:
        """Position of a sole [m], shape (3,)."""
        return self.mean[_FEET[foot]]


def start_odometry(
    q_WP: np.ndarray,
    p_WI: np.ndarray,
    v_WI: np.ndarray,
    p_WF: np.ndarray,
    tuning: OdometryTuning,
) -> OdometryState:
    """What is known of a robot that was put somewhere.

    Args:
        q_WP: Orientation of the pelvis, unit quaternion, shape (4,).
        p_WI: Position of the IMU [m], shape (3,).
        v_WI: Its velocity [m/s], shape (3,).
        p_WF: Positions of left and right sole [m], shape (2, 3).
        tuning: Says how little is known of the bias.
    """
    covariance = np.zeros((_SIZE, _SIZE))
    covariance[_BIAS, _BIAS] = tuning.bias**2 * np.eye(3)
    mean = np.concatenate([p_WI, v_WI, np.zeros(3), *p_WF])
    return OdometryState(q_WP.copy(), mean, covariance)


def predict(
    state: OdometryState,
    turn_P: np.ndarray,
    velocity_P: np.ndarray,
    dt: float,
    tuning: OdometryTuning,
) -> OdometryState:
    """Moves on by what the IMU felt.

    Args:
        state: Before.
        turn_P: Rotation since then, the gyroscope's integral [rad], shape (3,).
        velocity_P: The accelerometer's integral, specific force times time, in the
            pelvis' axes halfway through the turn [m/s], shape (3,).
        dt: Time since then [s].
        tuning: Of the filter.
    """
    R_WP = rotation_matrix(turned(state.q_WP, 0.5 * turn_P))
    mean = state.mean.copy()
    gained = R_WP @ (velocity_P - dt * mean[_BIAS])
    upright = upright_correction(gained / dt, dt, tuning.gravity_settling)
    q_WP = turned_in_world(turned(state.q_WP, turn_P), upright)
    gained[2] -= GRAVITY * dt
    mean[_P] += dt * (mean[_V] + 0.5 * gained)
    mean[_V] += gained

    step = _EYE.copy()
    step[_P, _V] = dt * np.eye(3)
    step[_V, _BIAS] = -dt * R_WP
    step[_P, _BIAS] = -0.5 * dt * dt * R_WP
    covariance = step @ state.covariance @ step.T
    covariance[_V, _V] += tuning.acceleration**2 * dt * np.eye(3)
    return OdometryState(q_WP, mean, covariance)


def correct(
    state: OdometryState,
    p_IF_W: np.ndarray,
    v_IF_W: np.ndarray,
    load: np.ndarray,
    dt: float,
    tuning: OdometryTuning,
) -> OdometryState:
    """Takes in where the legs say that the feet are.

    A foot that carries load stays where it is, the more surely the more it carries.
    One in the air is where kinematics puts it: it is anchored anew when it lands.

    Args:
        state: As predicted.
        p_IF_W: From the IMU to left and right sole, in W [m], shape (2, 3).
        v_IF_W: Its rate of change, in W [m/s], shape (2, 3).
        load: Vertical force on each foot as a share of the weight [-], shape (2,).
        dt: Time since the last correction [s].
        tuning: Of the filter.
    """
    standing = [foot for foot in (0, 1) if load[foot] > tuning.no_load]
    covariance = state.covariance
    rows, values, variances = [], [], []
    if standing:
        covariance = covariance.copy()
    for foot in standing:
        doubt = _doubt(float(load[foot]), tuning)
        slip = tuning.slip + doubt * tuning.landing_slip
        covariance[_FEET[foot], _FEET[foot]] += slip**2 * dt * np.eye(3)
        velocity = tuning.foot_velocity + doubt * tuning.landing_velocity
        rows += [_EYE[_FEET[foot]] - _EYE[_P], -_EYE[_V]]
        values += [p_IF_W[foot], v_IF_W[foot]]
        variances += [tuning.foot_position**2] * 3 + [velocity**2] * 3
    if not standing:
        rows, values = [_EYE[_V]], [np.zeros(3)]
        variances = [tuning.rest**2] * 3
    H = np.concatenate(rows)
    across = covariance @ H.T
    gain = np.linalg.solve(H @ across + np.diag(variances), across.T).T
    mean = state.mean + gain @ (np.concatenate(values) - H @ state.mean)
    covariance = covariance - gain @ across.T
    covariance = 0.5 * (covariance + covariance.T)
    for foot in (0, 1):
        if foot not in standing:
            _anchor(mean, covariance, foot, p_IF_W[foot], tuning.foot_position**2)
    return OdometryState(state.q_WP, mean, covariance)


def _doubt(load: float, tuning: OdometryTuning) -> float:
    """From 0 for a foot that stands firmly to 1 for one that is about to lift [-]."""
    share = (tuning.full_load - load) / (tuning.full_load - tuning.no_load)
    return min(max(share, 0.0), 1.0) ** 2


def _anchor(
    mean: np.ndarray,
    covariance: np.ndarray,
    foot: int,
    p_IF_W: np.ndarray,
    variance: float,
) -> None:
    """Puts a foot where kinematics says it is, in place.

    The limit of a filter whose foot in the air may have gone anywhere.
    """
    own = _FEET[foot]
    mean[own] = mean[_P] + p_IF_W
    covariance[own] = covariance[_P]
    covariance[:, own] = covariance[:, _P]
    covariance[own, own] = covariance[_P, _P] + variance * np.eye(3)
