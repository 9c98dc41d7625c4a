"""What the phases of STEP share: references of body, CoM and loads, begun steps.

``both_feet`` and ``single_support`` have the controls of the phases.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from atlas_drake.behaviors.balance import FootCommand
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.body_reference import BodyTarget
from atlas_drake.behaviors.entry import BehaviorTools
from atlas_drake.behaviors.footsteps import out_of_reach, pace_changed
from atlas_drake.behaviors.phases import PhaseControl
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmReference
from atlas_drake.control.feet.footstep import resolve_height
from atlas_drake.control.feet.leg_kinematics import highest_com, hips_from_com
from atlas_drake.control.feet.sole_motion import pitched_pose
from atlas_drake.frozen import replace
from atlas_drake.messages import ToeOff
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.messages.footstep import FootPose, Footstep, StepAction
from atlas_drake.parts.step.action import demo_step, desired_step
from atlas_drake.parts.step.config import StepConfig
from atlas_drake.parts.step.phases import (
    Rest,
    StepPhase,
    StepProgress,
    StepSettle,
    StepShift,
)
from atlas_drake.parts.step.plan import StepPlan, StepPlanner
from atlas_drake.parts.step.step_swing import plan_step_swing
from atlas_drake.parts.step.weight_shift import (
    WeightShift,
    plan_weight_shift,
    sway_duration,
)
from atlas_drake.rotations import mean_yaw
from atlas_drake.support_polygon import SupportPolygon, load_share_range


@dataclass(frozen=True)
class Reach:
    """Poses that the legs have to reach."""

    height: float  # Height of the center of mass in W, if the legs can reach it [m]
    now: Sequence[FootPose]  # Present poses of the soles; on landing, if in the air
    later: Sequence[tuple[int, FootPose]]  # Foot and pose after the weight shift


class StepTools:
    """Plans weight shifts and steps, and commands the feet. Holds constants only."""

    def __init__(self, tools: BehaviorTools, config: StepConfig):
        self.balance = tools.balance
        self.rules = config.rules
        self.profile = config.swing
        self._nominal_height = tools.nominal_height
        self.planner = StepPlanner(
            self.balance, self._nominal_height, config.limits, config.posture
        )
        self._gait = tools.gait
        self._action = config.action
        usual = {**vars(config.action.usual), "knee_nominal": self.planner.nominal_knee}
        self._default = StepAction(**usual)

    def omega(self, observation: Observation, feet: tuple[FootPose, ...]) -> float:
        """Computes the natural frequency of the pendulum on ``feet`` [1/s]."""
        ground = sum(float(foot.p_WF[2]) for foot in feet) / len(feet)
        return observation.pendulum_frequency(ground)

    def dcm_outside(
        self, phase: StepPhase, observation: Observation, support: SupportPolygon
    ) -> float:
        """Computes the distance of the DCM outside ``support``, negative inside [m]."""
        omega = self.omega(observation, phase.feet)
        return support.distance_outside(feedback.dcm(observation.terms, omega))

    def shift_to(
        self,
        observation: Observation,
        end: np.ndarray,
        action: StepAction,
        feet: tuple[FootPose, ...],
        support: SupportPolygon,
    ) -> WeightShift:
        """Plans a weight shift to ``end`` from the present state of the robot."""
        omega = self.omega(observation, feet)
        distance = float(np.hypot(*(end - observation.terms.com[:2])))
        least = sway_duration(distance, action.max_body_accel)
        return plan_weight_shift(
            feedback.dcm(observation.terms, omega),
            end,
            max(action.sway_duration, least),
            support,
            self.rules.cop_inside,
            omega,
        )

    def reach_at_rest(self, feet: tuple[FootPose, FootPose]) -> Reach:
        """Returns the reach with the body half-way between the feet."""
        ground = 0.5 * float(feet[0].p_WF[2] + feet[1].p_WF[2])
        return Reach(ground + self._nominal_height, feet, list(enumerate(feet)))

    def height_over(self, stance: FootPose, step: Footstep) -> float:
        """Computes the requested height of the center of mass of a step, in W [m]."""
        return float(stance.p_WF[2]) + self.planner.height(step.action)

    def body_target(self, phase: StepPhase, reach: Reach) -> BodyTarget:
        """Returns trunk and posture at the requested height, or the legs' reach."""
        com = phase.shift.motion(phase.shift_time)[0]
        legs, now = self.planner.legs, reach.now
        highest = min(
            highest_com(legs, phase.hips, com, enumerate(now)),
            highest_com(legs, phase.hips, phase.shift.end, reach.later),
        )
        tilt = np.array([0.0, phase.lean])
        return BodyTarget(
            height=min(reach.height, highest),
            yaw=mean_yaw(now[0].yaw, now[1].yaw),
            joints=self.balance.robot.stand_prep,
            pelvis_tilt=tilt,
            chest_tilt=tilt,
        )

    def is_early(self, phase: StepPhase) -> bool:
        """Returns True in the first part of the weight shift."""
        return phase.shift_time / phase.shift.duration < self.rules.fresh_share

    def load_range(
        self, phase: StepPhase, foot: int, cop: np.ndarray, on_toes: bool = False
    ) -> tuple[float, float]:
        """Computes the loads that ``foot`` can carry for a CoP, in weights [-]."""
        balance, other = self.balance, phase.feet[foot]
        return load_share_range(
            cop,
            balance.support(phase.feet[1 - foot]),
            balance.toes(other) if on_toes else balance.support(other),
        )

    def with_stance(
        self, observation: Observation, foot: int, command: FootCommand
    ) -> tuple[FootCommand, FootCommand]:
        """Commands ``foot``, and the other foot to stay planted."""
        other = self.balance.in_contact(observation, 1 - foot)
        return (command, other) if foot == 0 else (other, command)

    def touchdown(
        self,
        phase: StepPhase,
        observation: Observation,
        foot: int,
        cop: np.ndarray,
        on_toes: bool = False,
    ) -> tuple[FootCommand, FootCommand]:
        """Commands ``foot`` to be pressed flat, within the load that balance allows."""
        most = self.load_range(phase, foot, cop, on_toes)[1]
        load = min(self.rules.settling_load, most)
        command = self.balance.touchdown(observation, foot, load)
        return self.with_stance(observation, foot, command)

    # ---- the beginning and the end of a step ---------------------------------

    def rest_at_first(self, observation: Observation) -> Rest:
        """Makes the rest with which STEP begins."""
        feet = observation.foot_poses
        return self._rest_on(feet, observation, StepProgress())

    def rest_after(
        self,
        phase: StepShift | StepSettle,
        observation: Observation,
        feet: tuple[FootPose, FootPose],
    ) -> Rest:
        """Makes the rest after a step: the weight shifts to between ``feet``."""
        uneven = abs(float(feet[0].p_WF[2] - feet[1].p_WF[2]))
        return replace(
            self._rest_on(feet, observation, phase.progress),
            last=phase.step,
            touchdown_foot=phase.step.foot,
            lean=phase.lean if uneven > self.rules.level else 0.0,
        )

    def begin(
        self, phase: Rest, observation: Observation, leaving: bool
    ) -> tuple[Rest | StepShift, tuple[Event, ...]]:
        """Plans the whole step and begins the weight shift to the stance foot.

        The robot stays at rest without a requested step, while its DCM is too near the
        edge of the support polygon, and for a step that is out of reach.
        """
        desired = None if leaving else self.requested(phase)
        if desired is None:
            return phase, ()
        outside = self.dcm_outside(phase, observation, phase.support)
        if outside > -self.rules.begin_inside:
            return phase, ()
        feet = observation.foot_poses
        plan = self.planner.plan(observation.terms, feet, desired)
        if plan is None:
            text = f"step {desired.index} is not taken: it is out of reach"
            progress = replace(phase.progress, done=phase.progress.request)
            event = Event(observation.time, STEPS_LEFT, text)
            return replace(phase, progress=progress), (event,)
        step = plan.taken
        # Warn of the slope only: the step spec in the report has duration and swing
        # height.
        slope = replace(
            resolve_height(desired, feet[1 - step.foot], self.planner.limits),
            duration=step.duration,
            swing_height=step.swing_height,
        )
        return self._shift(phase, observation, desired, plan, feet), (
            *out_of_reach(observation.time, desired, step),
            *pace_changed(observation.time, slope, step),
        )

    def requested(self, phase: StepPhase) -> Footstep | None:
        """Returns the requested step that has not begun, if any."""
        progress = phase.progress
        request = progress.request
        if request is None or not request.is_newer(progress.done):
            return None
        params = request.command.step_params
        if params.use_demo_walk:
            index = progress.index + 1
            return demo_step(phase.feet, index, self._default, self._gait)
        feet_z = (float(phase.feet[0].p_WF[2]), float(phase.feet[1].p_WF[2]))
        return desired_step(params, feet_z, self._default, self._action)

    def _rest_on(
        self,
        feet: tuple[FootPose, FootPose],
        observation: Observation,
        progress: StepProgress,
    ) -> Rest:
        middle = 0.5 * (feet[0].p_WF + feet[1].p_WF)[:2]
        support = self.balance.support(*feet)
        return Rest(
            progress=progress,
            feet=feet,
            support=support,
            hips=hips_from_com(observation.terms, self.planner.legs),
            shift=self.shift_to(observation, middle, self._default, feet, support),
        )

    def _shift(
        self,
        phase: Rest,
        observation: Observation,
        desired: Footstep,
        plan: StepPlan,
        feet: tuple[FootPose, FootPose],
    ) -> StepShift:
        step = plan.taken
        start, goal = feet[step.foot], step.pose
        least = self.rules.least_clearance
        action = _below(plan.ceiling, step.action, start, goal, least)
        swing = plan_step_swing(
            pitched_pose(start, plan.heel, self.planner.half_length),
            start,
            goal,
            action.lift_height,
            action.swing_height,
            action.step_duration,
            action.max_foot_vel,
            self.profile,
        )
        support = self.balance.support(*feet)
        shift = self.shift_to(observation, plan.com, action, feet, support)
        middle_z = 0.5 * (start.p_WF[2] + step.p_WF[2])
        action = replace(
            action,
            step_duration=swing.duration,
            sway_duration=shift.duration,
            toe_off=ToeOff.ENABLE if plan.heel else ToeOff.DISABLE,
        )
        progress = replace(phase.progress, index=step.index)
        request = progress.request
        if request is not None and not request.command.step_params.use_demo_walk:
            progress = replace(progress, done=request)
        return StepShift(
            progress=progress,
            feet=feet,
            support=support,
            hips=plan.hips,
            shift=shift,
            lean=plan.lean,
            sent=desired,
            step=replace(
                step,
                duration=swing.duration,
                swing_height=float(swing.top + swing.arc - middle_z),
                action=action,
            ),
            swing=swing,
            heel=plan.heel,
            touchdown_foot=phase.touchdown_foot if self.is_early(phase) else None,
        )


