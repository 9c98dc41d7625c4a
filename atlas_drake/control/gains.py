"""Gains and weights of the whole-body controller, as data.

All robots share them; what is a robot's own, such as the joints' default gains, stands
in its file. What each value means and why it is what it is stands beside it. No code
that uses them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from atlas_drake.bounds import Positive


@dataclass(frozen=True)
class PdGains:
    """Stiffness and damping of a task, per unit of inertia."""

    kp: float
    """Stiffness [1/s²]."""
    kd: float
    """Damping [1/s]."""


@dataclass(frozen=True)
class QpWeights:
    """Weights of the QP's cost, per squared unit of the task's acceleration."""

    com: float = 30.0
    """Center of mass, horizontal, through the contact forces [1/(m/s²)²]."""
    com_height: float = 60.0
    """Height of the center of mass [1/(m/s²)²]. Below the weight of the moment: where a
    knee is at its limit, the robot gives up height before balance."""
    moment: float = 70.0
    """Moment of the contact forces about the enhanced centroidal moment pivot (eCMP):
    their sum passes through the center of pressure that balance asks for
    [1/(m/s²)²]."""
    pelvis_orientation: float = 2.0
    """[1/(rad/s²)²]."""
    chest_orientation: float = 0.2
    """[1/(rad/s²)²]."""
    stance_foot: float = 50.0
    """Feet on the ground keep still [1/(m/s²)²]."""
    swing_foot_position: float = 20.0
    """[1/(m/s²)²]."""
    swing_foot_orientation: float = 10.0
    """[1/(rad/s²)²]."""
    contact_force: Positive = 1e-6
    """Spreads the load over the feet [1/N²]."""
    contact_moment: Positive = 1e-4
    """Keeps the pressure near the soles' middles [1/(N·m)²]."""
    internal_contact_force: float = 3e-5
    """Feet pushing against each other horizontally, per difference: enough to keep them
    from it where nothing is won, not where knees at their limit need it [1/N²]."""
    internal_contact_moment: float = 1e-3
    """Feet turning against each other about the vertical [1/(N·m)²]."""


@dataclass(frozen=True)
class ContactModel:
    """What the controller assumes of each sole on the ground."""

    friction: Positive = 0.5
    """Coefficient that the QP keeps to; below the grounds it is meant for."""
    length_margin: float = 0.015
    """Strip at toe and heel that the center of pressure stays out of [m]."""
    width_margin: float = 0.010
    """Strip at both sides that it stays out of [m]."""
    yaw_moment_arm: float = 0.05
    """Lever of friction about the normal [m]."""


@dataclass(frozen=True)
class JointLimitGains:
    """How joint accelerations are bounded so that positions keep their limits."""

    kp: float = 400.0
    """[1/s²]"""
    kd: float = 40.0
    """[1/s]"""
    margin: float = 0.02
    """Distance kept from each end stop [rad]."""


@dataclass(frozen=True)
class ControlGains:
    """Everything that tunes the whole-body controller."""

    weights: QpWeights = field(default_factory=QpWeights)
    contact: ContactModel = field(default_factory=ContactModel)
    joint_limits: JointLimitGains = field(default_factory=JointLimitGains)
    com_height: PdGains = PdGains(kp=40.0, kd=12.0)
    dcm_gain: float = 2.0
    """Center of pressure moves this many times the DCM's error, beyond it [-]."""
    orientation: PdGains = PdGains(kp=100.0, kd=20.0)
    """Pelvis and chest."""
    stance_foot_damping: float = 10.0
    """[1/s]"""
    swing_position: PdGains = PdGains(kp=200.0, kd=28.0)
    swing_orientation: PdGains = PdGains(kp=200.0, kd=28.0)
    posture: PdGains = PdGains(kp=80.0, kd=18.0)
    leg_posture_weight: float = 0.02
    back_posture_weight: float = 0.1
    arm_posture_weight: float = 2.0
