"""What a log keeps of every control tick: names, units and places in a row of numbers.

How the numbers come about is in ``recorder``, how they are written in the formats.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from atlas_drake.messages import NUM_REQUIRED_WALK_STEPS
from atlas_drake.robot import Robot

XY, XYZ = ("x", "y"), ("x", "y", "z")
WXYZ = ("w", "x", "y", "z")
STEP_FIELDS = ("index", "foot", "x", "y", "z", "yaw")
"""What is kept of each step in ``walk.steps``."""
SIDES = ("left", "right")
GAINS = {
    "kp_position": "N·m/rad",
    "ki_position": "N·m/(rad·s)",
    "kd_position": "N·m·s/rad",
    "kp_velocity": "N·m·s/rad",
    "i_effort_min": "N·m",
    "i_effort_max": "N·m",
}


@dataclass(frozen=True)
class Channel:
    """One quantity.

    Attributes:
        name: ``topic.field``, or a single word.
        unit: Of all its elements; empty for counts, flags and ratios.
        labels: Of its elements; none for a single number.
        kind: Numpy's name of its type in the log.
        about: What it is.
    """

    name: str
    unit: str = ""
    labels: tuple[str, ...] = ()
    kind: str = "f8"
    about: str = ""

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return max(len(self.labels), 1)


class Layout:
    """The channels of a log and where each lies in a row.

    Attributes:
        channels: In order.
        places: Slice of a row for each channel's name.
        width: Length of a row.
    """

    def __init__(self, channels: Iterable[Channel]):
        self.channels = tuple(channels)
        self.places: dict[str, slice] = {}
        self.width = 0
        for channel in self.channels:
            self.places[channel.name] = slice(self.width, self.width + channel.size)
            self.width += channel.size

    def split(self, table: np.ndarray) -> dict[str, np.ndarray]:
        """Arrays of the channels, by name.

        Args:
            table: Rows, shape (number of rows, width).

        Returns:
            Arrays of shape (number of rows,), or (number of rows, size) for channels
            with labels.
        """
        arrays = {}
        for channel in self.channels:
            part = table[:, self.places[channel.name]].astype(channel.kind)
            arrays[channel.name] = part if channel.labels else part[:, 0]
        return arrays

    def columns(self) -> list[str]:
        """A name for each number of a row."""
        return [
            f"{channel.name}.{label}" if label else channel.name
            for channel in self.channels
            for label in (channel.labels or ("",))
        ]

    def to_plain(self) -> list[dict[str, Any]]:
        """The channels as plain data."""
        return [asdict(channel) for channel in self.channels]

    @classmethod
    def from_plain(cls, plain: Iterable[Mapping[str, Any]]) -> Layout:
        """The reverse of ``to_plain``."""
        return cls(
            Channel(**{**entry, "labels": tuple(entry["labels"])}) for entry in plain
        )


def robot_layout(
    robot: Robot, positions: Iterable[str], velocities: Iterable[str]
) -> Layout:
    """What is kept of one robot.

    Args:
        robot: Whose joints name the elements.
        positions: Names of the plant's positions.
        velocities: Names of the plant's velocities.
    """
    return Layout(
        [
            Channel("time", "s", about="of the tick"),
            *_behavior(),
            *_joints(robot.joint_names),
            *_body(),
            Channel("controller.tick_time", "s", about="wall time of the tick"),
            Channel("controller.unsolved", kind="i8", about="QPs without a solution"),
            Channel("state.q", labels=tuple(positions), about="true positions"),
            Channel("state.v", labels=tuple(velocities), about="true velocities"),
        ]
    )


def _behavior() -> Iterable[Channel]:
    for name, about in (
        ("current", "active behaviour"),
        ("desired", "behaviour asked for"),
        ("status_flags", "bits of BehaviorStatus"),
        ("trans_from", "behaviour left last"),
        ("trans_to", "behaviour entered or refused last"),
        ("error_code", "of the last command"),
        ("request_number", "behaviour commands accepted so far"),
    ):
        yield Channel(f"behavior.{name}", kind="i8", about=about)
    yield Channel("walk.status_flags", kind="i8", about="bits of WalkStatus")
    yield Channel("walk.t_step_rem", "s", about="until the foot in the air lands")
    yield Channel("walk.current_step_index", kind="i8")
    yield Channel("walk.next_step_index_needed", kind="i8")
    yield Channel("step.status_flags", kind="i8", about="bits of StepStatus")
    yield Channel("step.t_step_rem", "s", about="until the next step is needed")
    yield Channel("step.current_step_index", kind="i8")
    yield Channel("step.next_step_index_needed", kind="i8")
    yield Channel("step.step", labels=STEP_FIELDS, about="as it is taken [m, rad]")
    labels = tuple(
        f"step_{number}_{name}"
        for number in range(1, NUM_REQUIRED_WALK_STEPS + 1)
        for name in STEP_FIELDS
    )
    yield Channel("walk.steps", labels=labels, about="as they will be taken [m, rad]")


def _joints(names: tuple[str, ...]) -> Iterable[Channel]:
    for name, unit, about in (
        ("position", "rad", "measured"),
        ("velocity", "rad/s", "measured"),
        ("effort", "N·m", "applied by the motors"),
        ("user_effort", "N·m", "of the joint controllers"),
        ("behavior_effort", "N·m", "of the behaviour"),
        ("position_setpoint", "rad", "in force for the user's share"),
        ("velocity_setpoint", "rad/s", "in force for the user's share"),
        ("effort_setpoint", "N·m", "in force for the user's share"),
    ):
        yield Channel(f"joints.{name}", unit, names, about=about)
    yield Channel("joints.k_effort", "", names, "u1", "the user's share, 0 to 255")
    for name, unit in GAINS.items():
        yield Channel(f"gains.{name}", unit, names, about="in force")


def _body() -> Iterable[Channel]:
    yield Channel("pelvis.position", "m", XYZ, about="in W, as reported")
    yield Channel("pelvis.orientation", "", WXYZ, about="in W")
    yield Channel("pelvis.velocity", "m/s", XYZ, about="in W, as reported")
    yield Channel("imu.orientation", "", WXYZ, about="in W")
    yield Channel("imu.angular_velocity", "rad/s", XYZ, about="in its own frame")
    yield Channel("imu.linear_acceleration", "m/s²", XYZ, about="specific force")
    for side in SIDES:
        yield Channel(f"feet.{side}_position", "m", XYZ, about="of the sole, in W")
        yield Channel(f"feet.{side}_orientation", "", WXYZ, about="of the sole, in W")
        yield Channel(f"feet.{side}_torque", "N·m", XYZ, about="as of force")
        yield Channel(
            f"feet.{side}_force",
            "N",
            XYZ,
            about="of contact at the sole's centre, in W, of the tick before",
        )
    for side in SIDES:
        yield Channel(f"hands.{side}_torque", "N·m", XYZ, about="of contact, in W")
        yield Channel(f"hands.{side}_force", "N", XYZ, about="of contact, in W")
    yield Channel("balance.com", "m", XYZ, about="centre of mass, in W")
    yield Channel("balance.com_velocity", "m/s", XYZ)
    yield Channel("balance.dcm", "m", XY, about="divergent component of motion")
    yield Channel("balance.cop", "m", XY, about="measured; NaN without load")
    yield Channel("balance.dcm_reference", "m", XY, about="planned; NaN without plan")
    yield Channel("balance.cop_reference", "m", XY, about="planned; NaN without plan")
