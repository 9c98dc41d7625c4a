"""Position and velocity of the robot, from its accelerometer and its legs.

A linear Kalman filter that takes the orientation as known: the method of Bloesch et
al., "State estimation for legged robots", RSS 2012, with the orientation estimated in
``attitude``. Pure functions; the state of the filter is a frozen value.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Unit

from atlas_drake.config import Configuration, NotNegative
from atlas_drake.control.attitude import (
    turned,
    turned_in_world,
    upright_correction,
)
from atlas_drake.frozen import Frozen
from atlas_drake.rotations import rotation_matrix
from atlas_drake.units import (
    GRAVITY,
    Meters,
    MetersPerSecond,
    MetersPerSecondSquared,
    Ratio,
    Seconds,
)

_POSITION, _VELOCITY, _BIAS, _LEFT, _RIGHT = range(5)
_FEET = (_LEFT, _RIGHT)
_EYE = np.eye(5)

MetersPerRootSecond = Annotated[float, Unit("m/√s")]
AccelerationDensity = Annotated[float, Unit("m/s² √s")]
"""Density of white noise on an acceleration."""


@dataclass(frozen=True)
class OdometryTuning(Configuration):
    """Standard deviations of each source of the estimate, per axis.

    White noise is given per √s, so that it does not depend on the control period.
    """

    gravity_settling: NotNegative[Seconds] = 100.0
    """Time constant with which an error of tilt is corrected by gravity."""
    acceleration: NotNegative[AccelerationDensity] = 0.005
    """White noise of the accelerometer."""
    bias: NotNegative[MetersPerSecondSquared] = 0.1
    """Initial uncertainty of the accelerometer's constant bias."""
    foot_position: NotNegative[Meters] = 0.001
    """Position of a sole relative to the pelvis, by kinematics."""
    slip: NotNegative[MetersPerRootSecond] = 0.001
    """Drift of a foot that stands firmly."""
    loose_slip: NotNegative[MetersPerRootSecond] = 0.1
    """Drift of a foot that carries almost no load, or that slides or tilts over an edge
    by the other sensors."""
    no_load: NotNegative[Ratio] = 0.03
    """Share of the weight below which a foot counts as in the air."""
    full_load: NotNegative[Ratio] = 0.40
    """Share of the weight above which a foot counts as standing firmly."""
    still: NotNegative[MetersPerSecond] = 0.05
    """Measured speed of a foot below which it does not slide: joint velocities have
    noise."""
    sliding: NotNegative[MetersPerSecond] = 0.12
    """Measured speed of a foot above which it slides."""
    rest: NotNegative[MetersPerSecond] = 1.0
    """Speed of a robot without a foot on the ground. It is assumed to hang still,
    because no other measurement of its velocity exists."""


@dataclass(frozen=True)
class OdometryState(Frozen):
    """State of the filter. I is the place of the IMU, P the pelvis, F a sole.

    All noise is the same in all directions, so that one covariance does for the three
    axes; strictly that holds while the pelvis does not turn, by which the bias turns in
    W, but the bias is known before a robot has turned far.
    """

    q_WP: np.ndarray  # Orientation of the pelvis, unit quaternion, shape (4,)
    mean: np.ndarray  # Rows p_WI, v_WI, bias in P [m/s²], p_WF left and right; (5, 3)
    covariance: np.ndarray  # Of the rows, the same for each axis; shape (5, 5)

    @property
    def p_WI(self) -> np.ndarray:
        """Position of the IMU [m], shape (3,)."""
        return self.mean[_POSITION]

    @property
    def v_WI(self) -> np.ndarray:
        """Velocity of the IMU [m/s], shape (3,)."""
        return self.mean[_VELOCITY]

    @property
    def bias_P(self) -> np.ndarray:
        """Bias of the accelerometer [m/s²], shape (3,)."""
        return self.mean[_BIAS]

    @property
    def p_WF(self) -> np.ndarray:
        """Positions of left and right sole [m], shape (2, 3)."""
        return self.mean[_LEFT:]


def start_odometry(
    q_WP: np.ndarray,
    p_WI: np.ndarray,
    v_WI: np.ndarray,
    p_WF: np.ndarray,
    tuning: OdometryTuning,
) -> OdometryState:
    """Makes the state of the filter for a robot whose pose is known."""
    mean = np.vstack([p_WI, v_WI, np.zeros(3), p_WF])
    covariance = np.zeros((5, 5))
    covariance[_BIAS, _BIAS] = tuning.bias**2
    return OdometryState(q_WP.copy(), mean, covariance)


