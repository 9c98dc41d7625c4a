"""Footsteps of all behaviors that step: from and to messages, their queue, events.

Order and indices only; reach and relative heights are resolved from the stance foot of
each step.
"""

from __future__ import annotations

import itertools
import math
from bisect import bisect_left

import numpy as np
from pydrake.math import RotationMatrix

from atlas_drake.control.feet.footstep import heading_error, landing_error
from atlas_drake.messages import NO_STEP, AtlasBehaviorStepData, Quaternion, Vector3
from atlas_drake.messages.event import CONTACT, FOOTSTEP, Event
from atlas_drake.messages.footstep import (
    FootPose,
    Footstep,
    footstep_from,
    is_elsewhere,
)

_FEET = ("left", "right")
"""Word for each foot index."""


def step_data_from(step: Footstep) -> AtlasBehaviorStepData:
    """Converts a step to its message."""
    data = AtlasBehaviorStepData()
    data.step_index = step.index
    data.foot_index = step.foot
    data.duration = step.duration
    data.swing_height = step.swing_height
    data.pose.position = Vector3.from_array(step.p_WF)
    quaternion = RotationMatrix(step.pose.R_WF).ToQuaternion()
    data.pose.orientation = Quaternion.from_wxyz(quaternion.wxyz())
    return data


def merge(
    pending: tuple[Footstep, ...],
    sent: list[AtlasBehaviorStepData],
    first_open: int,
    relative: bool = False,
) -> tuple[Footstep, ...]:
    """Merges a message into the coming steps: it replaces steps that have not begun.

    Indices below ``first_open`` have begun, and are ignored.
    """
    steps = list(pending)
    for data in sent:
        if data.step_index != NO_STEP and data.step_index >= first_open:
            step = footstep_from(data, relative)
            place = bisect_left(steps, step.index, key=_index)
            replaces = place < len(steps) and steps[place].index == step.index
            steps[place : place + replaces] = [step]
    return tuple(steps)


def _index(step: Footstep) -> int:
    return step.index


def replaced(
    before: tuple[Footstep, ...], after: tuple[Footstep, ...]
) -> frozenset[int]:
    """Returns the indices of the steps in ``after`` that differ from ``before``."""
    known = {step.index: _content(step) for step in before}
    return frozenset(s.index for s in after if known.get(s.index) != _content(s))


def _content(step: Footstep) -> tuple[float, ...]:
    """Returns all values of a step from its message, for comparison."""
    return (
        step.foot,
        *step.p_WF.tolist(),
        step.yaw,
        step.duration,
        step.swing_height,
        *step.normal.tolist(),
        step.relative,
    )


def next_runs(
    pending: tuple[Footstep, ...], index: int, most: int
) -> tuple[Footstep, ...]:
    """Returns the steps from ``index`` on without a gap in their indices.

    Args:
        pending: Steps by index, none of them below ``index``.
        index: Index of the first step.
        most: Greatest number of steps to return.
    """
    expected = zip(pending[:most], itertools.count(index))
    run = itertools.takewhile(lambda entry: entry[0].index == entry[1], expected)
    return tuple(step for step, _ in run)


def footstep_event(
    time: float, sent: Footstep, taken: Footstep, landed: FootPose
) -> Event:
    """Makes the event of a touchdown, with the step as commanded and as executed."""
    error = landing_error(sent, landed)
    height = float((landed.p_WF - taken.p_WF) @ taken.normal)
    tilt = math.acos(min(float(landed.R_WF[:, 2] @ taken.normal), 1.0))
    text = f"{_FEET[taken.foot]}, {1e3 * error:.0f} mm off"
    if abs(height) >= NOTABLE_HEIGHT:
        text += f", {1e3 * abs(height):.0f} mm too {'high' if height > 0.0 else 'low'}"
    if tilt >= NOTABLE_TILT:
        text += f", tilted by {tilt:.2f} rad"
    return Event(
        time,
        FOOTSTEP,
        f"step {taken.index} landed ({text})",
        {
            "index": taken.index,
            "foot": taken.foot,
            "commanded": [*map(float, sent.p_WF[:2]), float(sent.yaw)],
            "saturated": [*map(float, taken.p_WF[:2]), float(taken.yaw)],
            "landed": [*map(float, landed.p_WF[:2]), float(landed.yaw)],
            "landed_height": float(landed.p_WF[2]),
            "error_m": error,
            "error_rad": heading_error(sent, landed),
            "height_error_m": height,
            "tilt_rad": tilt,
        },
    )


