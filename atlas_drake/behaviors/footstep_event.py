"""The event that tells of a landed foot, the same from every behaviour that steps."""

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