def predict(
    state: OdometryState,
    turn_P: np.ndarray,
    velocity_P: np.ndarray,
    dt: float,
    tuning: OdometryTuning,
) -> OdometryState:
    """Predicts the state from the measurements of the IMU.

    ``turn_P`` is the gyroscope's integral [rad], ``velocity_P`` the accelerometer's, in
    the pelvis' axes halfway through the turn [m/s].
    """
    R_WP = rotation_matrix(turned(state.q_WP, 0.5 * turn_P))
    mean = state.mean.copy()
    gained = R_WP @ (velocity_P - dt * mean[_BIAS])
    upright = upright_correction(gained / dt, dt, tuning.gravity_settling)
    gained[2] -= GRAVITY * dt
    mean[_POSITION] += dt * (mean[_VELOCITY] + 0.5 * gained)
    mean[_VELOCITY] += gained

    step = _EYE.copy()
    step[_POSITION, _VELOCITY] = dt
    step[_POSITION, _BIAS] = -0.5 * dt * dt
    step[_VELOCITY, _BIAS] = -dt
    covariance = step @ state.covariance @ step.T
    covariance[_VELOCITY, _VELOCITY] += tuning.acceleration**2 * dt
    q_WP = turned_in_world(turned(state.q_WP, turn_P), upright)
    return OdometryState(q_WP, mean, covariance)


def correct(
    state: OdometryState,
    p_IF_W: np.ndarray,
    v_IF_W: np.ndarray,
    load: np.ndarray,
    dt: float,
    tuning: OdometryTuning,
) -> OdometryState:
    """Corrects the state with the kinematics of the legs.

    A foot is assumed to stay in place, with less drift the more ``load`` it carries, in
    weights [-]. A foot that seems to slide gets a large drift, because the
    accelerometer is the better measurement for a while: otherwise the filter would take
    the whole slip for motion of the pelvis. A foot in the air is placed by kinematics,
    and so gets a new anchor when it lands. ``p_IF_W`` and ``v_IF_W`` are the positions
    [m] of the soles from the IMU and their rate [m/s], in W.
    """
    standing = [foot for foot in (0, 1) if load[foot] > tuning.no_load]
    covariance = state.covariance.copy()
    if standing:
        rows = [_EYE[_FEET[foot]] - _EYE[_POSITION] for foot in standing]
        seen, variance = p_IF_W[standing], tuning.foot_position**2
        for foot in standing:
            own = _FEET[foot]
            speed = float(np.linalg.norm(state.v_WI + v_IF_W[foot]))
            slip = slip_rate(float(load[foot]), speed, tuning)
            covariance[own, own] += slip * slip * dt
    else:
        rows, seen, variance = [_EYE[_VELOCITY]], np.zeros((1, 3)), tuning.rest**2
    H = np.array(rows)
    across = covariance @ H.T
    gain = np.linalg.solve(H @ across + variance * np.eye(len(H)), across.T).T
    change = gain @ (seen - H @ state.mean)
    # The bias is corrected in W and stored in P, where it is constant.
    change[_BIAS] = change[_BIAS] @ rotation_matrix(state.q_WP)
    mean = state.mean + change
    covariance -= gain @ across.T
    covariance = 0.5 * (covariance + covariance.T)
    for foot in (0, 1):
        if foot not in standing:
            # Limit of the filter for an infinite drift of a foot in the air.
            own = _FEET[foot]
            mean[own] = mean[_POSITION] + p_IF_W[foot]
            covariance[own] = covariance[_POSITION]
            covariance[:, own] = covariance[:, _POSITION]
            covariance[own, own] += tuning.foot_position**2
    return OdometryState(state.q_WP, mean, covariance)


def slip_rate(load: float, speed: float, tuning: OdometryTuning) -> float:
    """Computes the drift of a foot by its load [-] and its speed [m/s], in m/√s."""
    light = (tuning.full_load - load) / (tuning.full_load - tuning.no_load)
    fast = (speed - tuning.still) / (tuning.sliding - tuning.still)
    loose = min(max(light, fast, 0.0), 1.0)
    return tuning.slip + tuning.loose_slip * loose * loose
