"""The topics of a log: which part of a record each holds, and in which form.

Numbers of a group are one message by field and label; what has a structure of its own,
such as footsteps, is one message with the value. Transforms, joint states and log lines
have schemas of Foxglove's, which viewers display without setup.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake.messages import (
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorStandFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    Message,
    ToeOff,
)
from atlas_drake.messages.atlas_command import COMMANDS
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.event import MESSAGE, Event
from atlas_drake.messages.footstep import Footstep, StepAction
from atlas_drake.records import Schema
from atlas_drake.records.plain import message_from, to_plain
from atlas_drake.records.schema import TIME
from atlas_drake.records.tick_record import ContactForce

EVENTS = "events"
ON_CHANGE = frozenset({"gains", "behavior", "hands"})
"""Groups of numbers that are written only when they change."""
VIEWER_PERIOD = 0.02
"""Time between messages that are only for viewers [s]."""
LAST_TIME = 9e9
"""Latest time that a stamp can have [s]."""


@dataclass(frozen=True)
class Structured:
    """A part of a record with a structure of its own, written when it changes."""

    blank: Any
    """Value before the first message."""
    read: Callable[[Any], Any]
    """Makes the value from its plain form."""
    is_message: bool = False
    """True for a message, whose fields are those of the topic; any other value is in a
    field that has the name of the topic."""
    sample: Any = None
    """Describes the structure where ``blank`` says too little."""


def _feedback(kind: type[Message]) -> Structured:
    return Structured(kind(), lambda plain: message_from(kind, plain), is_message=True)


def _footsteps(plain: Any) -> tuple[Footstep, ...]:
    return tuple(map(_footstep, plain))


def _footstep(plain: Mapping[str, Any]) -> Footstep:
    action = {**plain["action"], "toe_off": ToeOff(plain["action"]["toe_off"])}
    parts = {"normal": np.array(plain["normal"]), "action": StepAction(**action)}
    return Footstep(**{**plain, **parts})


def _paths(plain: Any) -> PlannedPaths | None:
    return None if plain is None else PlannedPaths(**plain)


def _contacts(plain: Any) -> tuple[ContactForce, ...] | None:
    if plain is None:
        return None
    return tuple(
        ContactForce(np.array(one["p_WC"]), np.array(one["force_W"])) for one in plain
    )


def _pushes(plain: Any) -> tuple[tuple[str, tuple[float, ...]], ...]:
    return tuple((body, tuple(force_W)) for body, force_W in plain)


_POINT = np.zeros(3)
_LINE = np.zeros((1, 2))
_SAMPLE_PATHS = PlannedPaths(_LINE, _LINE, _LINE, np.zeros((1, 3)))

STRUCTURED: dict[str, Structured] = {
    "stand": _feedback(AtlasBehaviorStandFeedback),
    "walk": _feedback(AtlasBehaviorWalkFeedback),
    "step": _feedback(AtlasBehaviorStepFeedback),
    "manipulate": _feedback(AtlasBehaviorManipulateFeedback),
    "feedback": Structured(None, lambda plain: plain, sample={}),
    "plan": Structured({}, lambda plain: plain),
    "footsteps": Structured((), _footsteps, sample=[Footstep(1, 0, np.zeros(3), 0.0)]),
    "pushes": Structured((), _pushes, sample=[None]),
    "paths": Structured(None, _paths, sample=_SAMPLE_PATHS),
    "contacts": Structured(None, _contacts, sample=[ContactForce(_POINT, _POINT)]),
}
"""Structured parts of a record, by field and topic."""


def message_of_part(name: str, value: Any) -> Any:
    """Returns the message of the topic ``name`` for a structured value."""
    return value if STRUCTURED[name].is_message else {name: value}


def part_of_message(name: str, plain: Any) -> Any:
    """Returns the plain value in a message of the topic ``name``."""
    return plain if STRUCTURED[name].is_message else plain[name]


# ---- events and messages that were received ----------------------------------

_INFO, _WARNING, _ERROR = 2, 3, 4
"""Levels of foxglove.Log."""
_LEVELS = {"warning": _WARNING, "refusal": _WARNING, "fall": _ERROR}


def message_of_event(event: Event, of_record: bool) -> tuple[str, dict[str, Any]]:
    """Returns the topic and the message of an event, which a record holds or not."""
    if event.kind == MESSAGE:
        message, number = event.data["message"], event.data["number"]
        topic = next(name for name, kind in COMMANDS.items() if type(message) is kind)
        return topic, {
            "number": number,
            "time": event.time,
            "message": to_plain(message),
        }
    return EVENTS, {
        "timestamp": _stamp(event.time),
        "level": _LEVELS.get(event.kind, _INFO),
        "message": to_plain(event.text),
        "name": to_plain(event.kind),
        "file": "",
        "line": 0,
        "time": to_plain(event.time),
        "data": to_plain(event.data),
        "of_record": of_record,
    }


def event_of_message(topic: str, plain: Mapping[str, Any]) -> tuple[Event, bool]:
    """The reverse of ``message_of_event``."""
    if topic == EVENTS:
        event = Event(plain["time"], plain["name"], plain["message"], plain["data"])
        return event, plain["of_record"]
    message = message_from(COMMANDS[topic], plain["message"])
    data = {"number": plain["number"], "message": message}
    return Event(plain["time"], MESSAGE, type(message).__name__, data), True


# ---- messages for viewers ----------------------------------------------------

_JOINT_STATE = ("position", "velocity", "effort")


def viewer_messages(
    time: float, plain: Mapping[str, Any]
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yields topics and messages of a record from its groups as plain numbers."""
    stamp = _stamp(time)
    poses = [("pelvis", plain["pelvis"], "")]
    poses += [(f"{side}_sole", plain["feet"], f"{side}_") for side in ("left", "right")]
    transforms = [
        {
            "timestamp": stamp,
            "parent_frame_id": "world",
            "child_frame_id": frame,
            "translation": group[f"{prefix}position"],
            "rotation": group[f"{prefix}orientation"],
        }
        for frame, group, prefix in poses
    ]
    yield "tf", {"transforms": transforms}
    joints = plain["joints"]
    states = [
        {"name": name, **{part: joints[part][name] for part in _JOINT_STATE}}
        for name in joints["position"]
    ]
    yield "joint_states", {"timestamp": stamp, "joints": states}


