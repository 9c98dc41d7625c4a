"""The channels that hold an ``AtlasSimInterfaceState``: one table, read both ways.

A row is filled from a controller's status and the measured poses, and a replay restores
the report from a row. All other channels are in ``channels``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from operator import attrgetter
from typing import Any

from atlas_drake.logs.layout import SIDES, WXYZ, XYZ, Channel
from atlas_drake.messages import (
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorPelvisServoParams,
    AtlasBehaviorStepAction,
    AtlasSimInterfaceState,
)

_POSITION = {axis: f"position.{axis}" for axis in XYZ}
_ORIENTATION = {axis: f"orientation.{axis}" for axis in WXYZ}
_STEP = {
    "index": "step_index",
    "foot": "foot_index",
    "duration": "duration",
    **{axis: f"pose.{path}" for axis, path in _POSITION.items()},
    **{f"q{axis}": f"pose.{path}" for axis, path in _ORIENTATION.items()},
    "swing_height": "swing_height",
}
_SPEC = {
    "index": "step_index",
    "foot": "foot_index",
    **{axis: f"foot.{path}" for axis, path in _POSITION.items()},
    "yaw": "foot.yaw",
    **{f"normal_{axis}": f"foot.normal.{axis}" for axis in XYZ},
    **{f.name: f"action.{f.name}" for f in fields(AtlasBehaviorStepAction)},
}
_PELVIS = {f.name: f.name for f in fields(AtlasBehaviorPelvisServoParams)}


@dataclass(frozen=True)
class ReportChannel:
    """A channel, and the place of its numbers in a report.

    Attributes:
        channel: The channel of the log.
        owner: Attributes and list indices that lead to a message.
        leaves: Dotted paths from there, one for each number.
    """

    channel: Channel
    owner: tuple[str | int, ...]
    leaves: tuple[str, ...]

    @property
    def is_measured(self) -> bool:
        """True for poses and velocities, which no controller's status determines."""
        return self.owner[:1] in (("pos_est",), ("foot_pos_est",))

    def read(self, report: AtlasSimInterfaceState) -> Sequence[float]:
        """Reads the channel's numbers."""
        numbers = self._get(self._owner(report))
        return numbers if self.channel.labels else (numbers,)

    def write(self, report: AtlasSimInterfaceState, numbers: Any) -> None:
        """Writes the number, or the sequence of numbers, into a report."""
        owner = self._owner(report)
        many = numbers if self.channel.labels else (numbers,)
        for leaf, number in zip(self.leaves, many, strict=True):
            path, _, name = leaf.rpartition(".")
            message = attrgetter(path)(owner) if path else owner
            kind = int if isinstance(getattr(message, name), int) else float
            setattr(message, name, kind(number))

    @cached_property
    def _get(self) -> Callable[[object], Any]:
        return attrgetter(*self.leaves)

    def _owner(self, report: AtlasSimInterfaceState) -> Any:
        message: Any = report
        for key in self.owner:
            message = message[key] if isinstance(key, int) else getattr(message, key)
        return message


def report_from(numbers: Mapping[str, Any]) -> AtlasSimInterfaceState:
    """Makes the report of a row; time, efforts and shares keep their defaults."""
    report = AtlasSimInterfaceState()
    for entry in REPORT_CHANNELS:
        entry.write(report, numbers[entry.channel.name])
    return report


def _number(
    name: str, path: str, about: str = "", unit: str = "", kind: str = "i8"
) -> ReportChannel:
    """One number, whose path in the report ends with its name in the message."""
    *owner, leaf = path.split(".")
    return ReportChannel(Channel(name, unit, (), kind, about), tuple(owner), (leaf,))


def _group(
    name: str, owner: tuple[str | int, ...], paths: Mapping[str, str], **about: str
) -> ReportChannel:
    """Some numbers of one message, by label."""
    channel = Channel(name, labels=tuple(paths), **about)
    return ReportChannel(channel, owner, tuple(paths.values()))


def _steps_taken(topic: str) -> list[ReportChannel]:
    """Channels of WALK and STEP about the present step."""
    feedback = f"{topic}_feedback"
    return [
        _number(
            f"{topic}.t_step_rem",
            f"{feedback}.t_step_rem",
            "time until the foot lands, or the next step is needed",
            "s",
            "f8",
        ),
        _number(f"{topic}.current_step_index", f"{feedback}.current_step_index"),
        _number(
            f"{topic}.next_step_index_needed", f"{feedback}.next_step_index_needed"
        ),
    ]


_FLAGS = {
    "stand": "no bits are defined",
    "walk": "bits of WalkStatus",
    "step": "bits of StepStatus",
    "manipulate": "no bits are defined",
}
REPORT_CHANNELS = (
    _number("behavior.current", "current_behavior", "active behavior"),
    _number("behavior.desired", "desired_behavior", "requested behavior"),
    _number("behavior.error_code", "error_code", "ErrorCode of the last command"),
    _number(
        "behavior.status_flags",
        "behavior_feedback.status_flags",
        "bits of BehaviorStatus",
    ),
    _number(
        "behavior.trans_from", "behavior_feedback.trans_from", "last behavior left"
    ),
    _number(
        "behavior.trans_to",
        "behavior_feedback.trans_to",
        "last behavior entered or refused",
    ),
    *(
        _number(f"{topic}.status_flags", f"{topic}_feedback.status_flags", about)
        for topic, about in _FLAGS.items()
    ),
    *_steps_taken("walk"),
    *(
        _group(
            f"walk.step_{place + 1}",
            ("walk_feedback", "step_queue_saturated", place),
            _STEP,
            about="coming step as executed, in W [m, s]; index -1 is none",
        )
        for place in range(NUM_REQUIRED_WALK_STEPS)
    ),
    *_steps_taken("step"),
    _group(
        "step.step",
        ("step_feedback", "desired_step_saturated"),
        _STEP,
        about="present step as executed, in W [m, s]; index -1 is none",
    ),
    _group(
        "step.spec",
        ("step_feedback", "desired_step_spec_saturated"),
        _SPEC,
        about="present step as executed, all parameters [m, rad, s]",
    ),
    *(
        _group(
            f"manipulate.{name}",
            ("manipulate_feedback", name),
            _PELVIS,
            about=f"{about} [m, rad]",
        )
        for name, about in (
            ("clamped", "goal of the pelvis pose"),
            ("internal_desired", "present reference of the pelvis pose"),
            ("internal_sensed", "measured pelvis pose"),
        )
    ),
    *(
        _group(
            f"pelvis.{name}",
            ("pos_est", name),
            dict(zip(XYZ, XYZ, strict=True)),
            unit=unit,
            about="of the pelvis in W, as reported",
        )
        for name, unit in (("position", "m"), ("velocity", "m/s"))
    ),
    *(
        _group(
            f"feet.{side}_{name}",
            ("foot_pos_est", foot),
            paths,
            unit=unit,
            about="of the sole, in W",
        )
        for foot, side in enumerate(SIDES)
        for name, unit, paths in (
            ("position", "m", _POSITION),
            ("orientation", "", _ORIENTATION),
        )
    ),
)
"""Channels in the order of the log."""
