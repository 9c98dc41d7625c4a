"""The run at an instant, for the page: the record, and what the page derives of it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import orjson

from atlas_drake.clients.cockpit.wire import ShownEvent
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorWalkFeedback,
    BehaviorStatus,
)
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.event import Event
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.planning.footholds import foothold
from atlas_drake.records import TickRecord
from atlas_drake.records.plain import to_plain
from atlas_drake.rotations import rotation_matrix, yaw_of

GAINS = ("kp_position", "ki_position", "kd_position", "kp_velocity")
"""The gains that the page shows."""
EVENTS_AT_ONCE = 100
"""Number of events in one frame."""


def frame_json(
    record: TickRecord,
    catalog: BehaviorCatalog,
    command: JointCommand | None,
    **facts: Any,
) -> bytes:
    """Writes a record for the page.

    Args:
        record: The record.
        catalog: The behaviors.
        command: Joint commands in force; None for those of the record.
        **facts: Of the run: its time, whether it is paused, and so on.
    """
    flags = BehaviorStatus(record.behavior.status_flags)
    x, y, z = map(float, record.pelvis.position)
    feet = [
        [float(p_WF[0]), float(p_WF[1]), _heading(q_WF)]
        for p_WF, q_WF in zip(
            record.feet.positions, record.feet.orientations, strict=True
        )
    ]
    frame = {
        "behavior": catalog.find(record.behavior.current).name,
        "desired": catalog.find(record.behavior.desired).name,
        "fallen": bool(flags & BehaviorStatus.ERROR_FALLING),
        "command": _command(record, command),
        "robot": [x, y, z, _heading(record.pelvis.orientation)],
        "ground": min(float(p_WF[2]) for p_WF in record.feet.positions),
        "feet": feet,
        "loads": record.feet.loads,
        "steps": coming_steps(record.walk),
        "record": record,
        "sent": time.time(),
        **facts,
    }
    options = orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NON_STR_KEYS
    return orjson.dumps(frame, default=to_plain, option=options)


def _command(record: TickRecord, command: JointCommand | None) -> dict[str, Any]:
    if command is None:
        gains = {name: getattr(record.gains, name) for name in GAINS}
        joints = record.joints
        shares, position = joints.k_effort, joints.position_setpoint
    else:
        gains = {name: getattr(command, name) for name in GAINS}
        shares, position = command.k_effort, command.position
    return {"k_effort": shares.astype(int), "position": position, **gains}


def _heading(wxyz: np.ndarray) -> float:
    """Returns the heading of a pose with this quaternion [rad]."""
    return float(yaw_of(rotation_matrix(wxyz / np.linalg.norm(wxyz))))


def coming_steps(
    walk: AtlasBehaviorWalkFeedback,
) -> list[tuple[int, float, float, float]]:
    """Returns foot, x, y [m] and yaw [rad] of each step of a walk to come."""
    if not walk.is_active:
        return []
    first = max(walk.current_step_index, 1)
    return [
        (step.foot_index, *foothold(step.pose))
        for step in walk.step_queue_saturated
        if step.step_index != NO_STEP and step.step_index >= first
    ]


def events_after(events: Sequence[Event], seen: int) -> tuple[ShownEvent, ...]:
    """Returns the next events of a run after the ``seen`` first ones."""
    return tuple(map(shown_event, events[seen : seen + EVENTS_AT_ONCE]))


def shown_event(event: Event) -> ShownEvent:
    """Returns what the page shows of an event."""
    return event.time, event.kind, event.text
