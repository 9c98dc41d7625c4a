"""Turns references of DCM, feet and body into the QP's command.

The only module of the behaviors that calls the feedback laws of ``control``. Each
behavior chooses its own references of feet and center of mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.behaviors.body_sway import BodySway, arm_swing
from atlas_drake.config import Configuration, NotNegative, Positive
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.balance.foothold import (
    WHOLE,
    Foothold,
    corner_heights,
    corners_down,
    observed,
)
from atlas_drake.control.feet.sole import sole_patches, toe_corners
from atlas_drake.control.feet.sole_motion import SoleMotion, at_rest
from atlas_drake.control.gains import ControlGains
from atlas_drake.control.whole_body.angular_momentum import (
    legs_offset,
    swing_inertia,
    trunk_inertia,
)
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.contact import Contact, ContactPatch
from atlas_drake.control.whole_body.contact_tasks import (
    ComTask,
    InternalContactTask,
    MomentTask,
)
from atlas_drake.control.whole_body.model import standing_terms
from atlas_drake.control.whole_body.tasks import (
    FrameTask,
    OrientationTask,
    PostureTask,
    Task,
    orientation_acceleration,
    position_acceleration,
)
from atlas_drake.control.whole_body.terms import FrameTerms
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages.controller_status import MAX_CORNERS
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose
from atlas_drake.planning.footholds import STANCE_WIDTH
from atlas_drake.robot import Robot
from atlas_drake.rotations import rotation_z
from atlas_drake.support_polygon import (
    SupportPolygon,
    area,
    convex_hull,
    thinned,
)
from atlas_drake.units import GRAVITY, Meters, NewtonMeters

_STILL = read_only(np.zeros(6))


@dataclass(frozen=True)
class StanceConfig(Configuration):
    """How the robot stands."""

    width: Positive[Meters] = STANCE_WIDTH
    """Distance between the soles' middles of feet side by side."""
    com_drop: NotNegative[Meters] = 0.02
    """Lowering of the center of mass in standing and walking below the stand-prep pose:
    bent knees give the trailing leg its reach."""
    balance_effort: NotNegative[NewtonMeters] = 15.0
    """Effort that a behavior must be able to apply at hip pitch and ankle pitch of a
    leg to balance with the leg."""


class FootCommand(NamedTuple):
    """Command of one foot."""

    task: FrameTask  # Motion of the sole
    contact: Contact | None = None  # With the ground; None for a foot in the air
    acceleration: np.ndarray = _STILL  # Of the reference of the sole, shape (6,)


