"""Where the robot is and how fast, from its accelerometer and its legs.

A linear Kalman filter on top of an orientation that is taken as known: the idea is that
of Bloesch et al., "State estimation for legged robots" (RSS 2012), with the orientation
left to ``attitude``. Pure: what it remembers is a frozen value.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.estimation.attitude import (
    rotation_matrix,
    turned,
    turned_in_world,
    upright_correction,
)
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.frozen import Frozen

_POSITION, _VELOCITY, _BIAS, _LEFT, _RIGHT = range(5)
_FEET = (_LEFT, _RIGHT)
_EYE = np.eye(5)


@dataclass(frozen=True)
class OdometryTuning:
    """How far each source is trusted: standard deviations per axis.

    White noise is given per √s, so that it does not depend on the control period.
    """

    gravity_settling: float = 100.0
    """In which a tilt that contradicts gravity is forgotten [s]."""
    acceleration: float = 0.005
    """Of the accelerometer's white noise [m/s² √s]."""
    bias: float = 0.1
    """Of its constant bias before anything is known [m/s²]."""
    foot_position: float = 0.001
    """Of a sole as kinematics sees it from the pelvis [m]."""
    slip: float = 0.001
    """Of a foot that stands firmly [m/√s]."""
    loose_slip: float = 0.1
    """Of one that hardly carries anything, or that the other sensors see sliding or
    turning over an edge [m/√s]."""
    no_load: float = 0.03
    """A foot that carries less of the weight is in the air [-]."""
    full_load: float = 0.40
    """One that carries more stands as firmly as it ever does [-]."""
    still: float = 0.05
    """A foot that seems slower does not slide: joint velocities have noise [m/s]."""
    sliding: float = 0.12
    """One that seems faster does [m/s]."""
    rest: float = 1.0
    """Speed of a robot without a foot on the ground, which is believed to hang still
    for want of anything better to go by [m/s]."""


@dataclass(frozen=True)
class OdometryState(Frozen):
    """What the filter believes. I is the IMU's place, P the pelvis, F a sole.

    Attributes:
        q_WP: Orientation of the pelvis, unit quaternion [w, x, y, z], shape (4,).
        mean: Rows p_WI [m], v_WI [m/s], the accelerometer's bias in P [m/s²], p_WF of
            the left and p_WF of the right sole [m]; shape (5, 3).
        covariance: Of the rows, shape (5, 5). All noise is the same in all directions,
            so that one covariance does for the three axes; strictly that holds while
            the pelvis does not turn, by which the bias turns in W, but the bias is
            known before a robot has turned far.
    """

    q_WP: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray

    @property
    def p_WI(self) -> np.ndarray:
        """Position of the IMU [m], shape (3,)."""
        return self.mean[_POSITION]

    @property
    def v_WI(self) -> np.ndarray:
        """Its velocity [m/s], shape (3,)."""
        return self.mean[_VELOCITY]

    @property
    def bias_P(self) -> np.ndarray:
        """The accelerometer's bias [m/s²], shape (3,)."""
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
    """What is known of a robot that was put somewhere.

    Args:
        q_WP: Orientation of the pelvis, unit quaternion, shape (4,).
        p_WI: Position of the IMU [m], shape (3,).
        v_WI: Its velocity [m/s], shape (3,).
        p_WF: Positions of left and right sole [m], shape (2, 3).
        tuning: Says how little is known of the bias.
    """
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
    """Moves on by what the IMU felt.

    Args:
        state: Before.
        turn_P: Rotation since then, the gyroscope's integral [rad], shape (3,).
        velocity_P: The accelerometer's integral, specific force times time, in the
            pelvis' axes halfway through the turn [m/s], shape (3,).
        dt: Time since then [s], positive.
        tuning: Of the filter.
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
    """Takes in where the legs say that the feet are.

    A foot that carries load stays where it is, the more surely the more it carries.
    One that seems to slide, as the accelerometer knows better for a while, is hardly
    believed: otherwise all of its way would be taken for the pelvis'. One in the air is
    where kinematics puts it: it is anchored anew when it lands.

    Args:
        state: As predicted.
        p_IF_W: From the IMU to left and right sole, in W [m], shape (2, 3).
        v_IF_W: Its rate of change, in W [m/s], shape (2, 3).
        load: Vertical force on each foot as a share of the weight [-], shape (2,).
        dt: Time since the last correction [s].
        tuning: Of the filter.
    """
    standing = [foot for foot in (0, 1) if load[foot] > tuning.no_load]
    covariance = state.covariance.copy()
    if standing:
        rows = [_EYE[_FEET[foot]] - _EYE[_POSITION] for foot in standing]
        seen, variance = p_IF_W[standing], tuning.foot_position**2
        for foot in standing:
            own = _FEET[foot]
            speed = float(np.linalg.norm(state.v_WI + v_IF_W[foot]))
            slip = _slip(float(load[foot]), speed, tuning)
            covariance[own, own] += slip * slip * dt
    else:
        rows, seen, variance = [_EYE[_VELOCITY]], np.zeros((1, 3)), tuning.rest**2
    H = np.array(rows)
    across = covariance @ H.T
    gain = np.linalg.solve(H @ across + variance * np.eye(len(H)), across.T).T
    change = gain @ (seen - H @ state.mean)
    # Learned in W, kept in P.
    change[_BIAS] = change[_BIAS] @ rotation_matrix(state.q_WP)
    mean = state.mean + change
    covariance -= gain @ across.T
    covariance = 0.5 * (covariance + covariance.T)
    for foot in (0, 1):
        if foot not in standing:
            # The limit of a filter for which a foot in the air may go anywhere.
            own = _FEET[foot]
            mean[own] = mean[_POSITION] + p_IF_W[foot]
            covariance[own] = covariance[_POSITION]
            covariance[:, own] = covariance[:, _POSITION]
            covariance[own, own] += tuning.foot_position**2
    return OdometryState(state.q_WP, mean, covariance)


def _slip(load: float, speed: float, tuning: OdometryTuning) -> float:
    """Of a foot under ``load`` shares of the weight that seems to move [m/√s]."""
    light = (tuning.full_load - load) / (tuning.full_load - tuning.no_load)
    fast = (speed - tuning.still) / (tuning.sliding - tuning.still)
    loose = min(max(light, fast, 0.0), 1.0)
    return tuning.slip + tuning.loose_slip * loose * loose
