"""The steps of a walk: as commanded, and as they will be taken, or why they are not.

Data, and pure functions of these data. The phases determine the timing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from atlas_drake.behaviors.footsteps import (
    merge,
    next_runs,
    out_of_reach,
    pace_changed,
    replaced,
    step_data_from,
)
from atlas_drake.behaviors.walk.config import WalkConfig
from atlas_drake.control.feet.footstep import (
    ensure_clearance,
    heading_error,
    landing_error,
    limit_duration,
    resolve_height,
    saturate,
)
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages import (
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorStepData,
    AtlasBehaviorWalkParams,
)
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import LEFT, FootPose, Footstep
from atlas_drake.planning.demo_steps import demo_steps
from atlas_drake.planning.footholds import Gait

LOOK_AHEAD = NUM_REQUIRED_WALK_STEPS
"""Number of steps in the plan."""
ROUNDING = 1e-9
"""A step that saturation moves by at most this much counts as unchanged [m], [rad]."""
_NO_STEP = AtlasBehaviorStepData().freeze()


@dataclass(frozen=True)
class StepPreview:
    """Coming steps of the walk, as commanded and as executed."""

    commanded: tuple[Footstep, ...]  # Heights in W; one in the air as executed
    steps: tuple[Footstep, ...]  # As they will be executed; one in the air first
    blocked: Footstep | None = None  # The step after these steps, if it cannot be taken
    obstacle: str = ""  # Why the blocked step cannot be taken; empty if there is none

    @cached_property
    def reported(self) -> tuple[AtlasBehaviorStepData, ...]:
        """The steps as frozen messages, filled up with empty ones."""
        steps = tuple(step_data_from(step).freeze() for step in self.steps)
        return steps + (_NO_STEP,) * (NUM_REQUIRED_WALK_STEPS - len(steps))


@dataclass(frozen=True)
class WalkProgress:
    """Feet and steps of a walk in any phase."""

    feet: tuple[FootPose, FootPose]  # Poses of the soles, the last ones on the ground
    aimed: tuple[FootPose, FootPose]  # Landing poses aimed at; at first, ``feet``
    pending: tuple[Footstep, ...]  # Steps not begun, by index
    next_index: int  # Index of the next step to begin
    request: BehaviorRequest  # The last request whose steps were read
    config: WalkConfig  # Limits of the steps
    in_air: Footstep | None = None  # Step being taken; None while both feet are down
    last_foot: int | None = None  # Foot of the step begun last; None before the first
    last_index: int = 0  # Index of the step begun last; 0 before the first step
    warned: frozenset[tuple[int, str]] = frozenset()  # Step and topic of each warning
    recovery_index: int = 0  # Index of the last step of the walk's own; 0 at first
    in_place: int = 0  # Number of steps in place that may still begin

    @property
    def last_was_recovery(self) -> bool:
        """True if the step begun last was not commanded."""
        return 0 < self.last_index == self.recovery_index

    @property
    def feet_to_come(self) -> list[FootPose]:
        """Poses of the soles, with the landing pose of a foot in the air."""
        feet = list(self.feet)
        if self.in_air is not None:
            feet[self.in_air.foot] = self.in_air.pose
        return feet

    @property
    def known(self) -> tuple[Footstep, ...]:
        """The next steps without a gap in their indices, as many as are planned."""
        return next_runs(self.pending, self.next_index, LOOK_AHEAD)

    @cached_property
    def preview(self) -> StepPreview:
        """The coming steps, each saturated from the feet of the step before."""
        return read_only(look_ahead(self))

    @property
    def coming(self) -> tuple[Footstep, ...]:
        """The coming steps as they will be executed, one in the air first."""
        return self.preview.steps

    def beginning_with(self, step: Footstep) -> tuple[Footstep, ...]:
        """Returns ``step``, and the pending steps with a higher index."""
        return (step, *(other for other in self.pending if other.index > step.index))


def steps_asked_for(
    pending: tuple[Footstep, ...],
    params: AtlasBehaviorWalkParams,
    feet: Sequence[FootPose],
    first_open: int,
    gait: Gait,
    last_foot: int | None = None,
) -> tuple[Footstep, ...]:
    """Returns the coming steps after a message.

    ``feet`` has the landing pose of a foot in the air; the demo walk begins with the
    foot after ``last_foot``.
    """
    if params.use_demo_walk:
        foot = LEFT if last_foot is None else 1 - last_foot
        return demo_steps(feet, first_open, foot, gait)
    return merge(
        pending, params.step_queue, first_open, params.use_relative_step_height
    )


def read_message(
    progress: WalkProgress, request: BehaviorRequest, gait: Gait
) -> WalkProgress:
    """Merges the steps of a new message with those that have not begun."""
    if not request.is_newer(progress.request):
        return progress
    params, last = request.command.walk_params, progress.request.command.walk_params
    progress = replace(progress, request=request)
    if params.use_demo_walk and last.use_demo_walk:
        return progress
    merged = replace(
        progress,
        pending=steps_asked_for(
            () if last.use_demo_walk else progress.pending,
            params,
            progress.feet_to_come,
            progress.next_index,
            gait,
            progress.last_foot,
        ),
    )
    # A step that a new message replaces may be warned of again.
    new = replaced(progress.known, merged.known)
    warned = frozenset(about for about in progress.warned if about[0] not in new)
    return replace(merged, warned=warned, in_place=0)


def look_ahead(progress: WalkProgress) -> StepPreview:
    """Saturates the coming steps, each relative to the step before.

    The step in the air is not changed.
    """
    steps, commanded, in_air = [], [], progress.in_air
    poses, aims = progress.feet_to_come, list(progress.aimed)
    if in_air is not None:
        steps.append(in_air)
        commanded.append(in_air)
        aims[in_air.foot] = in_air.pose
    limits = progress.config.limits
    loose = progress.config.slack.loosen(limits)
    firm = replace(limits, rise=loose.rise)
    last_foot = progress.last_foot
    for step in progress.known:
        if len(steps) >= LOOK_AHEAD:
            break
        start, stance = poses[step.foot], poses[1 - step.foot]
        goal = resolve_height(step, stance, limits)
        # The steps know the ground: a brick under the stance foot changes no level.
        known = stance if step.relative else aims[1 - step.foot]
        change = float(goal.p_WF[2] - known.p_WF[2])
        taken = saturate(goal, stance, firm)
        pose = taken.pose
        if max(landing_error(goal, pose), heading_error(goal, pose)) > ROUNDING:
            # A landing error of the stance foot shall not reduce the next step: the
            # limits count from the aimed pose, and with slack from the landed pose.
            aim = at_height(aims[1 - step.foot], stance)
            taken = saturate(saturate(goal, aim, firm), stance, loose)
        obstacle = obstacle_to(goal, taken, stance, change, last_foot, loose)
        if obstacle:
            return StepPreview(tuple(commanded), tuple(steps), step, obstacle)
        taken = limit_duration(
            ensure_clearance(taken, start, limits), start, stance, limits
        )
        commanded.append(goal)
        steps.append(taken)
        poses[taken.foot] = aims[taken.foot] = taken.pose
        last_foot = taken.foot
    return StepPreview(tuple(commanded), tuple(steps))


def at_height(pose: FootPose, ground: FootPose) -> FootPose:
    """Returns ``pose`` at the height of ``ground``."""
    return FootPose(np.append(pose.p_WF[:2], ground.p_WF[2]), pose.R_WF)


def obstacle_to(
    goal: Footstep,
    taken: Footstep,
    stance: FootPose,
    change: float,
    last_foot: int | None,
    limits: StepLimits,
) -> str:
    """Determines why a step cannot be taken at all; empty if it can.

    ``change`` is its height above the place at which the stance foot was aimed [m].
    """
    if goal.foot == last_foot:
        return "two steps in a row are for the same foot"
    climb = float(goal.p_WF[2] - stance.p_WF[2])
    if abs(climb) > limits.rise:
        way = "up" if climb > 0.0 else "down"
        return f"step {goal.index} leads {abs(climb):.2f} m {way}, which is too much"
    # A shortened step may miss the level that it leads to.
    away = landing_error(goal, taken.pose)
    if abs(change) > limits.level and away > limits.astray:
        return f"step {goal.index} leads to another level and is out of reach"
    return ""


def with_warnings(
    progress: WalkProgress, time: float
) -> tuple[WalkProgress, tuple[Event, ...]]:
    """Warns once of each coming step that differs from its command."""
    preview = progress.preview
    events: tuple[Event, ...] = ()
    for goal, step in zip(preview.commanded, preview.steps, strict=True):
        events += out_of_reach(time, goal, step) + pace_changed(time, goal, step)
    blocked = preview.blocked
    if blocked is not None:
        text = f"WALK will end before step {blocked.index}: {preview.obstacle}"
        data = {"index": blocked.index, "about": "obstacle"}
        events += (Event(time, "warning", text, data),)
    news = tuple(event for event in events if _subject(event) not in progress.warned)
    if not news:
        return progress, ()
    return replace(progress, warned=progress.warned.union(map(_subject, news))), news


def _subject(warning: Event) -> tuple[int, str]:
    """Returns the index of a warning's step, and its topic: place, pace or obstacle."""
    return warning.data["index"], warning.data["about"]
