"""Events about a step, the same for every behavior that steps."""

from __future__ import annotations

import math

import numpy as np

from atlas_drake.control.feet.footstep import (
    FootPose,
    Footstep,
    heading_error,
    landing_error,
)
from atlas_drake.messages.event import Event


def footstep_event(
    time: float, sent: Footstep, taken: Footstep, landed: FootPose
) -> Event:
    """What is logged at touchdown.

    Args:
        time: [s]
        sent: The step as commanded.
        taken: The step as it was really aimed for.
        landed: Where the sole is.
    """
    return Event(
        time,
        "footstep",
        f"step {taken.index} landed",
        {
            "index": taken.index,
            "foot": taken.foot,
            "commanded": [*map(float, sent.p_WF[:2]), float(sent.yaw)],
            "saturated": [*map(float, taken.p_WF[:2]), float(taken.yaw)],
            "landed": [*map(float, landed.p_WF[:2]), float(landed.yaw)],
            "landed_height": float(landed.p_WF[2]),
            "error_m": landing_error(sent, landed),
            "error_rad": heading_error(sent, landed),
        },
    )


NOTABLE = 0.001
"""Warn of a step that is moved by this much, before it lands [m]."""
NOTABLE_ANGLE = 0.01
"""Warn of a step that is turned or tilted by this much [rad]."""
ELSEWHERE = 0.05
"""A step that lands this far from where it was sent is not the one asked for [m]."""
ELSEWHERE_ANGLE = 0.2
"""A step that lands turned by this much is not the one asked for [rad]."""


def out_of_reach(time: float, sent: Footstep, taken: Footstep) -> tuple[Event, ...]:
    """A warning if a step goes somewhere else than it was sent.

    Args:
        time: [s]
        sent: The step as commanded.
        taken: The step as it is aimed for.
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
    """A warning if a step takes another time, height or slope than it was sent with.

    Args:
        time: [s]
        sent: The step as commanded, its height in W.
        taken: The step as it is taken.
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
    """Whether an event tells of a landing that is not the one asked for.

    It may have been out of reach, or balance may have moved it.
    """
    return event.kind == "footstep" and (
        event.data["error_m"] >= ELSEWHERE or event.data["error_rad"] >= ELSEWHERE_ANGLE
    )


def _in_words(metres: float) -> str:
    return f"{metres:.2f}" if metres >= 0.1 else f"{metres:.3f}"
