"""MANIPULATE: stand with a servoed pelvis.

Pelvis and center of mass follow the requested pose, clamped to poses in which the robot
can stand. Trunk and pelvis turn as one; arms and neck keep their positions.
``pelvis_reach`` determines the possible poses.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.behaviors.entry import BehaviorTools
from atlas_drake.config import Configuration, NotNegative
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.feet.leg_pose import LegPose
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorPelvisServoParams,
)
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan
from atlas_drake.parts.manipulate.pelvis_demo import (
    DemoMovements,
    demo_amplitude,
    demo_pose,
)
from atlas_drake.parts.manipulate.pelvis_pose import (
    PelvisLead,
    PelvisMotion,
    PelvisPose,
    PelvisRange,
    PelvisRates,
    Stance,
    at_rest,
    make_stance,
)
from atlas_drake.parts.manipulate.pelvis_reach import PelvisReach, PelvisReserves
from atlas_drake.rotations import tilt_of
from atlas_drake.units import Meters, Ratio


@dataclass(frozen=True)
class ManipulateConfig(Configuration):
    """Parameters of MANIPULATE."""

    range: PelvisRange = field(default_factory=PelvisRange)
    """Range of pelvis poses."""
    reserves: PelvisReserves = field(default_factory=PelvisReserves)
    """Reserves for balance, which limit the pelvis poses further."""
    rates: PelvisRates = field(default_factory=PelvisRates)
    """Speed and acceleration of pelvis and CoM."""
    lead: PelvisLead = field(default_factory=PelvisLead)
    """Largest lead of the reference over a robot that does not follow."""
    foot_slip: NotNegative[Meters] = 0.002
    """Re-latch the pose of a sole that slipped farther than this. Small, because all
    poses are relative to the soles."""
    arms_moved: NotNegative[Meters] = 0.01
    """Clamp the requested pose again when the CoM of trunk and arms has moved this far
    in the pelvis frame, for example when the user's arms reach out."""
    demo: DemoMovements = field(default_factory=DemoMovements)
    """Amplitudes of the demo's movements."""
    home: NotNegative[Ratio] = 0.002
    """Hand over to STAND when the reference is this near to STAND's pose, in
    meters and in radians."""


@dataclass(frozen=True)
class ManipulateState:
    """State of MANIPULATE: requested pose, goal and reference of the pelvis."""

    stance: Stance  # Latched poses of the feet
    commanded: PelvisPose  # The requested pose, not clamped
    goal: PelvisPose  # The requested pose, clamped
    home: PelvisPose  # STAND's pose, at which MANIPULATE begins and ends
    motion: PelvisMotion  # The reference, which moves towards the goal
    upper: np.ndarray  # Trunk and arms at the time of the last clamping
    sensed: PelvisPose  # The measured pose
    request: BehaviorRequest | None = None  # Last request read; None: read it again
    demo_time: float | None = None  # Time since the demo began [s]; None without demo
    demo_share: float = 0.0  # Share of the demo's movement that the legs allow [-]
    waits: bool = False  # The user controls a leg joint, and the reference rests

    def dcm_reference(self, omega: float) -> DcmReference:
        """Computes the references of DCM and CoP for the pendulum's frequency [1/s]."""
        com = self.motion.com
        return DcmReference(
            dcm=com.position + com.velocity / omega,
            cop=com.position - com.acceleration / omega**2,
        )


