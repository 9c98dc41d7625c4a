"""What a walk makes of the steps that it knows: as they will be taken, or why not.

Pure functions of the walk's course. Which steps the walk knows is in ``steps``; when
they are taken is decided in its phases.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.behaviors.footstep_event import out_of_reach, pace_changed
from atlas_drake.behaviors.walk.phases import Course
from atlas_drake.behaviors.walk.steps import feet_to_come
from atlas_drake.control.feet.footstep import (
    FootPose,
    Footstep,
    StepSlack,
    ensure_clearance,
    heading_error,
    landing_error,
    limit_duration,
    resolve_height,
    saturate,
)
from atlas_drake.frozen import replace
from atlas_drake.messages import NUM_REQUIRED_WALK_STEPS
from atlas_drake.messages.event import Event
from atlas_drake.robot import StepLimits

LOOK_AHEAD = NUM_REQUIRED_WALK_STEPS
"""Steps that enter the plan."""

ROUNDING = 1e-9
"""A step moved by no more is taken as it was sent [m], [rad]."""
LEVEL = 0.02
"""A step up or down by more leads to another level [m]."""
EDGE = 0.02
"""A step to another level may end so far from its place and still be on it [m]."""


@dataclass(frozen=True)
class Outlook:
    """What the walk makes of the steps it knows.

    Attributes:
        wishes: The steps that the plan looks at as they were sent, heights in W; the
            one in the air as it is taken, for balance may have moved it.
        steps: The same as they will be taken; the one in the air comes first.
        blocked: The step behind them, if it cannot be taken.
        obstacle: Why it cannot.
    """

    wishes: tuple[Footstep, ...]
    steps: tuple[Footstep, ...]
    blocked: Footstep | None = None
    obstacle: str = ""


def look_ahead(
    course: Course, in_air: Footstep | None, limits: StepLimits, slack: StepSlack
) -> Outlook:
    """Saturates the steps to come, one from the other.

    Args:
        course: Of the walk.
        in_air: The step whose foot is in the air, if any; it is taken as it is.
        limits: What a step can be.
        slack: How far a step may exceed the limits to make up for where feet landed.
    """
    steps, wishes = [], []
    poses, aims = feet_to_come(course, in_air), list(course.aimed)
    if in_air is not None:
        steps.append(in_air)
        wishes.append(in_air)
        aims[in_air.foot] = in_air.pose
    loose = slack.loosen(limits)
    firm = replace(limits, rise=loose.rise)
    last_foot = course.last_foot
    for step in course.known:
        if len(steps) >= LOOK_AHEAD:
            break
        start, stance = poses[step.foot], poses[1 - step.foot]
        wish = resolve_height(step, stance, limits)
        taken = saturate(wish, stance, firm)
        pose = taken.pose
        if max(landing_error(wish, pose), heading_error(wish, pose)) > ROUNDING:
            # Where the stance foot landed shall not eat the limits: they may as well
            # count from where it was aimed, and with some slack from where it is.
            aim = at_height(aims[1 - step.foot], stance)
            taken = saturate(saturate(wish, aim, firm), stance, loose)
        obstacle = obstacle_to(wish, taken, stance, last_foot, loose)
        if obstacle:
            return Outlook(tuple(wishes), tuple(steps), step, obstacle)
        taken = limit_duration(
            ensure_clearance(taken, start, limits), start, stance, limits
        )
        wishes.append(wish)
        steps.append(taken)
        poses[taken.foot] = aims[taken.foot] = taken.pose
        last_foot = taken.foot
    return Outlook(tuple(wishes), tuple(steps))


def at_height(pose: FootPose, ground: FootPose) -> FootPose:
    """The same pose at the height of another one."""
    return FootPose(np.append(pose.p_WF[:2], ground.p_WF[2]), pose.R_WF)


def obstacle_to(
    wish: Footstep,
    taken: Footstep,
    stance: FootPose,
    last_foot: int | None,
    limits: StepLimits,
) -> str:
    """Why a step cannot be taken at all; empty if it can.

    Args:
        wish: The step as it was sent, its height in W.
        taken: The same, saturated.
        stance: The foot that it is taken from.
        last_foot: The foot of the step before, if any.
        limits: What a step can be from there.
    """
    if wish.foot == last_foot:
        return "two steps in a row are for the same foot"
    climb = float(wish.p_WF[2] - stance.p_WF[2])
    if abs(climb) > limits.rise:
        way = "up" if climb > 0.0 else "down"
        return f"step {wish.index} leads {abs(climb):.2f} m {way}, which is too much"
    # Nearer by, the ground need not be at that height.
    if abs(climb) > LEVEL and landing_error(wish, taken.pose) > EDGE:
        return f"step {wish.index} leads to another level and is out of reach"
    return ""


def warnings_about(
    outlook: Outlook, told: frozenset[tuple[int, str]], time: float
) -> tuple[Event, ...]:
    """Tells of the steps that are not taken as they were sent, each for once.

    Args:
        outlook: What is to come.
        told: The ``subject`` of each warning given before.
        time: [s]
    """
    events: tuple[Event, ...] = ()
    for wish, step in zip(outlook.wishes, outlook.steps, strict=True):
        events += out_of_reach(time, wish, step) + pace_changed(time, wish, step)
    blocked = outlook.blocked
    if blocked is not None:
        text = f"WALK will end before step {blocked.index}: {outlook.obstacle}"
        data = {"index": blocked.index, "about": "obstacle"}
        events += (Event(time, "warning", text, data),)
    return tuple(event for event in events if subject(event) not in told)


def subject(warning: Event) -> tuple[int, str]:
    """The step that a warning is about, and what of it: place, pace or obstacle."""
    return warning.data["index"], warning.data["about"]
