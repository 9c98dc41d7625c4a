"""What is told of a step, the same by every behaviour that steps."""

from __future__ import annotations

from atlas_drake.behaviors.base import Event
from atlas_drake.control.footstep import FootPose, Footstep, landing_error


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
        },
    )


NOTABLE = 0.05
"""A step taken this far from where it was sent is told of before it lands [m]."""


def out_of_reach(time: float, sent: Footstep, taken: Footstep) -> tuple[Event, ...]:
    """A warning if a step begins that goes somewhere else than it was sent.

    Args:
        time: [s]
        sent: The step as commanded.
        taken: The step as it is aimed for.
    """
    away = landing_error(sent, taken.pose)
    if away < NOTABLE:
        return ()
    text = f"step {taken.index} is out of reach and ends {away:.2f} m from its place"
    return (Event(time, "warning", text),)