class Manipulate(BehaviorProtocol):
    """Balance on both feet with a servoed pelvis."""

    def __init__(self, tools: BehaviorTools, config: ManipulateConfig):
        self._balance = tools.balance
        self._reach = PelvisReach(tools.robot, config.range, config.reserves)
        self._nominal_height = tools.nominal_height
        self._posture_rates = tools.rates
        self._config = config
        self._rates, self._demo = config.rates, config.demo
        self._lead = config.lead
        robot = tools.robot
        self._back = robot.limb("back")
        self._legs = robot.limb("l_leg", "r_leg")

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> ManipulateState:
        """Starts from the present body reference and DCM."""
        here = self._here(observation, body)
        return self._pursue(self._listen(here, observation, request), observation)

    def update(
        self,
        state: ManipulateState,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Computes one tick; ``leaving`` brings the robot back to STAND's pose."""
        waited, waits = state.waits, observation.user_holds(self._legs)
        state = replace(state, waits=waits)
        changed = (waited and not waits) or self._arms_moved(state, observation)
        if leaving and state.request is not None:
            state = replace(state, demo_time=None, request=None)
            changed = True
        elif not leaving and request.is_newer(state.request):
            state = self._listen(state, observation, request)
            changed = True
        if observation.has_slipped(state.stance.feet, self._config.foot_slip):
            state = replace(state, stance=self._note_feet(observation))
            changed = True
        if changed:
            state = self._pursue(state, observation, leaving)
        if waits:
            # The user controls leg joints: a motion of the pelvis could tip the robot
            # over.
            state = replace(state, goal=state.motion.pose(state.stance))
        elif state.demo_time is not None:
            time = state.demo_time + observation.dt
            goal = demo_pose(state.home, self._demo, state.demo_share, time)
            state = replace(state, goal=goal, demo_time=time)

        motion = state.motion.held_near(observation.terms, self._lead)
        motion = motion.towards(state.goal, state.stance, self._rates, observation.dt)
        state = replace(
            state, motion=motion, sensed=state.stance.measure(observation.terms)
        )
        body = self._body(observation, body, motion)
        omega = observation.pendulum_frequency(float(state.stance.middle[2]))
        command = self._balance.command(
            observation,
            body,
            state.dcm_reference(omega),
            omega,
            state.stance.support,
            self._balance.standing(observation, state.stance.feet),
        )
        there = motion.pose(state.stance)
        remaining = max(abs(x - y) for x, y in zip(there, state.goal, strict=True))
        return Outcome(
            state=state,
            body=body,
            command=command,
            finished=leaving and (waits or remaining < self._config.home),
        )

    def idle(self, state: ManipulateState, observation: Observation) -> ManipulateState:
        """Updates the measured pose only: goal and reference rest."""
        return replace(state, sensed=state.stance.measure(observation.terms))

    def resume(
        self,
        state: ManipulateState,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
    ) -> ManipulateState:
        """Continues with the requested pose, or the demo, from the present pose."""
        resumed = replace(
            self._here(observation, body),
            commanded=state.commanded,
            request=state.request,
            demo_time=state.demo_time,
            demo_share=state.demo_share,
        )
        return self._pursue(resumed, observation)

    def plan(self, state: ManipulateState, com: np.ndarray, omega: float) -> Plan:
        """Returns the present references of CoM, DCM and CoP."""
        reference = state.dcm_reference(omega)
        return Plan(
            support=state.stance.support.vertices,
            omega=omega,
            com_reference=state.motion.com.position,
            dcm_reference=reference.dcm,
            cop_reference=reference.cop,
        )

    def feedback(
        self, state: ManipulateState, status_flags: int
    ) -> AtlasBehaviorManipulateFeedback:
        """Returns the clamped, the commanded and the measured pose of the pelvis."""
        return AtlasBehaviorManipulateFeedback(
            status_flags,
            AtlasBehaviorPelvisServoParams(*state.goal),
            AtlasBehaviorPelvisServoParams(*state.motion.pose(state.stance)),
            AtlasBehaviorPelvisServoParams(*state.sensed),
        )

    def _here(self, observation: Observation, body: BodyReference) -> ManipulateState:
        """Returns the state whose goal is the present pose."""
        stance = self._note_feet(observation)
        motion = self._motion_from(observation, body, stance)
        pose = motion.pose(stance)
        return ManipulateState(
            stance=stance,
            commanded=pose,
            goal=pose,
            home=self._home(observation, stance),
            motion=motion,
            upper=self._reach.upper_body(observation.terms, stance),
            sensed=stance.measure(observation.terms),
        )

    # ---- requested pose ------------------------------------------------------

    def _listen(
        self, state: ManipulateState, observation: Observation, request: BehaviorRequest
    ) -> ManipulateState:
        """Reads a request."""
        state = replace(state, request=request)
        params = request.command.manipulate_params
        if params.use_demo_mode:
            if state.demo_time is not None:
                return state
            upper = self._reach.upper_body(observation.terms, state.stance)
            near: list[LegPose | None] = [None, None]
            share = demo_amplitude(
                state.home,
                self._demo,
                lambda pose: self._reach.allows(pose, state.stance, upper, near),
            )
            return replace(state, demo_time=0.0, demo_share=share)
        if params.use_desired:
            commanded = _pose(params.desired)
        elif state.demo_time is not None:
            # Stay at the last pose of the demo.
            commanded = state.goal
        else:
            commanded = state.commanded
        return replace(state, commanded=commanded, demo_time=None)

    def _pursue(
        self, state: ManipulateState, observation: Observation, leaving: bool = False
    ) -> ManipulateState:
        """Sets the goal to the requested pose, clamped, or back to STAND's."""
        upper = self._reach.upper_body(observation.terms, state.stance)
        home = self._home(observation, state.stance)
        home = self._reach.attainable(home, state.stance, upper)
        if leaving:
            goal = home
        else:
            goal = self._reach.clamp(state.commanded, home, state.stance, upper)
        return replace(state, home=home, goal=goal, upper=upper)

    def _arms_moved(self, state: ManipulateState, observation: Observation) -> bool:
        upper = self._reach.upper_body(observation.terms, state.stance)
        moved = upper - state.upper
        return float(moved @ moved) > self._config.arms_moved**2

    # ---- references ----------------------------------------------------------

    def _motion_from(
        self, observation: Observation, body: BodyReference, stance: Stance
    ) -> PelvisMotion:
        """Converts the present body reference into a reference of the pelvis."""
        terms = observation.terms
        omega = observation.pendulum_frequency(float(stance.middle[2]))
        com = stance.support.clamp(feedback.dcm(terms, omega))
        height = body.height - float(terms.com[2] - terms.p_WP[2])
        roll, pitch = body.pelvis_tilt
        return PelvisMotion(
            height=at_rest(np.array([height]), np.array([body.height_rate])),
            turn=at_rest(
                np.array([body.yaw, pitch, roll]), np.array([body.yaw_rate, 0.0, 0.0])
            ),
            com=at_rest(com),
        )

    def _body(
        self, observation: Observation, body: BodyReference, motion: PelvisMotion
    ) -> BodyReference:
        """Computes the reference of trunk and posture for ``motion``.

        The QP controls the height of the center of mass. Its reference is that of the
        pelvis plus the present height of the CoM above the pelvis, so that the errors
        of height and speed are those of the pelvis.
        """
        terms = observation.terms
        yaw, pitch, roll = motion.turn.position
        tilt = np.array([roll, pitch])
        # Straighten the back first; then trunk and pelvis turn as one.
        step = self._posture_rates.tilt * observation.dt
        if observation.user_holds(self._back):
            bend = tilt_of(terms.R_WC) - tilt
        else:
            bend = body.chest_tilt - body.pelvis_tilt
            bend = bend - np.clip(bend, -step, step)
        # Arms and neck keep their positions, or those that the user gave them. The legs
        # follow their measured positions: pelvis and feet determine them.
        follow = observation.user_held | self._legs
        joints = np.where(follow, terms.q, body.joints)
        straighten = self._back & ~observation.user_held
        step = self._posture_rates.joints * observation.dt
        joints[straighten] += np.clip(
            self._balance.robot.stand_prep[straighten] - joints[straighten], -step, step
        )
        above = float(terms.com[2] - terms.p_WP[2])
        rising = float(terms.com_velocity[2] - terms.V_WP[5])
        return BodyReference(
            height=float(motion.height.position[0]) + above,
            height_rate=float(motion.height.velocity[0]) + rising,
            yaw=float(yaw),
            yaw_rate=float(motion.turn.velocity[0]),
            pelvis_tilt=tilt,
            chest_tilt=tilt + bend,
            joints=joints,
        )

    def _home(self, observation: Observation, stance: Stance) -> PelvisPose:
        """Returns STAND's pose with the present arms."""
        above = float(observation.terms.com[2] - observation.terms.p_WP[2])
        return PelvisPose(height=self._nominal_height - above)

    # ---- feet ----------------------------------------------------------------

    def _note_feet(self, observation: Observation) -> Stance:
        left, right = observation.foot_poses
        return make_stance(left, right, self._balance.support(left, right))


def _pose(params: AtlasBehaviorPelvisServoParams) -> PelvisPose:
    return PelvisPose(
        float(params.pelvis_height),
        float(params.pelvis_yaw),
        float(params.pelvis_pitch),
        float(params.pelvis_roll),
        float(params.com_v0),
        float(params.com_v1),
    )