def _below(
    ceiling: float, action: StepAction, start: FootPose, goal: FootPose, least: float
) -> StepAction:
    """Limits the action so that the foot is lifted no higher than ``ceiling`` [m].

    The foot is lifted by at least ``least`` [m] above the footholds in any case.
    """
    room = max(ceiling - float(max(start.p_WF[2], goal.p_WF[2])), least)
    lift = min(action.lift_height, room)
    arc = min(action.swing_height, room - lift)
    return replace(action, lift_height=lift, swing_height=arc)


P = TypeVar("P", bound=StepPhase)


class StepPhaseControl(PhaseControl[P]):
    """Computes the ticks of a phase of STEP and its end. Holds constants only.

    Balance has priority over the loads of a phase: a foot with too large or too small a
    load would keep the CoP away from its desired position.
    """

    def __init__(self, tools: StepTools):
        self._tools = tools

    @abstractmethod
    def reach(self, phase: P) -> Reach:
        """Returns the sole poses that the legs have to reach, and the body's height."""

    def reference(
        self, phase: P, observation: Observation
    ) -> tuple[DcmReference, float]:
        """Computes the references of DCM and CoP, and the pendulum's frequency."""
        omega = self._tools.omega(observation, phase.carrying)
        return phase.dcm_reference(omega), omega

    def cop(self, phase: P, observation: Observation) -> np.ndarray:
        """Computes the desired CoP in W [m], shape (2,)."""
        reference, omega = self.reference(phase, observation)
        support = self.support(phase)
        return self._tools.balance.desired_cop(observation, reference, omega, support)

    def support(self, phase: P) -> SupportPolygon:
        """Returns the present region of the CoP."""
        return phase.support

    def are_both_flat(self, phase: P) -> bool:
        """Returns True if both soles are flat on the ground."""
        return True