def contact_event(time: float, step: Footstep, early: float) -> tuple[Event, ...]:
    """Makes an event if a foot touches the ground early by [s], or late."""
    if abs(early) < NOTABLE_TIME:
        return ()
    when = "early" if early > 0.0 else "late"
    text = f"step {step.index} touched the ground {abs(early):.2f} s {when}"
    data = {"index": step.index, "foot": step.foot, "early_s": early}
    return (Event(time, CONTACT, text, data),)


def partial_event(
    time: float, index: int, foot: int, share: float
) -> tuple[Event, ...]:
    """Makes an event if only a ``share`` of a sole carries as the other foot leaves."""
    if share >= 1.0:
        return ()
    text = f"step {index} stands on a part of the {_FEET[foot]} sole, {share:.0%} of it"
    data = {"index": index, "foot": foot, "share": share}
    return (Event(time, CONTACT, text, data),)


def recovery_event(time: float, step: Footstep) -> Event:
    """Makes the event of a recovery step at its lift-off."""
    text = f"step {step.index} ({_FEET[step.foot]}) catches the balance"
    return Event(time, "recovery", text, {"index": step.index, "foot": step.foot})


NOTABLE_HEIGHT = 0.005
"""Say how far above or below its place a sole landed from this on [m]."""
NOTABLE_TILT = 0.03
"""Say how much a landed sole is tilted from this on [rad]."""
NOTABLE_TIME = 0.07
"""Say of a touchdown that is early or late by at least this [s]."""
NOTABLE = 0.001
"""Warn at lift-off of a step that is saturated by at least this distance [m]."""
NOTABLE_ANGLE = 0.01
"""Warn of a step that is turned or tilted by at least this angle [rad]."""


def out_of_reach(time: float, sent: Footstep, taken: Footstep) -> tuple[Event, ...]:
    """Makes a warning if the place or heading of a step differs from its command."""
    away, turned = landing_error(sent, taken.pose), heading_error(sent, taken.pose)
    off = []
    if away >= NOTABLE:
        off.append(f"{_in_words(away)} m from its place")
    if turned >= NOTABLE_ANGLE:
        off.append(f"{turned:.2f} rad from its heading")
    if not off:
        return ()
    text = f"step {taken.index} is out of reach and ends " + " and ".join(off)
    data = {
        "index": taken.index,
        "about": "place",
        "error_m": away,
        "error_rad": turned,
    }
    return (Event(time, "warning", text, data),)


def pace_changed(time: float, sent: Footstep, taken: Footstep) -> tuple[Event, ...]:
    """Makes a warning if duration, height or slope of a step is not the commanded."""
    changes = []
    if not math.isclose(sent.duration, taken.duration, abs_tol=1e-3):
        changes.append(f"takes {taken.duration:.2f} s instead of {sent.duration:.2f} s")
    if not math.isclose(sent.swing_height, taken.swing_height, abs_tol=1e-3):
        changes.append(
            f"swings {_in_words(taken.swing_height)} m high"
            f" instead of {_in_words(sent.swing_height)} m"
        )
    tilt = math.acos(min(float(np.dot(sent.normal, taken.normal)), 1.0))
    if tilt >= NOTABLE_ANGLE:
        changes.append(f"is tilted {tilt:.2f} rad less than its normal")
    if not changes:
        return ()
    text = f"step {taken.index} " + " and ".join(changes)
    data = {"index": taken.index, "about": "pace"}
    return (Event(time, "warning", text, data),)


def landed_elsewhere(event: Event) -> bool:
    """True if an event reports a landing far from the commanded one."""
    return event.kind == FOOTSTEP and is_elsewhere(event.data)


def _in_words(metres: float) -> str:
    return f"{metres:.2f}" if metres >= 0.1 else f"{metres:.3f}"
