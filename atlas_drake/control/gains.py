"""Gains and weights of the whole-body controller, as data.

All robots share these values; values of one robot, such as the joints' default gains,
are in the robot's YAML file. Each value has its meaning and reason beside it. The code
that uses the values is elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Unit

from atlas_drake.config import Configuration, NotNegative, Positive, Share
from atlas_drake.units import (
    Meters,
    PerAngularAccelerationSquared,
    PerSecond,
    PerSecondSquared,
    Radians,
    Ratio,
    Seconds,
)

PerAccelerationSquared = Annotated[float, Unit("1/(m/s²)²")]
PerNewtonSquared = Annotated[float, Unit("1/N²")]
PerNewtonMeterSquared = Annotated[float, Unit("1/(N·m)²")]


@dataclass(frozen=True)
class PdGains(Configuration):
    """Stiffness and damping of a task, per unit of inertia."""

    kp: NotNegative[PerSecondSquared]
    """Stiffness."""
    kd: NotNegative[PerSecond]
    """Damping."""


@dataclass(frozen=True)
class QpWeights(Configuration):
    """Weights of the QP's cost, per squared unit of the task's acceleration."""

    com: NotNegative[PerAccelerationSquared] = 480.0
    """Center of mass, horizontal, through the contact forces. Far above the swing foot:
    where something must yield, it is not balance."""
    com_height: NotNegative[PerAccelerationSquared] = 100.0
    """Height of the center of mass. Below the weight of the moment: where a knee is at
    its limit, the robot gives up height before balance."""
    com_height_quick: NotNegative[PerAccelerationSquared] = 14.0
    """The same of raising it in quick level steps of WALK (``walk.rules.quick_step``).
    A long stride lowers the center of mass over the straight trailing leg; to raise it
    at once at lift-off throws the robot up, and it flies above 0.8 m/s."""
    moment: NotNegative[PerAccelerationSquared] = 1700.0
    """Moment of the contact forces about the enhanced centroidal moment pivot (eCMP):
    their sum passes through the center of pressure that balance asks for."""
    pelvis_tilt: NotNegative[PerAngularAccelerationSquared] = 4.0
    """Roll and pitch of the pelvis."""
    pelvis_yaw: NotNegative[PerAngularAccelerationSquared] = 0.8
    """Heading of the pelvis. Far below its tilt: a punch on an arm spins the robot, and
    legs that stop the spin at once do not step."""
    chest_tilt: NotNegative[PerAngularAccelerationSquared] = 1.0
    """Roll and pitch of the chest. With a twentieth of the pelvis' weight a push at the
    shoulders turns the chest to the waist's stop, and the waist gives half of its
    effort at most to spare the pelvis. At 2 a robot on stairs falls to spare the
    chest."""
    chest_yaw: NotNegative[PerAngularAccelerationSquared] = 0.03
    """Heading of the chest."""
    stance_foot: NotNegative[PerAccelerationSquared] = 50.0
    """Stance feet keep still."""
    swing_foot_position: NotNegative[PerAccelerationSquared] = 26.0
    """Position of the swing foot. Far below the weight of the CoM's height: a high
    swing begins with an almost straight knee, and a heavier foot lifts off with the
    pelvis, which throws the robot up and ahead."""
    swing_foot_lowering: NotNegative[PerAccelerationSquared] = 60.0
    """Height of a swing foot that is accelerated downward: a leg that rights the trunk
    instead lands late, and the DCM runs away."""
    swing_foot_orientation: NotNegative[PerAngularAccelerationSquared] = 10.0
    """Orientation of the swing foot."""
    contact_force: Positive[PerNewtonSquared] = 1e-6
    """Contact forces: spreads the load over the feet."""
    contact_moment: Positive[PerNewtonMeterSquared] = 1e-4
    """Contact moments: keeps the center of pressure near the middle of each sole."""
    internal_contact_force: NotNegative[PerNewtonSquared] = 3e-5
    """Internal contact force: horizontal forces of the feet against each other. Large
    enough to prevent them where they have no use, small enough to allow them where
    knees at their limit need them."""
    internal_contact_moment: NotNegative[PerNewtonMeterSquared] = 1e-3
    """Internal contact moment: moments of the feet against each other about the
    vertical."""
    least_posture: Positive[PerAngularAccelerationSquared] = 1e-5
    """Least weight of a joint's posture, whatever the user's share: keeps the QP well
    posed, far below any task."""
    user_yielding: NotNegative[Ratio] = 100.0
    """Factor by which the posture of a joint weighs less at the user's full share than
    at none, before it fades to zero. Any weight holds the posture of a joint that no
    other task moves; when the user moves the joint fast, a large weight would make the
    whole body work against the user."""


@dataclass(frozen=True)
class ContactModel(Configuration):
    """Contact of each sole with the ground, as the controller assumes it."""

    friction: Positive[Ratio] = 0.5
    """Friction coefficient assumed by the QP; lower than that of the intended grounds,
    as a reserve."""
    length_margin: NotNegative[Meters] = 0.015
    """Width of the strip at toe and heel that is closed to the center of pressure."""
    width_margin: NotNegative[Meters] = 0.010
    """Width of the strip at both sides that is closed to the center of pressure."""
    toes: Positive[Meters] = 0.03
    """Length of the strip that carries a foot on its toes, or on its heel."""
    middle: Positive[Meters] = 0.01
    """Half the side of the square that counts as the middle of a sole: a point, but
    with room for the solver's tolerance."""
    yaw_moment_arm: NotNegative[Meters] = 0.05
    """Greatest moment about the normal through the sole's middle, as a lever arm of the
    friction force. Friction at the corners gives more, with which turns are jerks."""
    unloaded_share: Positive[Ratio] = 0.15
    """Normal force that the QP may count on below a planted sole on which no force is
    measured, in weights of the robot. Efforts that count on a ground that is not there
    spin the light foot by tens of rad/s within a few ticks."""
    load_growth: Positive[Ratio] = 2.5
    """Normal force that the QP may count on beyond that, relative to the measured one:
    a sole is trusted with the full weight after three ticks."""
    near: NotNegative[Meters] = 0.01
    """Height of a planted sole's lowest corner over its ground up to which the QP
    counts on the sole though no force is measured."""
    near_share: NotNegative[Ratio] = 0.8
    """Normal force that the QP may count on below such a sole, in weights of the robot.
    A robot that hops by a centimeter would else fall freely: the QP yields as long as
    it feels no force, and there is no force as long as it yields."""
    pressed: NotNegative[Meters] = 0.045
    """Depth below its ground toward which a planted sole moves that carries next to
    nothing."""
    explored: Positive[Meters] = 0.015
    """Distance from where the center of pressure has been up to which a sole that is
    not down as a whole is counted on."""
    least_felt: NotNegative[Ratio] = 0.05
    """Load of a sole from which its center of pressure counts, in weights of the
    robot."""
    turned: NotNegative[Radians] = 0.03
    """Turn of a sole from which other places of it carry than before."""
    moved: NotNegative[Meters] = 0.05
    """Distance of a sole from where it landed from which it stands elsewhere."""
    light: NotNegative[Ratio] = 0.02
    """Load below which a sole carries next to nothing, in weights of the robot: a
    planted one is pressed down, and one that is lifted is in the air."""
    lifted: NotNegative[Meters] = 0.02
    """Height of a sole's lowest corner above its ground from which such a foot is in
    the air."""
    full_load: Positive[Ratio] = 3.0
    """Upper bound of the normal force on one sole, in weights of the robot."""


