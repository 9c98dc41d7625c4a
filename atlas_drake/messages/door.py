"""The door: the only check of a command, before any part of it is applied.

Types and bounds stand beside the fields of the messages. What is accepted has one form
for each meaning, in which two commands are compared, and it never changes. Behaviors
refuse commands that contradict the state of the robot, such as a transition that is not
allowed.
"""

from __future__ import annotations

import copy
import dataclasses
import functools
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from atlas_drake.errors import ErrorCode, InvalidMessageError, described
from atlas_drake.frozen import Frozen, read_only
from atlas_drake.messages.atlas_command import AtlasCommand, AtlasSimInterfaceCommand
from atlas_drake.messages.base import same
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.messages.joint_command import JOINT_FIELDS

if TYPE_CHECKING:
    from atlas_drake.robot import Robot

Command = AtlasCommand | AtlasSimInterfaceCommand


@dataclass(frozen=True)
class Accepted(Frozen):
    """A command that can be applied.

    Attributes:
        message: The command, frozen: lists, tuples and arrays are tuples, and numbers
            are Python's own.
        joints: The joint arrays that it has, by field; shape (number of joints,),
            read-only. Gains on the velocity error are limited to the robot's bound.
    """

    message: Command
    joints: dict[str, np.ndarray] = dataclasses.field(compare=False)

    @property
    def kind(self) -> type[Command]:
        """Class of the message."""
        return type(self.message)


@dataclass(frozen=True)
class Refusal(Frozen):
    """Why a command cannot be applied.

    Attributes:
        kind: Class of the message.
        field: Field at fault, as a path from the message.
        problem: What is wrong.
        error_code: Error code that the robot reports.
        value: Value of the field, as the sender gave it.
    """

    kind: type[Command]
    field: str
    problem: str
    error_code: ErrorCode
    value: Any = dataclasses.field(compare=False, repr=False)

    @classmethod
    def of(cls, error: InvalidMessageError, kind: type[Command]) -> Refusal:
        """Return the refusal for a fault.

        Args:
            error: The fault.
            kind: Class of the message.
        """
        return cls(kind, error.field, error.problem, error.error_code, error.value)

    @property
    def error(self) -> InvalidMessageError:
        """The refusal as an exception, made anew because it collects a traceback."""
        return InvalidMessageError(
            self.field, self.value, self.problem, self.error_code
        )


def accept(
    message: Command,
    robot: Robot,
    catalog: BehaviorCatalog = SHIPPED,
    *,
    kind: type[Command] | None = None,
) -> Accepted | Refusal:
    """Check a command, the parameters of all behaviors included.

    Args:
        message: The command, or any value in its place; it is not changed.
        robot: The robot that shall apply it.
        catalog: The behaviors that can be requested.
        kind: The kind of command that is expected; None for that of the message.

    Returns:
        The command as it can be applied, or the first fault in it.
    """
    if kind is None:
        is_joint_command = isinstance(message, AtlasCommand)
        kind = AtlasCommand if is_joint_command else AtlasSimInterfaceCommand
    try:
        made = _adapter(kind).validate_python(message)  # type: ignore[arg-type]
        if isinstance(made, AtlasSimInterfaceCommand):
            _copy_params(made)
            catalog.check_params(made)
        return Accepted(made, _joints(made, robot))
    except ValidationError as error:
        return Refusal.of(_fault(error, robot.joint_names), kind)
    except InvalidMessageError as error:
        return Refusal.of(error, kind)


@functools.cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    """Return the check of one kind of message; making it takes some 30 ms."""
    return TypeAdapter(kind)


def _copy_params(message: AtlasSimInterfaceCommand) -> None:
    """Replace the parameters of a user's own behavior by a copy, arrays read-only."""
    try:
        copied = read_only(copy.deepcopy(message.params))
        is_sound = same(copied, message.params)
    except Exception:  # The user's own objects may raise any error.
        is_sound = False
    if not is_sound:
        problem = "must be values that can be copied and compared"
        raise InvalidMessageError("params", message.params, problem)
    object.__setattr__(message, "params", copied)


def _joints(message: Command, robot: Robot) -> dict[str, np.ndarray]:
    """Return the joint arrays that a message has, within the robot's bounds."""
    joints = {}
    for item in fields(message):
        values = getattr(message, item.name)
        if item.name not in JOINT_FIELDS or not values:
            continue
        if len(values) != robot.num_joints:
            problem = f"must have {robot.num_joints} elements or none, has"
            raise InvalidMessageError(item.name, values, f"{problem} {len(values)}")
        joints[item.name] = np.array(values, dtype=float)
    if "i_effort_min" in joints and "i_effort_max" in joints:
        check_order(joints["i_effort_min"], joints["i_effort_max"], robot)
    if "kp_velocity" in joints:
        joints["kp_velocity"] = np.minimum(
            joints["kp_velocity"], robot.kp_velocity_limit
        )
    return read_only(joints)


def check_order(
    lower: np.ndarray, upper: np.ndarray, robot: Robot, field: str = "i_effort_min"
) -> None:
    """Check the bounds of the integral term, shape (number of joints,)."""
    crossed = np.flatnonzero(lower > upper)
    if crossed.size:
        index = int(crossed[0])
        raise InvalidMessageError(
            f"{field}[{index}]",
            float((lower if field == "i_effort_min" else upper)[index]),
            f"i_effort_min ({lower[index]:g}) must not be above i_effort_max "
            f"({upper[index]:g}) (joint {robot.joint_names[index]})",
        )


def _fault(error: ValidationError, joint_names: Sequence[str]) -> InvalidMessageError:
    """Return the first of pydantic's errors as this package reports it."""
    fault = error.errors(include_url=False)[0]
    place = fault["loc"]
    path = "".join(
        f"[{part}]" if isinstance(part, int) else f".{part}" for part in place
    ).lstrip(".")
    cause = fault.get("ctx", {}).get("error")
    if isinstance(cause, InvalidMessageError):
        return InvalidMessageError(
            path + cause.field, cause.value, cause.problem, cause.error_code
        )
    problem = str(cause or fault["msg"].replace("Input should be", "must be"))
    problem += f", is {described(fault['input'])}"
    index = place[-1] if place[:1] and place[0] in JOINT_FIELDS else None
    if isinstance(index, int) and index < len(joint_names):
        problem += f" (joint {joint_names[index]})"
    is_index = path.endswith(("step_index", "foot_index"))
    code = ErrorCode.INVALID_INDEX if is_index else ErrorCode.VALUE_OUT_OF_RANGE
    return InvalidMessageError(path or "message", fault["input"], problem, code)
