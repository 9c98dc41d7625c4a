"""STEP: one quasi-static step at a time, in any order of the feet.

Phases: SHIFT (weight over the stance foot), SWING (lift and move), LOWER, SETTLE (the
new foot is pressed flat) and REST (weight back between the feet) until the next step is
requested. In single support the center of mass is at rest over the sole; the step does
not depend on momentum.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.behaviors.entry import BehaviorTools
from atlas_drake.behaviors.footsteps import step_data_from
from atlas_drake.control.balance.foothold import ground_below
from atlas_drake.frozen import replace
from atlas_drake.messages import AtlasBehaviorStepFeedback, StepStatus
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import Plan, PlannedPaths
from atlas_drake.messages.event import STEPS_LEFT, Event
from atlas_drake.messages.footstep import FootPose
from atlas_drake.parts.step.action import step_spec_from
from atlas_drake.parts.step.both_feet import (
    RestControl,
    SettleControl,
    ShiftControl,
)
from atlas_drake.parts.step.config import StepConfig
from atlas_drake.parts.step.phases import (
    Lower,
    Rest,
    StepSettle,
    StepShift,
    StepState,
    StepSwing,
)
from atlas_drake.parts.step.single_support import LowerControl, SwingControl
from atlas_drake.parts.step.tools import StepPhaseControl, StepTools


class Step(BehaviorProtocol):
    """Takes one requested step after the other.

    Reads the requests, and calls the control of the present phase: ``RestControl``,
    ``ShiftControl``, ``SwingControl``, ``LowerControl`` or ``SettleControl``.
    """

    def __init__(self, tools: BehaviorTools, config: StepConfig):
        self._balance = tools.balance
        self._rates = config.body
        self._rules = config.rules
        self.tools = StepTools(tools, config)
        self._controls: dict[type[StepState], StepPhaseControl[Any]] = {
            Rest: RestControl(self.tools),
            StepShift: ShiftControl(self.tools),
            StepSwing: SwingControl(self.tools),
            Lower: LowerControl(self.tools),
            StepSettle: SettleControl(self.tools),
        }

    def enter(
        self, observation: Observation, body: BodyReference, request: BehaviorRequest
    ) -> Rest:
        """Rests on both feet; the first step begins at the first tick."""
        return self.tools.rest_at_first(observation)

    def update(
        self,
        phase: StepState,
        observation: Observation,
        body: BodyReference,
        request: BehaviorRequest,
        leaving: bool,
    ) -> Outcome:
        """Steps for one tick.

        With ``leaving`` a foot in the air lands, and no further step begins.
        """
        before, progress = phase, phase.progress
        cut_short = progress.leaving or not self.control(phase).are_both_flat(phase)
        phase = replace(
            phase,
            elapsed=phase.elapsed + observation.dt,
            shift_time=phase.shift_time + observation.dt,
            progress=replace(progress, leaving=leaving and cut_short),
        )
        phase = self._read(phase, request)
        phase, news = self.control(phase).advance(phase, observation, leaving)
        control = self.control(phase)
        phase, feet = control.command_feet(phase, observation)
        target = self.tools.body_target(phase, control.reach(phase))
        body = observation.advance_body(body, target, self._rates)
        reference, omega = control.reference(phase, observation)
        support = control.support(phase)
        command = self._balance.command(
            observation, body, reference, omega, support, feet
        )
        finished = leaving and self._may_stand(phase, observation)
        left = self._left_by_standing(phase, observation) if finished else ()
        return Outcome(
            state=phase,
            body=body,
            command=command,
            finished=finished,
            status_flags=StepStatus.SUBSTATE_SWAYING
            if phase.in_air is None
            else StepStatus.SUBSTATE_STEPPING,
            events=(*news, *left),
            landing=self._landing(before, phase),
        )

    def plan(self, phase: StepState, com: np.ndarray, omega: float) -> Plan:
        """Returns the references of the weight shift and the step in the air."""
        steps = () if phase.in_air is None else (phase.in_air,)
        return phase.plan_of(phase.dcm_reference(omega), omega, steps)

    def paths(self, phase: StepState, com: np.ndarray, omega: float) -> PlannedPaths:
        """Returns the paths of the present weight shift or swing."""
        return phase.paths(omega)

    def feedback(
        self, phase: StepState, status_flags: int
    ) -> AtlasBehaviorStepFeedback:
        """Returns indices, timing and the step as executed."""
        index, taken = phase.progress.index, phase.reported
        feedback = AtlasBehaviorStepFeedback(
            current_step_index=index,
            next_step_index_needed=index + 1,
            status_flags=status_flags,
        )
        if taken is not None:
            feedback.t_step_rem = phase.time_left(self._rules.settle)
            feedback.desired_step_saturated = step_data_from(taken)
            spec = step_spec_from(taken)
            feedback.desired_step_spec_saturated = spec
        return feedback

    def control(self, phase: StepState) -> StepPhaseControl[Any]:
        """Returns what computes the ticks of this phase."""
        return self._controls[type(phase)]

    def _landing(
        self, before: StepState, phase: StepState
    ) -> tuple[int, FootPose] | None:
        """Returns foot and planned ground in the tick of a touchdown."""
        if not isinstance(before, Lower) or not isinstance(phase, StepSettle):
            return None
        foot = phase.step.foot
        return foot, ground_below(phase.feet[foot], phase.step.pose)

    # ---- requests ------------------------------------------------------------

    def _read(self, phase: StepState, request: BehaviorRequest) -> StepState:
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

    def _may_stand(self, phase: StepState, observation: Observation) -> bool:
        """Returns True if STAND may follow, which needs both feet flat.

        If STAND was requested before the landing of a step, the robot must be at rest,
        too.
        """
        if not self.control(phase).are_both_flat(phase):
            return False
        if not phase.progress.leaving:
            return True
        speed = float(np.abs(observation.terms.com_velocity).max())
        slow = speed < self._rules.rest_speed
        return phase.elapsed >= phase.shift.duration and slow

    def _left_by_standing(
        self, phase: StepState, observation: Observation
    ) -> tuple[Event, ...]:
        """Names the steps that STAND leaves out: a started step and a coming step."""
        # A step whose foot is still down is left out, too.
        left = [phase.progress.index] if isinstance(phase, StepShift) else []
        desired, request = self.tools.requested(phase), phase.progress.request
        demo = request is not None and request.command.step_params.use_demo_walk
        if desired is not None and not demo:
            left.append(desired.index)
        if not left:
            return ()
        steps = "step" if len(left) == 1 else "steps"
        text = f"STEP ends without the {steps} {', '.join(map(str, left))}"
        return (Event(observation.time, STEPS_LEFT, text),)
