"""Messages that MCAP viewers display without setup: transforms, joints, log lines.

Their schemas are Foxglove's; all other topics of a log have schemas of this project,
which are made here from samples.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from atlas_drake.logs.layout import SIDES, Layout
from atlas_drake.logs.notes import Note

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
VIEWER_SCHEMAS: dict[str, tuple[str, dict[str, Any]]] = {
    "tf": ("foxglove.FrameTransforms", {"transforms": [_TRANSFORM]}),
    "joint_states": (
        "foxglove.JointStates",
        {"timestamp": _STAMP, "joints": [_JOINT]},
    ),
    "events": (
        "foxglove.Log",
        {**_LINE, "line": 0, "time": 0.0, "kind": "", "data": {}},
    ),
}
"""Name of the schema and a sample of the message for each topic of this kind."""

_INFO, _WARNING, _ERROR = 2, 3, 4
"""Levels of foxglove.Log."""
_LEVELS = {"warning": _WARNING, "refusal": _WARNING, "fall": _ERROR}


def viewer_messages(
    layout: Layout, row: list[Any]
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Makes topics and messages of one tick from its row, in which None is missing."""
    stamp = _stamp(row[0])

    def transform(child: str, name: str, separator: str) -> dict[str, Any]:
        w, *xyz = row[layout.places[f"{name}{separator}orientation"]]
        position = row[layout.places[f"{name}{separator}position"]]
        return {
            "timestamp": stamp,
            "parent_frame_id": WORLD,
            "child_frame_id": child,
            "translation": dict(zip(_XYZ, position, strict=True)),
            "rotation": dict(zip(_XYZW, [*xyz, w], strict=True)),
        }

    soles = [transform(f"{side}_sole", f"feet.{side}", "_") for side in SIDES]
    yield "tf", {"transforms": [transform(PELVIS, "pelvis", "."), *soles]}
    channels = {channel.name: channel for channel in layout.channels}
    columns = [
        row[layout.places[f"joints.{name}"]]
        for name in ("position", "velocity", "effort")
    ]
    names = channels["joints.position"].labels
    joints = [
        dict(zip(_JOINT, joint, strict=True))
        for joint in zip(names, *columns, strict=True)
    ]
    yield "joint_states", {"timestamp": stamp, "joints": joints}


def event_message(note: Note) -> dict[str, Any]:
    """Converts an event to a log line, with its own fields added."""
    kind = note.data["kind"]
    return {
        "timestamp": _stamp(note.time),
        "level": _LEVELS.get(kind, _INFO),
        "message": note.data["text"],
        "name": kind,
        "file": "",
        "line": 0,
        "time": note.time,
        "kind": kind,
        "data": note.data["data"],
    }


def json_schema(sample: Any) -> dict[str, Any]:
    """Makes the JSON schema of values with the structure of a sample."""
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


def _stamp(time: float) -> dict[str, int]:
    sec, nsec = divmod(round(1e9 * time), 1_000_000_000)
    return {"sec": sec, "nsec": nsec}
