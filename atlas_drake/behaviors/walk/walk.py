"""WALK: dynamic walking over the steps of messages, then back to STAND.

Phases: SHIFT (weight over the first stance foot), then SWING and TRANSFER for each
step, then SETTLE over both feet. Every change of phase makes a new DCM plan from the
measured poses of the feet, and so does a step adjustment within a swing.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, BodyTarget
from atlas_drake.behaviors.entry import BehaviorTools
from atlas_drake.behaviors.footsteps import replaced
from atlas_drake.behaviors.phases import PhaseControl
from atlas_drake.behaviors.walk.both_feet import DoubleSupport, Settling, steps_left_out
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.phases import (
    FinalTransfer,
    InitialTransfer,
    Transfer,
    WalkProgress,
    WalkState,
    WalkSwing,
)
from atlas_drake.behaviors.walk.planner import WalkPlanner
from atlas_drake.behaviors.walk.single_support import SingleSupport
from atlas_drake.behaviors.walk.steps import feet_to_come, steps_asked_for
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import Pendulum
from atlas_drake.control.balance.foothold import ground_below
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages import NUM_REQUIRED_WALK_STEPS, AtlasBehaviorWalkFeedback
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import LEFT, FootPose, Footstep
from atlas_drake.rotations import mean_yaw

_UPRIGHT = read_only(np.zeros(2))


class Walk(BehaviorProtocol):
    """Walks over given footsteps.

    Reads the requested steps, and calls the control of the present phase:
    ``DoubleSupport``, ``SingleSupport`` or ``Settling``; ``planner`` makes the phases.
    """

    def __init__(self, tools: BehaviorTools, config: WalkConfig):
        self._balance = balance = tools.balance
        self._nominal_height = tools.nominal_height
        self._rates = replace(tools.rates, height=config.rules.height_rate)
        self._config = config
        self._gait = tools.gait
        self._half_length = balance.robot.file.sole.length / 2
        self._omega = feedback.pendulum_frequency(tools.nominal_height)
        pendulum = Pendulum(self._omega, balance.swing_inertia)
        self.planner = WalkPlanner(balance, pendulum, config)
        double_support = DoubleSupport(balance, self.planner, config)
        self._settling = Settling(balance, self.planner, config)
        self._controls: dict[type[WalkState], PhaseControl[Any]] = {
            InitialTransfer: double_support,
            WalkSwing: SingleSupport(balance, self.planner, config),
            Transfer: double_support,
            FinalTransfer: self._settling,
        }

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> InitialTransfer:
        """Begins to shift the weight to the first stance foot."""
        feet = observation.foot_poses
        params = request.command.walk_params
        pending = steps_asked_for((), params, feet, 1, self._gait)
        first = pending[0].index if pending else 1
        progress = WalkProgress(feet, feet, pending, first, request)
        dcm = feedback.dcm(observation.terms, self._omega)
        airborne = self._balance.airborne(observation)
        down = feet if airborne is None else (feet[1 - airborne],)
        support = self._balance.support(*down)
        phase = self.planner.initial_transfer(progress, dcm, support.clamp(dcm))
        return replace(phase, support=support)

    def update(
        self,
        phase: WalkState,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Walks for one tick; ``leaving`` drops the steps that have not begun."""
        before = phase
        phase = self._leave(phase) if leaving else self._read_queue(phase, request)
        phase = replace(
            phase,
            elapsed=phase.elapsed + observation.dt,
            plan_time=phase.plan_time + observation.dt,
        )
        phase, events = self.control(phase).advance(phase, observation, leaving)
        changed = phase.progress.pending is not before.progress.pending
        if before.elapsed == 0.0 or changed:
            phase, news = self.planner.warn(phase, observation.time)
            events = (*events, *news)
        phase, feet = self.control(phase).command_feet(phase, observation)
        body = observation.advance_body(body, self._body_target(phase), self._rates)
        command = self._balance.command(
            observation,
            body,
            phase.dcm_reference(),
            self._omega,
            phase.support,
            feet,
            quick=self._is_quick(phase),
        )
        finished = False
        left: tuple[Event, ...] = ()
        if isinstance(phase, FinalTransfer):
            finished = self._settling.is_over(phase, observation)
            if finished:
                left = steps_left_out(phase, observation.time, leaving)
        return Outcome(
            state=phase,
            body=body,
            command=command,
            finished=finished,
            status_flags=phase.status_flags(leaving),
            events=(*events, *left),
            landing=self._landing(before, phase),
        )

    def plan(self, phase: WalkState, com: np.ndarray, omega: float) -> Plan:
        """Returns the references of the DCM plan and the coming footsteps."""
        in_air = () if phase.in_air is None else (phase.in_air,)
        steps = (*in_air, *phase.progress.known)
        return phase.plan_of(phase.dcm_reference(), phase.plan.omega, steps)

    def paths(self, phase: WalkState, com: np.ndarray, omega: float) -> PlannedPaths:
        """Returns the paths of the DCM plan and of the present swing."""
        return phase.paths(com, self._config.swing)

    def feedback(
        self, phase: WalkState, status_flags: int
    ) -> AtlasBehaviorWalkFeedback:
        """Returns timing and the steps as they will be executed."""
        progress = phase.progress
        step_preview = self.planner.step_preview(progress, phase.in_air)
        first_unknown = progress.next_index + len(progress.known)
        return AtlasBehaviorWalkFeedback(
            t_step_rem=phase.time_to_touchdown(step_preview.steps, self._config.timing),
            current_step_index=progress.last_index,
            next_step_index_needed=min(
                first_unknown, progress.last_index + NUM_REQUIRED_WALK_STEPS
            ),
            status_flags=status_flags,
            step_queue_saturated=list(step_preview.reported),
        )

    def control(self, phase: WalkState) -> PhaseControl[Any]:
        """Returns what computes the ticks of this phase."""
        return self._controls[type(phase)]

    def _landing(
        self, before: WalkState, phase: WalkState
    ) -> tuple[int, FootPose] | None:
        """Returns foot and planned ground once a landed sole is, or should be, flat."""
        foot = phase.progress.last_foot
        if foot is None or isinstance(phase, WalkSwing):
            return None
        rolls = isinstance(phase, Transfer) and phase.landed != 0.0
        if rolls:
            flat_after = self._config.roll.flat_after
            is_flat = before.elapsed < flat_after <= phase.elapsed
        else:
            is_flat = isinstance(before, WalkSwing)
        if not is_flat:
            return None
        return foot, ground_below(phase.progress.feet[foot], phase.progress.aimed[foot])

    def _leave(self, phase: WalkState) -> WalkState:
        """Drops the pending steps: a foot in the air lands, then the robot settles."""
        phase = replace(phase, progress=replace(phase.progress, pending=()))
        if isinstance(phase, InitialTransfer | Transfer):
            return self.planner.final_transfer(phase.progress, phase.planned.cop)
        return phase

    def _read_queue(self, phase: WalkState, request: BehaviorRequest) -> WalkState:
        """Merges the steps of a new message with those that have not begun."""
        progress = phase.progress
        if not request.is_newer(progress.request):
            return phase
        params, last = request.command.walk_params, progress.request.command.walk_params
        progress = replace(progress, request=request)
        if params.use_demo_walk and last.use_demo_walk:
            return replace(phase, progress=progress)
        pending = steps_asked_for(
            () if last.use_demo_walk else progress.pending,
            params,
            feet_to_come(progress, phase.in_air),
            progress.next_index,
            self._gait,
            progress.last_foot,
        )
        # A step that a new message replaces may be warned of again.
        merged = replace(progress, pending=pending)
        new = replaced(progress.known, merged.known)
        warned = frozenset(about for about in progress.warned if about[0] not in new)
        return replace(phase, progress=replace(merged, warned=warned))

    def _step_of(self, phase: WalkState) -> Footstep | None:
        """Returns the present step, or else the next one; None without one."""
        return phase.in_air or next(iter(self.planner.coming(phase.progress)), None)

    def _is_quick(self, phase: WalkState) -> bool:
        """Returns True if the present or next step is quick, on level ground.

        In a slow step, or up and down, a center of mass that sinks bends the knees
        beyond what they carry.
        """
        progress, step = phase.progress, self._step_of(phase)
        if step is None or step.duration > self._config.rules.quick_step:
            return False
        heights = [float(step.p_WF[2]), *(float(f.p_WF[2]) for f in progress.feet)]
        return max(heights) - min(heights) <= self._config.limits.level

    def _roll_share(self, phase: WalkState) -> float:
        """Returns the share of the soles' pitches in the present step, or the next."""
        progress, step = phase.progress, self._step_of(phase)
        if step is None:
            return 0.0
        roll, stance = self._config.roll, progress.feet[1 - step.foot]
        return max(
            roll.share(progress.feet[step.foot], stance), roll.share(stance, step.pose)
        )

    def _body_target(self, phase: WalkState) -> BodyTarget:
        left, right = feet_to_come(phase.progress, phase.in_air)
        low, high = sorted([float(left.p_WF[2]), float(right.p_WF[2])])
        if isinstance(phase, WalkSwing) and not phase.lowers(self._config.swing):
            low = float(phase.progress.feet[1 - phase.step.foot].p_WF[2])
        # With feet at different heights, now or after this step, raise the CoM as far
        # as the lower leg can stretch, so that the knee of the upper leg bends less: a
        # bent knee needs more torque. On its toes the lower foot's middle is higher.
        raised = self._half_length * phase.lower_pitch
        ground = min(high, low + self._config.rules.leg_stretch + raised)
        rise = self._config.com_rise * self._roll_share(phase)
        lead, rate = self._lead(phase)
        return BodyTarget(
            height=ground + self._nominal_height + rise,
            yaw=mean_yaw(left.yaw, right.yaw),
            joints=self._balance.robot.stand_prep,
            pelvis_tilt=_UPRIGHT,
            chest_tilt=_UPRIGHT,
            lead=lead,
            lead_rate=rate,
        )

    def _lead(self, phase: WalkState) -> tuple[float, float]:
        """Computes by how much the left foot leads [m], and the rate [m/s]."""
        if isinstance(phase, FinalTransfer):
            return 0.0, 0.0
        left, right = phase.progress.feet
        (lx, ly), (rx, ry) = left.p_WF[:2].tolist(), right.p_WF[:2].tolist()
        vx = vy = 0.0
        if isinstance(phase, WalkSwing):
            motion = phase.motion
            (x, y), (vx, vy) = motion.xy.tolist(), motion.xy_velocity.tolist()
            if phase.step.foot == LEFT:
                lx, ly = x, y
            else:
                rx, ry, vx, vy = x, y, -vx, -vy
        yaw, most = mean_yaw(left.yaw, right.yaw), self._balance.sway.most_lead
        c, s = math.cos(yaw), math.sin(yaw)
        lead = c * (lx - rx) + s * (ly - ry)
        if abs(lead) > most:
            return math.copysign(most, lead), 0.0
        return lead, c * vx + s * vy