@dataclass(frozen=True)
class JointLimitGains(Configuration):
    """Bounds on the accelerations of legs and back that keep them off their stops."""

    kp: NotNegative[PerSecondSquared] = 270.0
    """Stiffness."""
    kd: NotNegative[PerSecond] = 33.0
    """Damping."""
    margin: NotNegative[Radians] = 0.02
    """Distance kept from each end stop."""


@dataclass(frozen=True)
class MomentumGains(Configuration):
    """Angular momentum: for balance where the CoP does not suffice, and given back."""

    dead_zone: NotNegative[Meters] = 0.03
    """Distance of the desired CoP outside the support polygon that needs none."""
    largest_shift: NotNegative[Meters] = 0.03
    """Largest distance of the centroidal moment pivot from the CoP for balance."""
    unplanned_share: Share = 0.5
    """Share of the legs' offset of the pivot that the plan does not know by which the
    pivot moves; by the rest the CoP moves the other way. The foot's rise and fall, most
    of it, last for a tenth of a second: the CoP comes less often to the sole's edge,
    and the error of the DCM hardly grows."""
    upright: PdGains = PdGains(kp=20.0, kd=9.0)
    """Angular acceleration with which a tilted trunk comes upright: what a swing or a
    push has put into it."""
    largest_restoring: NotNegative[Meters] = 0.015
    """Largest distance of the centroidal moment pivot from the CoP for that: as much as
    the soles can spare."""


@dataclass(frozen=True)
class ControlGains(Configuration):
    """Everything that tunes the whole-body controller."""

    weights: QpWeights = field(default_factory=QpWeights)
    contact: ContactModel = field(default_factory=ContactModel)
    joint_limits: JointLimitGains = field(default_factory=JointLimitGains)
    com_height: PdGains = PdGains(kp=40.0, kd=12.0)
    """Height of the center of mass."""
    com_height_quick: PdGains = PdGains(kp=20.0, kd=7.0)
    """The same in quick level steps of WALK: stiffer ones throw the robot up after each
    landing."""
    dcm_gain: NotNegative[Ratio] = 2.0
    """Gain k of the DCM feedback: the center of pressure moves by (1 + k) times the
    error of the DCM."""
    momentum: MomentumGains = field(default_factory=MomentumGains)
    """Angular momentum."""
    orientation: PdGains = PdGains(kp=100.0, kd=37.0)
    """Pelvis and chest."""
    stance_foot_damping: NotNegative[PerSecond] = 20.0
    """Damping of a foot that carries load, per unit of inertia."""
    swing_position: PdGains = PdGains(kp=360.0, kd=40.0)
    """Position of the swing foot: as stiff as a step for balance needs, which else
    lands up to a decimeter short. At 450 the knees reach their limit down stairs."""
    swing_orientation: PdGains = PdGains(kp=200.0, kd=28.0)
    speed_hold: NotNegative[Seconds] = 0.02
    """Damping with which the motors of back and legs on the ground keep the planned
    speeds of their joints between two control ticks, in their greatest effort per
    rad/s; 0 for motors that give the planned efforts alone. Without it a robot bears
    weaker punches; a leg in the air that held its speeds would land with more load."""
    posture: PdGains = PdGains(kp=80.0, kd=18.0)
    leg_posture_weight: NotNegative[Ratio] = 0.02
    """Of a leg on the ground."""
    swing_leg_posture_weight: NotNegative[Ratio] = 0.005
    """Of a leg whose foot is in the air: at lift-off its almost straight knee has to
    bend at once, and a heavier posture would throw the pelvis up instead."""
    back_posture_weight: NotNegative[Ratio] = 0.1
    """Of the back."""
    arm_posture_weight: NotNegative[Ratio] = 2.0
    """Of an arm's joint with the greatest inertia; of others as much less as theirs."""
