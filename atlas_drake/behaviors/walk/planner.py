"""Makes the phases of a walk, each with its initial DCM plan.

``both_feet`` and ``single_support`` determine when a phase ends. The
mathematics of the plan is in ``gait``; that of the steps, in ``steps``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import Observation
from atlas_drake.behaviors.footsteps import recovery_event
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.behaviors.walk.gait import (
    begun_at,
    capture_step,
    landing_sensitivity,
    plan_walk,
    square_up_step,
    stance_cop,
)
from atlas_drake.behaviors.walk.phases import (
    FinalTransfer,
    InitialTransfer,
    Transfer,
    WalkPhase,
    WalkProgress,
    WalkSwing,
)
from atlas_drake.behaviors.walk.steps import (
    StepPreview,
    look_ahead,
    subject,
    warnings_about,
)
from atlas_drake.control.balance import feedback
from atlas_drake.control.balance.dcm_plan import DcmPlan, Pendulum
from atlas_drake.control.feet.footstep import landing_error, outward, way_around
from atlas_drake.control.feet.sole_motion import FLAT, Pitch
from atlas_drake.control.feet.swing_foot import FootSwing, begin_swing
from atlas_drake.frozen import replace
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import LEFT, RIGHT, FootPose, Footstep
from atlas_drake.rotations import rotation_z
from atlas_drake.support_polygon import SupportPolygon

P = TypeVar("P", bound=WalkPhase)


class WalkPlanner:
    """Plans phases from feet and steps.

    Holds constants, and the latest step preview, which changes only with the progress,
    though the feedback reads it in every tick.
    """

    def __init__(self, balance: Balance, pendulum: Pendulum, config: WalkConfig):
        self._balance = balance
        self._pendulum = pendulum
        self._config = config
        self._half_length = balance.robot.file.sole.length / 2
        self._passing = config.limits.passing
        self._latest: tuple[WalkProgress, Footstep | None, StepPreview] | None = None

    # ---- steps ---------------------------------------------------------------

    def step_preview(
        self, progress: WalkProgress, in_air: Footstep | None = None
    ) -> StepPreview:
        """Saturates the coming steps, beginning with the one in the air."""
        latest = self._latest
        if latest and latest[0] is progress and latest[1] is in_air:
            return latest[2]
        step_preview = look_ahead(
            progress, in_air, self._config.limits, self._config.slack
        )
        self._latest = progress, in_air, step_preview
        return step_preview

    def coming(
        self, progress: WalkProgress, in_air: Footstep | None = None
    ) -> tuple[Footstep, ...]:
        """Returns the coming steps as they will be executed, one in the air first."""
        return self.step_preview(progress, in_air).steps

    def warn(self, phase: P, time: float) -> tuple[P, tuple[Event, ...]]:
        """Warns once of each coming step that differs from its command."""
        progress = phase.progress
        step_preview = self.step_preview(progress, phase.in_air)
        news = warnings_about(step_preview, progress.warned, time)
        warned = progress.warned.union(map(subject, news))
        return replace(phase, progress=replace(progress, warned=warned)), news

    # ---- phases --------------------------------------------------------------

    def initial_transfer(
        self, progress: WalkProgress, dcm: np.ndarray, cop: np.ndarray
    ) -> InitialTransfer:
        """Makes the weight shift from the given DCM and CoP in W [m], shape (2,)."""
        support = self.support(progress)
        duration = self._config.timing.first_shift
        coming = self.coming(progress)
        plan = self._plan(progress, coming, cop, duration)
        return InitialTransfer(
            progress=progress,
            plan=begun_at(plan, dcm, support),
            support=support,
            duration=duration,
            unloading=coming[0].foot if coming else None,
        )

    def recover(
        self, progress: WalkProgress, observation: Observation
    ) -> tuple[WalkSwing, tuple[Event, ...]]:
        """Makes the swing of a step that catches a DCM outside the feet."""
        progress = replace(progress, feet=observation.foot_poses)
        step = self._recovery_step(progress, observation, goes_on=False)
        return self._catch(progress, step, observation.time)

    def step_again(
        self, progress: WalkProgress, observation: Observation
    ) -> tuple[WalkSwing, tuple[Event, ...]] | None:
        """Makes the swing in which the foot that just landed catches the DCM.

        The steps to come follow it. None if the other foot gets nearer to the DCM, and
        if the DCM has not left the sole mainly to its outer side: only there the other
        foot would have to cross; ahead and behind it steps as it would have.
        """
        foot = progress.last_foot
        if foot is None or not self._is_aside(foot, progress, observation):
            return None
        step = self._recovery_step(progress, observation, goes_on=True)
        if step.foot != foot:
            return None
        again = replace(step, index=progress.last_index)
        return self._catch(progress, again, observation.time)

    def _is_aside(
        self, foot: int, progress: WalkProgress, observation: Observation
    ) -> bool:
        """Returns True if the DCM lies beyond the outer side of a sole."""
        pose = progress.feet[foot]
        dcm = feedback.dcm(observation.terms, self._pendulum.omega)
        beyond_W = dcm - self._balance.support(pose).clamp(dcm)
        ahead, left = rotation_z(pose.yaw)[:2, :2].T @ beyond_W
        return bool(outward(foot) * left > abs(ahead))

    def _recovery_step(
        self, progress: WalkProgress, observation: Observation, goes_on: bool
    ) -> Footstep:
        feet, terms = progress.feet, observation.terms
        airborne = self._balance.airborne(observation)
        return capture_step(
            progress.next_index,
            (LEFT, RIGHT) if airborne is None else (airborne,),
            feet,
            (self._balance.support(feet[0]), self._balance.support(feet[1])),
            terms.com[:2],
            feedback.dcm(terms, self._pendulum.omega),
            self._pendulum.omega,
            self._config,
            goes_on,
        )

    def _catch(
        self, progress: WalkProgress, step: Footstep, time: float
    ) -> tuple[WalkSwing, tuple[Event, ...]]:
        begun = replace(
            progress,
            aimed=progress.feet,
            pending=_before_later_ones(step, progress),
            next_index=step.index,
            last_foot=None,
            recovery_index=step.index,
        )
        swing = self.swing(begun, 0.0)
        return swing, (recovery_event(time, swing.step),)

    def square_up(self, progress: WalkProgress) -> WalkProgress | None:
        """Adds a square-up step after a recovery step; None if none is needed."""
        if not progress.last_was_recovery or progress.last_foot is None:
            return None
        foot = 1 - progress.last_foot
        step = square_up_step(
            progress.next_index,
            foot,
            progress.feet[progress.last_foot],
            self._balance.stance.width,
            self._config,
        )
        if landing_error(step, progress.feet[foot]) < self._config.rules.feet_apart:
            return None
        pending = _before_later_ones(step, progress)
        return replace(progress, pending=pending, recovery_index=step.index)

    def swing(
        self, progress: WalkProgress, late: float, pitch: Pitch = FLAT
    ) -> WalkSwing:
        """Makes the swing of the next step, shortened by ``late`` [s].

        Its foot leaves the ground with a ``pitch`` about its toes.
        """
        step = self.coming(progress)[0]
        duration = self._config.timing.swing(step.duration) - late
        start, stance = progress.feet[step.foot], progress.feet[1 - step.foot]
        cop = stance_cop(progress.feet, step, self._config)
        begun = replace(
            progress,
            pending=tuple(s for s in progress.pending if s.index > step.index),
            next_index=step.index + 1,
            last_foot=step.foot,
            last_index=step.index,
        )
        coming = self.coming(begun, step)
        motion = begin_swing(
            start,
            duration,
            self._half_length,
            pitch,
            self._landing_pitch(stance, coming),
            way_around(step, start, stance, self._passing, 2.0 * self._half_length),
        )
        return WalkSwing(
            stops=len(coming) == 1,
            progress=begun,
            plan=self._plan(begun, coming, cop, duration, motion),
            support=self._balance.support(stance),
            duration=duration,
            step=step,
            sent=next(s for s in progress.pending if s.index == step.index),
            motion=motion,
            sensitivity=landing_sensitivity(
                cop, duration, progress.feet, coming, self._config, self._pendulum
            ),
        )

    def _landing_pitch(self, stance: FootPose, coming: Sequence[Footstep]) -> float:
        """Computes the pitch with which a step lands [rad]."""
        step, *later = coming
        onward = later[0].pose if later else None
        return self._config.roll.landing(stance, step.pose, onward)

    def move_landing(
        self, phase: WalkSwing, step: Footstep, sooner: float
    ) -> WalkSwing:
        """Replans a swing for another landing place, and a ``sooner`` touchdown [s]."""
        duration = phase.duration - sooner
        progress = phase.progress
        cop = stance_cop(progress.feet, step, self._config)
        coming = self.coming(progress, step)
        motion = phase.motion.landing_sooner(sooner)
        return replace(
            phase,
            step=step,
            plan=self._plan(progress, coming, cop, duration, motion),
            stops=len(coming) == 1,
            duration=duration,
            motion=motion,
        )

    def land(
        self,
        progress: WalkProgress,
        cop: np.ndarray,
        early: float,
        landed: float = 0.0,
        stops: bool = False,
    ) -> Transfer | FinalTransfer:
        """Makes the phase after a touchdown ``early`` by [s]: transfer or settling.

        The foot landed with a pitch of ``landed`` [rad]. After a swing that ``stops``
        the DCM is near the middle of the feet. Steps that came too late for that plan
        begin with a shift of the weight, as from rest.
        """
        coming = self.coming(progress)
        if not coming or stops:
            return self.final_transfer(progress, cop)
        # The next touchdown is planned one step duration after this planned touchdown.
        duration = self._config.timing.transfer(coming[0].duration)
        change = self._config.rules.transfer_change * duration
        duration += min(max(early, -change), change)
        leaving = coming[0].foot
        rear, front = progress.feet[leaving], progress.feet[1 - leaving]
        # Below the toes of a sole that carries in part only there may be no ground.
        whole = rear.part is None
        toe_off = self._config.roll.leaving(rear, front) if whole else 0.0
        return Transfer(
            progress=progress,
            plan=self._plan(progress, coming, cop, duration),
            support=self.support(progress, leaving if toe_off else None),
            duration=duration,
            unloading=leaving,
            toe_off=toe_off,
            toe_off_time=duration,
            landed=landed,
        )

    def support(
        self, progress: WalkProgress, on_toes: int | None = None
    ) -> SupportPolygon:
        """Computes the region of the CoP under both feet, one of them on its toes."""
        if on_toes is None:
            return self._balance.support(*progress.feet)
        flat, toeing = progress.feet[1 - on_toes], progress.feet[on_toes]
        return self._balance.support_on_toes(flat, toeing)

    def final_transfer(self, progress: WalkProgress, cop: np.ndarray) -> FinalTransfer:
        """Makes the end of a walk, from a CoP reference in W [m], shape (2,)."""
        step_preview = self.step_preview(progress)
        duration = self._config.timing.settle
        return FinalTransfer(
            progress=progress,
            plan=self._plan(progress, step_preview.steps, cop, duration),
            support=self.support(progress),
            duration=duration,
            obstacle="" if step_preview.steps else step_preview.obstacle,
        )

    def _plan(
        self,
        progress: WalkProgress,
        coming: Sequence[Footstep],
        cop: np.ndarray,
        first_phase: float,
        in_air: FootSwing | None = None,
    ) -> DcmPlan:
        feet, config = progress.feet, self._config
        return plan_walk(cop, first_phase, feet, coming, in_air, config, self._pendulum)


def _before_later_ones(step: Footstep, progress: WalkProgress) -> tuple[Footstep, ...]:
    """Returns the steps not begun, with ``step`` in place of those up to its index."""
    return (step, *(other for other in progress.pending if other.index > step.index))