def nanoseconds(time: float) -> int:
    """Converts a time [s], which an event may have any of, to a stamp [ns]."""
    return round(1e9 * min(max(time, 0.0), LAST_TIME))


def _stamp(time: float) -> dict[str, int]:
    sec, nsec = divmod(nanoseconds(time), 1_000_000_000)
    return {"sec": sec, "nsec": nsec}


# ---- JSON schemas ------------------------------------------------------------


def json_schemas(schema: Schema) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yields each topic of a log with the name of its JSON schema, and the schema."""
    yield TIME, f"atlas_drake.{TIME}", _like({TIME: 0.0})
    for group in schema.groups:
        yield group, f"atlas_drake.{group}", _of_group(schema, group)
    for name, part in STRUCTURED.items():
        value = part.blank if part.sample is None else part.sample
        sample = to_plain(message_of_part(name, value))
        yield name, f"atlas_drake.{name}", _like(sample)
    for name, kind in COMMANDS.items():
        received = {"number": 0, "time": 0.0, "message": to_plain(kind())}
        yield name, f"atlas_drake.{kind.__name__}", _like(received)
    _, line = message_of_event(Event(0.0, "", ""), of_record=True)
    yield EVENTS, "foxglove.Log", _like(line)
    xyz = dict.fromkeys(("x", "y", "z"), 0.0)
    pose = {"position": xyz, "orientation": {**xyz, "w": 1.0}}
    feet = {f"{s}_{key}": part for s in ("left", "right") for key, part in pose.items()}
    joints = {name: {"joint": 0.0} for name in _JOINT_STATE}
    zeros = {"pelvis": pose, "feet": feet, "joints": joints}
    names = {"tf": "foxglove.FrameTransforms", "joint_states": "foxglove.JointStates"}
    for name, message in viewer_messages(0.0, zeros):
        yield name, names[name], _like(message)


def _of_group(schema: Schema, group: str) -> dict[str, Any]:
    """Describes a group of numbers, with the unit of each column."""
    properties = {}
    for name, column in schema.parts[group].items():
        numbers = _like(dict.fromkeys(column.elements, 0.0) or 0.0)
        about = f"{column.about} [{column.unit or '-'}]"
        properties[name] = {**numbers, "description": about}
    return {"type": "object", "properties": properties}


def _like(sample: Any) -> dict[str, Any]:
    """Describes values like a sample; None is like any value."""
    if sample is None:
        return {}
    if isinstance(sample, dict):
        properties = {name: _like(value) for name, value in sample.items()}
        return {"type": "object", "properties": properties}
    if isinstance(sample, list):
        # Arrays that are empty in a blank message hold one number per joint.
        return {"type": "array", "items": _like(sample[0] if sample else 0.0)}
    if isinstance(sample, bool):
        return {"type": "boolean"}
    if isinstance(sample, str):
        return {"type": "string"}
    return {"type": "integer" if isinstance(sample, int) else "number"}
