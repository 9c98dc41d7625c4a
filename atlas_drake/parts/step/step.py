"""STEP: one quasi-static step at a time, in any order of the feet.

Its phases are SHIFT (weight over the stance foot), SWING (lift, move and lower), SETTLE
(the new foot is pressed flat) and REST (weight back between the feet) until the next
step is requested. In single support the center of mass is at rest over the sole; the
step does not depend on momentum. Read ``rest``, ``shift``, ``swing``, ``settle``,
``transitions``, ``plan``, in this order.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, BodyTarget
from atlas_drake.behaviors.entry import BehaviorTools
from atlas_drake.behaviors.footsteps import step_data_from
from atlas_drake.control.balance.foothold import ground_below
from atlas_drake.control.feet.leg_kinematics import highest_com
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasBehaviorStepFeedback, StepStatus
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.messages.footstep import FootPose
from atlas_drake.parts.step.action import step_spec_from
from atlas_drake.parts.step.config import StepConfig
from atlas_drake.parts.step.phase import Decision, StepPhase
from atlas_drake.parts.step.rest import Rest
from atlas_drake.parts.step.settle import Settle
from atlas_drake.parts.step.shift import Shift
from atlas_drake.parts.step.tools import StepTick, StepTools
from atlas_drake.parts.step.transitions import first_rest, next_phase
from atlas_drake.rotations import mean_yaw


class Step(BehaviorProtocol):
    """Takes one requested step after the other. Holds constants only."""

    def __init__(self, tools: BehaviorTools, config: StepConfig):
        self.tools = StepTools(tools, config)
        self._balance = tools.balance
        self._config = config

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> Rest:
        """Rests on both feet; the first step begins at the first tick."""
        return first_rest(StepTick(observation, False, self.tools))

    def update(
        self,
        phase: StepPhase,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Steps for one tick.

        With ``leaving`` a foot in the air lands, and no further step begins.
        """
        tick, progress = StepTick(observation, leaving, self.tools), phase.progress
        cut_short = progress.leaving or not phase.are_both_flat(tick)
        phase = replace(
            phase,
            elapsed=phase.elapsed + observation.dt,
            shift_time=phase.shift_time + observation.dt,
            progress=replace(progress, leaving=leaving and cut_short),
        )
        phase = self._read(phase, request)
        decision = phase.decide(tick)
        phase, events = next_phase(phase, decision, tick)
        feet = phase.command_feet(tick)
        target = self._body_target(phase, tick)
        body = observation.advance_body(body, target, self._config.body)
        omega = tick.omega(phase.carrying)
        command = self._balance.command(
            observation,
            body,
            phase.dcm_reference(omega),
            omega,
            phase.region(tick),
            feet,
        )
        finished = leaving and self._may_stand(phase, tick)
        left = self._left_by_standing(phase, tick) if finished else ()
        in_air = phase.in_air is not None
        return Outcome(
            state=phase,
            body=body,
            command=command,
            finished=finished,
            status_flags=StepStatus.SUBSTATE_STEPPING
            if in_air
            else StepStatus.SUBSTATE_SWAYING,
            events=events + left,
            landing=self._landing(phase) if decision is Decision.LAND else None,
        )

    def plan(self, phase: StepPhase, com: np.ndarray, omega: float) -> Plan:
        """Returns the references of the weight shift and the step in the air."""
        steps = () if phase.in_air is None else (phase.in_air,)
        return phase.plan_of(phase.dcm_reference(omega), omega, steps)

    def paths(self, phase: StepPhase, com: np.ndarray, omega: float) -> PlannedPaths:
        """Returns the paths of the present weight shift or swing."""
        return phase.paths(omega)

    def feedback(
        self, phase: StepPhase, status_flags: int
    ) -> AtlasBehaviorStepFeedback:
        """Returns indices, timing and the step as executed."""
        index, taken = phase.progress.index, phase.reported
        feedback = AtlasBehaviorStepFeedback(
            current_step_index=index,
            next_step_index_needed=index + 1,
            status_flags=status_flags,
        )
        if taken is not None:
            feedback.t_step_rem = phase.time_left(self._config.rules.settle)
            feedback.desired_step_saturated = step_data_from(taken)
            feedback.desired_step_spec_saturated = step_spec_from(taken)
        return feedback

    def _body_target(self, phase: StepPhase, tick: StepTick) -> BodyTarget:
        """Returns trunk and posture at the requested height, or the legs' reach."""
        reach, legs = phase.reach(tick), self.tools.planner.legs
        com = phase.shift.motion(phase.shift_time)[0]
        highest = min(
            highest_com(legs, phase.hips, com, enumerate(reach.now)),
            highest_com(legs, phase.hips, phase.shift.end, reach.later),
        )
        tilt = np.array([0.0, phase.lean])
        return BodyTarget(
            height=min(reach.height, highest),
            yaw=mean_yaw(reach.now[0].yaw, reach.now[1].yaw),
            joints=self._balance.robot.stand_prep,
            pelvis_tilt=tilt,
            chest_tilt=tilt,
        )

    def _landing(self, phase: StepPhase) -> tuple[int, FootPose] | None:
        """Returns foot and planned ground in the tick of a touchdown."""
        assert isinstance(phase, Settle)
        foot = phase.step.foot
        return foot, ground_below(phase.feet[foot], phase.step.pose)

    # ---- requests ------------------------------------------------------------

    def _read(self, phase: StepPhase, request: BehaviorRequest) -> StepPhase:
        """Takes a new message; one that repeats the last one requests no new step.

        As in the original, the step's index need not grow: many clients send 1 always.
        """
        progress = phase.progress
        last = progress.request
        if not request.is_newer(last):
            return phase
        repeats = (
            last is not None
            and last is progress.done
            and request.command.step_params == last.command.step_params
        )
        done = request if repeats else progress.done
        return replace(phase, progress=replace(progress, request=request, done=done))

    # ---- STAND ---------------------------------------------------------------

    def _may_stand(self, phase: StepPhase, tick: StepTick) -> bool:
        """Returns True if STAND may follow, which needs both feet flat.

        If STAND was requested before the landing of a step, the robot must be at rest,
        too.
        """
        if not phase.are_both_flat(tick):
            return False
        if not phase.progress.leaving:
            return True
        speed = float(np.abs(tick.observation.terms.com_velocity).max())
        return phase.elapsed >= phase.shift.duration and speed < tick.rules.rest_speed

    def _left_by_standing(self, phase: StepPhase, tick: StepTick) -> tuple[Event, ...]:
        """Names the steps that STAND leaves out: a started step and a coming step."""
        # A step whose foot is still down is left out, too.
        left = [phase.progress.index] if isinstance(phase, Shift) else []
        desired, request = phase.requested(tick), phase.progress.request
        demo = request is not None and request.command.step_params.use_demo_walk
        if desired is not None and not demo:
            left.append(desired.index)
        if not left:
            return ()
        steps = "step" if len(left) == 1 else "steps"
        text = f"STEP ends without the {steps} {', '.join(map(str, left))}"
        return (Event(tick.observation.time, STEPS_LEFT, text),)
