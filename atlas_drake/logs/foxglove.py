"""Messages that MCAP viewers display without setup: transforms, joints, log lines.

Their schemas are Foxglove's; all other topics of a log have schemas of this project.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from atlas_drake.messages.event import Event
from atlas_drake.records.plain import to_plain

VIEWER_PERIOD = 0.02
"""Time between messages that are only for viewers [s]."""
LAST_TIME = 9e9
"""Latest time that a stamp can have [s]."""
WORLD, PELVIS = "world", "pelvis"
_STAMP = {"sec": 0, "nsec": 0}
_XYZ, _XYZW = ("x", "y", "z"), ("x", "y", "z", "w")
_TRANSFORM = {
    "timestamp": _STAMP,
    "parent_frame_id": "",
    "child_frame_id": "",
    "translation": dict.fromkeys(_XYZ, 0.0),
    "rotation": dict.fromkeys(_XYZW, 0.0),
}
_JOINT = {"name": "", "position": 0.0, "velocity": 0.0, "effort": 0.0}
_LINE = {"timestamp": _STAMP, "level": 0, "message": "", "name": "", "file": ""}
_OWN = {"line": 0, "time": 0.0, "kind": "", "data": {}, "of_record": True}
SCHEMAS: dict[str, tuple[str, dict[str, Any]]] = {
    "tf": ("foxglove.FrameTransforms", {"transforms": [_TRANSFORM]}),
    "joint_states": (
        "foxglove.JointStates",
        {"timestamp": _STAMP, "joints": [_JOINT]},
    ),
    "events": ("foxglove.Log", {**_LINE, **_OWN}),
}
"""Name of the schema and a sample of the message for each topic of this kind."""

_INFO, _WARNING, _ERROR = 2, 3, 4
"""Levels of foxglove.Log."""
_LEVELS = {"warning": _WARNING, "refusal": _WARNING, "fall": _ERROR}


def viewer_messages(
    time: float, plain: Mapping[str, Any]
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Makes topics and messages of a record from its groups as plain numbers."""
    stamp = _stamp(time)
    poses = [(PELVIS, plain["pelvis"], "")]
    poses += [(f"{s}_sole", plain["feet"], f"{s}_") for s in ("left", "right")]
    yield (
        "tf",
        {
            "transforms": [
                {
                    "timestamp": stamp,
                    "parent_frame_id": WORLD,
                    "child_frame_id": child,
                    "translation": group[f"{prefix}position"],
                    "rotation": group[f"{prefix}orientation"],
                }
                for child, group, prefix in poses
            ]
        },
    )
    joints = plain["joints"]
    yield (
        "joint_states",
        {
            "timestamp": stamp,
            "joints": [
                {
                    "name": name,
                    **{part: joints[part][name] for part in list(_JOINT)[1:]},
                }
                for name in joints["position"]
            ],
        },
    )


def event_message(event: Event, of_record: bool) -> dict[str, Any]:
    """Converts an event to a log line, with its own fields added."""
    return {
        "timestamp": _stamp(event.time),
        "level": _LEVELS.get(event.kind, _INFO),
        "message": event.text,
        "name": event.kind,
        "file": "",
        "line": 0,
        "time": event.time,
        "kind": event.kind,
        "data": to_plain(event.data),
        "of_record": of_record,
    }


def json_schema(sample: Any) -> dict[str, Any]:
    """Makes the JSON schema of values like a sample; None is like any value."""
    if sample is None:
        return {}
    if isinstance(sample, dict):
        properties = {name: json_schema(value) for name, value in sample.items()}
        return {"type": "object", "properties": properties}
    if isinstance(sample, list):
        # Arrays that are empty in a blank message hold one number per joint.
        return {"type": "array", "items": json_schema(sample[0] if sample else 0.0)}
    if isinstance(sample, bool):
        return {"type": "boolean"}
    if isinstance(sample, str):
        return {"type": "string"}
    return {"type": "integer" if isinstance(sample, int) else "number"}


def nanoseconds(time: float) -> int:
    """Converts a time [s] to a stamp [ns], as far as there is one.

    An event of a user's own may have any time.
    """
    return round(1e9 * min(max(time, 0.0), LAST_TIME))


def _stamp(time: float) -> dict[str, int]:
    sec, nsec = divmod(nanoseconds(time), 1_000_000_000)
    return {"sec": sec, "nsec": nsec}