class Balance:
    """Feedback around given references for one robot. Holds constants only."""

    def __init__(
        self,
        robot: Robot,
        gains: ControlGains,
        stance: StanceConfig | None = None,
        sway: BodySway | None = None,
    ):
        self.robot = robot
        self.gains = gains
        self.stance = stance or StanceConfig()
        self.sway = sway or BodySway()
        self._arm_swing = arm_swing(robot, self.sway.arms)
        self.weight = robot.mass * GRAVITY
        self._legs = tuple(leg.joints for leg in robot.legs)
        standing = standing_terms(robot)
        self.swing_inertia = swing_inertia(standing, self._legs)
        self._trunk_inertia = trunk_inertia(standing, self._legs)
        legs = robot.limb("l_leg", "r_leg")
        back = robot.limb("back")
        inertia = np.diag(standing.M)[-robot.num_joints :]
        greatest = max(inertia[~(legs | back)].tolist(), default=1.0)
        # A jolt that turns the hand on a weak wrist must not throw the whole body.
        arm_weight = gains.arm_posture_weight * (inertia / greatest)
        self._joint_weight = np.where(
            legs,
            gains.leg_posture_weight,
            np.where(back, gains.back_posture_weight, arm_weight),
        )
        self._joint_weight_in_air = tuple(
            np.where(
                robot.limb(leg), gains.swing_leg_posture_weight, self._joint_weight
            )
            for leg in ("l_leg", "r_leg")
        )
        self._back = np.flatnonzero(back)
        self._frames = tuple(foot.sole_frame for foot in robot.file.feet)
        self._patches = sole_patches(robot.file.sole, gains.contact)
        weights = gains.weights
        self._stance_weight = np.full(6, weights.stance_foot)
        self._swing_weight = np.repeat(
            [weights.swing_foot_orientation, weights.swing_foot_position], 3
        )
        self._lowering_weight = self._swing_weight.copy()
        self._lowering_weight[5] = weights.swing_foot_lowering
        tilt, yaw = weights.chest_tilt, weights.chest_yaw
        self._chest_weight = np.array([tilt, tilt, yaw])
        tilt, yaw = weights.pelvis_tilt, weights.pelvis_yaw
        self._pelvis_weight = np.array([tilt, tilt, yaw])
        self._moment_weight = np.full(2, weights.moment)
        self._com_weight = np.array([weights.com, weights.com, weights.com_height])
        self._com_weight_quick = np.array(
            [weights.com, weights.com, weights.com_height_quick]
        )
        force = weights.internal_contact_force
        self._internal = InternalContactTask(
            (self._frames[0], self._frames[1]),
            np.array([weights.internal_contact_moment, force, force]),
        )
        read_only(vars(self))

    def command(
        self,
        observation: Observation,
        body: BodyReference,
        reference: DcmReference,
        omega: float,
        support: SupportPolygon,
        feet: tuple[FootCommand, FootCommand],
        quick: bool = False,
    ) -> WholeBodyCommand:
        """Builds the QP's command that tracks ``reference`` within ``support``.

        A ``quick`` step raises the center of mass softly; ``omega`` is the natural
        frequency of the pendulum [1/s].
        """
        terms, gains = observation.terms, self.gains
        desired = self._desired_cmp(observation, reference, omega)
        # Legs move as the CoM will, not as it would on a CMP out of the soles' reach.
        offset = self._leg_offset(observation, feet, support.clamp(desired), omega)
        unplanned = offset - reference.offset
        desired = desired + gains.momentum.unplanned_share * unplanned
        offset += self._restoring_offset(observation, body) + terms.pull_offset
        cop, cmp = self.pivots(desired, offset, support)
        # Enhanced centroidal moment pivot: g/ω² below the virtual repellent point.
        x, y = cop.tolist()
        p_WE = np.array([x, y, terms.com[2] - GRAVITY / (omega * omega)])
        com_acceleration = np.empty(3)
        com_acceleration[:2] = feedback.com_acceleration_for_cmp(terms.com, cmp, omega)
        com_acceleration[2] = feedback.height_acceleration(
            terms,
            body.height,
            body.height_rate,
            gains.com_height_quick if quick else gains.com_height,
        )
        softly = quick and com_acceleration[2] > 0.0
        turn = -self.sway.pelvis
        pelvis = orientation_acceleration(
            body.R_WP(turn * body.lead),
            np.array([0.0, 0.0, body.yaw_rate + turn * body.lead_rate]),
            terms.R_WP,
            terms.V_WP[:3],
            gains.orientation,
        )
        return self.on_feet(
            feet,
            PostureTask(self.posture(observation, body), self._posture_weight(feet)),
            *self._chest_task(observation, body),
            OrientationTask(self.robot.file.pelvis, pelvis, self._pelvis_weight),
            MomentTask(p_WE, self._moment_weight),
            ComTask(
                com_acceleration, self._com_weight_quick if softly else self._com_weight
            ),
        )

    def _chest_task(
        self, observation: Observation, body: BodyReference
    ) -> tuple[OrientationTask, ...]:
        """Builds the task that brings the chest upright; none if the user has the back.

        The pelvis must neither bring the user's chest upright nor keep it still.
        """
        if observation.user_holds(self._back):
            return ()
        terms = observation.terms
        acceleration = orientation_acceleration(
            body.R_WC,
            np.array([0.0, 0.0, body.yaw_rate]),
            terms.R_WC,
            terms.w_WC,
            self.gains.orientation,
        )
        chest = self.robot.file.chest
        return (OrientationTask(chest, acceleration, self._chest_weight),)

    def on_feet(
        self, feet: tuple[FootCommand, FootCommand], posture: PostureTask, *tasks: Task
    ) -> WholeBodyCommand:
        """Builds the QP's command of two feet, a posture and further tasks."""
        left, right = feet
        contacts = tuple([foot.contact for foot in feet if foot.contact is not None])
        if len(contacts) == len(feet):
            tasks += (self._internal,)
        return WholeBodyCommand(posture, (left.task, right.task, *tasks), contacts)

    def desired_cop(
        self,
        observation: Observation,
        reference: DcmReference,
        omega: float,
        support: SupportPolygon,
    ) -> np.ndarray:
        """Computes the CoP that tracks ``reference`` with legs at rest [m], (2,)."""
        return support.clamp(self._desired_cmp(observation, reference, omega))

    def _desired_cmp(
        self, observation: Observation, reference: DcmReference, omega: float
    ) -> np.ndarray:
        error = feedback.dcm(observation.terms, omega) - reference.dcm
        return feedback.feedback_cmp(error, reference.cmp, self.gains.dcm_gain)

    def _leg_offset(
        self,
        observation: Observation,
        feet: tuple[FootCommand, FootCommand],
        cmp: np.ndarray,
        omega: float,
    ) -> np.ndarray:
        """Computes how far the legs' momentum moves the CMP from the CoP [m], (2,).

        The motion of a leg whose joints the user has is not known.
        """
        terms = observation.terms
        return legs_offset(
            terms,
            [None if observation.user_holds(leg) else leg for leg in self._legs],
            [foot.acceleration for foot in feet],
            feedback.com_acceleration_for_cmp(terms.com, cmp, omega),
        )

    def _restoring_offset(
        self, observation: Observation, body: BodyReference
    ) -> np.ndarray:
        """Computes the offset of the CMP that brings the trunk upright [m], (2,).

        What a swing or a push has put into the trunk would stay there until the waist
        is at its stop. Without the back the trunk is the user's.
        """
        if observation.user_holds(self._back):
            return np.zeros(2)
        momentum, terms = self.gains.momentum, observation.terms
        still = np.array([0.0, 0.0, body.yaw_rate])
        up = orientation_acceleration(
            body.R_WC, still, terms.R_WC, terms.w_WC, momentum.upright
        )
        heading = rotation_z(body.yaw)[:2, :2]
        x, y = (heading.T @ up[:2]).tolist()
        about_x, about_y = self._trunk_inertia
        offset = heading @ np.array([about_y * y, -about_x * x])
        size = math.hypot(*offset)
        return offset * min(momentum.largest_restoring / max(size, 1e-9), 1.0)

    def pivots(
        self, desired: np.ndarray, offset: np.ndarray, support: SupportPolygon
    ) -> tuple[np.ndarray, np.ndarray]:
        """Computes CoP and CMP for a ``desired`` CMP [m], each of shape (2,).

        The CoP is within ``support``, and the CMP away from it by the ``offset`` of the
        moving legs; by more only if the CoP does not suffice.
        """
        momentum, wanted = self.gains.momentum, desired - offset
        cop = support.clamp(wanted)
        beyond = wanted - cop
        distance = math.hypot(*beyond)
        if distance <= momentum.dead_zone:
            return cop, cop + offset
        shift = min(distance - momentum.dead_zone, momentum.largest_shift)
        return cop, cop + offset + (shift / distance) * beyond

    def posture(self, observation: Observation, body: BodyReference) -> np.ndarray:
        """Computes joint accelerations towards the posture [rad/s²], shape (n,)."""
        gains, terms = self.gains.posture, observation.terms
        if body.lead == 0.0:
            return gains.kp * (body.joints - terms.q) - gains.kd * terms.v
        swing = np.where(observation.user_held, 0.0, self._arm_swing)
        q, v = body.joints + body.lead * swing, body.lead_rate * swing
        return gains.kp * (q - terms.q) + gains.kd * (v - terms.v)

    def _posture_weight(self, feet: tuple[FootCommand, FootCommand]) -> np.ndarray:
        """Weights of the joints' posture, smaller in a leg whose foot is in the air."""
        for foot, weight in zip(feet, self._joint_weight_in_air, strict=True):
            if foot.contact is None:
                return weight
        return self._joint_weight

    def touchdown(
        self, observation: Observation, foot: int, load: float
    ) -> FootCommand:
        """Commands a foot that just landed, with a load of at least ``load`` weights.

        The load turns the sole flat onto the ground.
        """
        return FootCommand(
            self._resting(observation, foot, self._stance_weight),
            self._contact(foot, self._patches.middle, math.inf, load),
        )

    def in_contact(
        self,
        observation: Observation,
        foot: int,
        max_load: float = math.inf,
        planted: FootPose | None = None,
    ) -> FootCommand:
        """Commands a foot in contact to rest, loaded by at most ``max_load`` weights.

        A sole that carries little is not counted on for more than it may soon carry,
        and only where it is known to carry. If it carries next to nothing although it
        is ``planted`` there, it is pressed onto the ground, flat as it was; as long as
        an edge of it is near that ground, it is counted on.
        """
        # Below a sole that carries little a moment would only turn the foot.
        little = self._felt(observation, foot) < self.gains.contact.unloaded_share
        patch = self._patches.middle if little else self._patches.whole
        part = observation.footholds[foot].part
        if part is not None:
            patch = replace(patch, corners=part)
        trusted = self._trusted(observation, foot, planted)
        if planted is not None and self._is_light(observation, foot):
            task = self._pressed(observation, foot, planted)
        else:
            # Pressed, a sole that carries would take load that balance gives to the
            # other one, and keep the CoP from its edge.
            task = self._resting(observation, foot, self._stance_weight)
        return FootCommand(task, self._contact(foot, patch, min(max_load, trusted)))

    def footholds(
        self, so_far: tuple[Foothold, Foothold], observation: Observation
    ) -> tuple[Foothold, Foothold]:
        """Returns what is known of both footholds in this tick."""
        left, right = (
            self._foothold(so_far[foot], observation, foot) for foot in (LEFT, RIGHT)
        )
        return left, right

    def _foothold(
        self, so_far: Foothold, observation: Observation, foot: int
    ) -> Foothold:
        ground, model = so_far.ground, self.gains.contact
        if ground is None:
            return so_far
        sole, corners = observation.terms.feet[foot], self._patches.whole.corners
        x, y, _ = (sole.p_WF - ground.p_WF).tolist()
        if math.hypot(x, y) > model.moved:
            return WHOLE
        if self._felt(observation, foot) < model.least_felt:
            return so_far
        down = corners_down(ground, sole, corners)
        if down.all():
            # There is ground below all of it, even if the heel rises later.
            return WHOLE
        cop = observation.foot_cop(foot)
        return observed(so_far, down, sole.R_WF[:, 2], cop, corners, model)

    def carrying_share(self, pose: FootPose) -> float:
        """Computes the share of a sole's area that carries [-]."""
        whole = self._patches.whole.corners
        return 1.0 if pose.part is None else area(pose.part) / area(whole)

    def airborne(
        self,
        observation: Observation,
        planted: tuple[FootPose, FootPose] | None = None,
    ) -> int | None:
        """Returns the foot in the air; None while both are down, or neither is.

        Its ground is where it was ``planted``, or else level with the other sole.
        """
        left, right = observation.terms.feet
        if planted is None:
            grounds = [float(right.p_WF[2]), float(left.p_WF[2])]
        else:
            grounds = [float(pose.p_WF[2]) for pose in planted]
        flying = [
            self._is_light(observation, foot)
            and self._lowest(sole) - ground > self.gains.contact.lifted
            for foot, sole, ground in zip(
                (LEFT, RIGHT), (left, right), grounds, strict=True
            )
        ]
        return flying.index(True) if sum(flying) == 1 else None

    def _lowest(self, foot: FrameTerms) -> float:
        """Returns the height of a sole's lowest corner in W [m]."""
        sole, (along, across, _) = self.robot.file.sole, foot.R_WF[2].tolist()
        sunk = 0.5 * (abs(along) * sole.length + abs(across) * sole.width)
        return float(foot.p_WF[2]) - sunk

    def _felt(self, observation: Observation, foot: int) -> float:
        """Returns the load on a foot, in weights of the robot."""
        felt = float(observation.foot_force[foot]) / self.weight
        # At the first tick the robot is taken to stand.
        return self.gains.contact.full_load if math.isnan(felt) else felt

    def _is_light(self, observation: Observation, foot: int) -> bool:
        """Returns True if a foot carries next to nothing."""
        return self._felt(observation, foot) < self.gains.contact.light

    def _trusted(
        self, observation: Observation, foot: int, planted: FootPose | None = None
    ) -> float:
        """Computes the load that a foot may soon carry, in weights of the robot."""
        model = self.gains.contact
        felt = max(self._felt(observation, foot), 0.0)
        trusted = model.unloaded_share + model.load_growth * felt
        if planted is None or trusted >= model.near_share:
            return trusted
        sole, corners = observation.terms.feet[foot], self._patches.whole.corners
        lowest = float(corner_heights(planted, sole, corners).min())
        return model.near_share if lowest < model.near else trusted

    def standing(
        self, observation: Observation, planted: tuple[FootPose, FootPose]
    ) -> tuple[FootCommand, FootCommand]:
        """Commands both feet to rest where they are ``planted``."""
        left, right = (
            self.in_contact(observation, foot, planted=planted[foot])
            for foot in (LEFT, RIGHT)
        )
        return left, right

    def unloaded(self, observation: Observation, foot: int) -> FootCommand:
        """Commands a foot in the air to come to rest."""
        return FootCommand(self._resting(observation, foot, self._swing_weight))

    def swinging(
        self, observation: Observation, foot: int, reference: SoleMotion
    ) -> FootCommand:
        """Commands a foot in the air to follow ``reference``."""
        task = self._following(observation, foot, reference, self._swing_weight)
        if task.target[5] < 0.0:
            task = replace(task, weight=self._lowering_weight)
        return FootCommand(
            task, acceleration=np.concatenate([reference.alpha_WF, reference.a_WF])
        )

    def toeing_off(
        self,
        observation: Observation,
        foot: int,
        reference: SoleMotion,
        max_load: float,
    ) -> FootCommand:
        """Commands a foot on its toes, whose heel follows ``reference``."""
        return FootCommand(
            self._following(observation, foot, reference, self._stance_weight),
            self._contact(foot, self._patches.toes, max_load),
        )

    def rolling_flat(
        self, observation: Observation, foot: int, reference: SoleMotion, toes: bool
    ) -> FootCommand:
        """Commands a foot on its toes or heel to turn flat along ``reference``."""
        patch = self._patches.toes if toes else self._patches.heel
        return FootCommand(
            self._following(observation, foot, reference, self._stance_weight),
            self._contact(foot, patch, self._trusted(observation, foot)),
        )

    def _resting(
        self, observation: Observation, foot: int, weight: np.ndarray
    ) -> FrameTask:
        """Builds the task that brings a sole to rest."""
        acceleration = feedback.stance_acceleration(
            observation.terms.feet[foot], self.gains.stance_foot_damping
        )
        return FrameTask(self._frames[foot], acceleration, weight)

    def _pressed(
        self, observation: Observation, foot: int, planted: FootPose
    ) -> FrameTask:
        """Builds the task that brings a light sole back to its ground, and flat."""
        p_WF = observation.terms.feet[foot].p_WF.copy()
        p_WF[2] = planted.p_WF[2] - self.gains.contact.pressed
        below = at_rest(FootPose(p_WF, planted.R_WF))
        return self._following(observation, foot, below, self._stance_weight)

    def _following(
        self,
        observation: Observation,
        foot: int,
        reference: SoleMotion,
        weight: np.ndarray,
    ) -> FrameTask:
        """Builds the task that moves a sole along ``reference``."""
        gains, terms = self.gains, observation.terms.feet[foot]
        acceleration = np.empty(6)
        acceleration[:3] = reference.alpha_WF + orientation_acceleration(
            reference.R_WF,
            reference.w_WF,
            terms.R_WF,
            terms.V_WF[:3],
            gains.swing_orientation,
        )
        acceleration[3:] = reference.a_WF + position_acceleration(
            reference.p_WF,
            reference.v_WF,
            terms.p_WF,
            terms.V_WF[3:],
            gains.swing_position,
        )
        return FrameTask(self._frames[foot], acceleration, weight)

    def _contact(
        self, foot: int, patch: ContactPatch, max_load: float, min_load: float = 0.0
    ) -> Contact:
        return Contact(
            self._frames[foot],
            patch,
            max_normal_force=min(max_load, self.gains.contact.full_load) * self.weight,
            min_normal_force=min_load * self.weight,
            force_weight=self.gains.weights.contact_force,
            moment_weight=self.gains.weights.contact_moment,
        )

    def toes(self, toeing: FootPose) -> SupportPolygon:
        """Computes the region of the CoP for a foot on its toes, from its flat pose."""
        contact, sole = self.gains.contact, self.robot.file.sole
        half_width = sole.width / 2 - contact.width_margin
        half_length, toes = sole.length / 2, contact.toes
        return SupportPolygon(toe_corners(toeing, half_length, half_width, toes))

    def support_on_toes(self, flat: FootPose, toeing: FootPose) -> SupportPolygon:
        """Computes the region of the CoP with one foot flat, the other on its toes."""
        toes = self.toes(toeing).vertices
        points = convex_hull(np.concatenate([self._corners(flat), toes]))
        return SupportPolygon(thinned(points, MAX_CORNERS))

    def support(self, *feet: FootPose) -> SupportPolygon:
        """Computes the region of the CoP with these feet on the ground."""
        points = convex_hull(np.concatenate([self._corners(foot) for foot in feet]))
        return SupportPolygon(thinned(points, MAX_CORNERS))

    def _corners(self, foot: FootPose) -> np.ndarray:
        """Computes the corners of what carries of a sole, in W [m], shape (k, 2)."""
        corners = self._patches.whole.corners if foot.part is None else foot.part
        return foot.p_WF[:2] + corners @ foot.R_WF[:2, :2].T
