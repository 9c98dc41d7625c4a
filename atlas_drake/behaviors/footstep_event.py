"""Events about a step, shared by all behaviors that step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from atlas_drake.control.feet.footstep import (
    FootPose,
    Footstep,
    heading_error,
    landing_error,
)
from atlas_drake.messages.event import FOOTSTEP, Event

_FEET = ("left", "right")
"""Word for each foot index."""


def footstep_event(
    time: float, sent: Footstep, taken: Footstep, landed: FootPose
) -> Event:
    """Makes the event that is logged at touchdown.

    Args:
        time: Time of the touchdown [s].
        sent: The step as commanded.
        taken: The step as executed, after saturation.
        landed: Pose of the sole at touchdown.
    """
    error = landing_error(sent, landed)
    return Event(
        time,
        FOOTSTEP,
        f"step {taken.index} landed ({_FEET[taken.foot]}, {1e3 * error:.0f} mm off)",
        {
            "index": taken.index,
            "foot": taken.foot,
            "commanded": [*map(float, sent.p_WF[:2]), float(sent.yaw)],
            "saturated": [*map(float, taken.p_WF[:2]), float(taken.yaw)],
            "landed": [*map(float, landed.p_WF[:2]), float(landed.yaw)],
            "landed_height": float(landed.p_WF[2]),
            "error_m": error,
            "error_rad": heading_error(sent, landed),
        },
    )


def caught_balance(time: float, step: Footstep) -> Event:
    """Makes the event of a step that nobody commanded, at its lift-off.

    Args:
        time: Time of the lift-off [s].
        step: The step that catches the balance.
    """
    text = f"step {step.index} ({_FEET[step.foot]}) catches the balance"
    return Event(time, "recovery", text, {"index": step.index, "foot": step.foot})


NOTABLE = 0.001
"""Warn at lift-off of a step that is saturated by at least this distance [m]."""
NOTABLE_ANGLE = 0.01
"""Warn of a step that is turned or tilted by at least this angle [rad]."""
ELSEWHERE = 0.05
"""A step that lands this far from its command counts as landed elsewhere [m]."""
ELSEWHERE_ANGLE = 0.2
"""A step that lands turned by this angle counts as landed elsewhere [rad]."""


def out_of_reach(time: float, sent: Footstep, taken: Footstep) -> tuple[Event, ...]:
    """Makes a warning if the place or heading of a step differs from its command.

    Args:
        time: Time of the warning [s].
        sent: The step as commanded.
        taken: The step as executed.
    """
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
    """Makes a warning if duration, height or slope of a step differ from its command.

    Args:
        time: Time of the warning [s].
        sent: The step as commanded, its height in W.
        taken: The step as executed.
    """
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


def is_elsewhere(landing: Mapping[str, Any]) -> bool:
    """True if a foot landed far from the commanded pose.

    That pose may have been out of reach, or balance may have moved the step.

    Args:
        landing: Data of an event of the kind ``FOOTSTEP``.
    """
    return bool(
        landing["error_m"] >= ELSEWHERE or landing["error_rad"] >= ELSEWHERE_ANGLE
    )


def _in_words(metres: float) -> str:
    return f"{metres:.2f}" if metres >= 0.1 else f"{metres:.3f}"
