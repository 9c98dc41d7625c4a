"""Validation of commands, on delivery and before any value is applied.

Kinds and bounds of values are those that the messages declare beside their fields. The
behaviors refuse commands that contradict the state of the robot, such as a transition
that is not allowed.
"""

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, fields
from functools import partial
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from atlas_drake.errors import ErrorCode, InvalidMessageError, shown
from atlas_drake.messages.atlas_command import AtlasCommand
from atlas_drake.messages.atlas_sim_interface_command import AtlasSimInterfaceCommand
from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.messages.behavior_params import (
    NO_STEP,
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorFootData,
    AtlasBehaviorStepData,
    AtlasBehaviorStepSpec,
)
from atlas_drake.messages.checks import (
    MAX_INDEX,
    Bounds,
    Numbers,
    Shares,
    check_choice,
    check_flag,
    check_joint_array,
    check_kind,
    check_number,
)
from atlas_drake.messages.geometry import Quaternion
from atlas_drake.numeric import is_whole

FEET = {0: "left", 1: "right"}
"""Foot indices."""

MIN_NORM = 1e-6
"""Below this norm the direction of a quaternion or ground normal is rounding noise."""

_Check = Callable[[Any, str], object]
"""Checks a value, given the path of its field."""


def check_command(
    message: AtlasCommand | AtlasSimInterfaceCommand,
    joint_names: Sequence[str],
    catalog: BehaviorCatalog = SHIPPED,
    previous_stamp: float | None = None,
) -> dict[str, NDArray[np.float64]]:
    """Check a command of either kind, the parameters of all behaviors included.

    Args:
        message: The command.
        joint_names: The robot's joints in message order.
        catalog: The behaviors that can be requested.
        previous_stamp: Stamp of the last accepted command of this kind [s], if any.

    Returns:
        The joint arrays that are not empty, by field; shape (number of joints,).

    Raises:
        InvalidMessageError: If a value cannot be applied; it names the field.
    """
    is_joint_command = isinstance(message, AtlasCommand)
    kind: Any = AtlasCommand if is_joint_command else AtlasSimInterfaceCommand
    _check_fields(message, "message", kind=kind)
    _check_order(message.header.stamp, previous_stamp)
    if isinstance(message, AtlasSimInterfaceCommand):
        catalog.check_params(message)
    checked = {
        name: check_joint_array(getattr(message, name), name, joint_names, bounds)
        for name, bounds in _joint_arrays(kind).items()
    }
    given = {name: array for name, array in checked.items() if len(array)}
    if "i_effort_min" in given and "i_effort_max" in given:
        _check_integral_bounds(
            given["i_effort_min"], given["i_effort_max"], joint_names
        )
    return given


def _check_fields(message: Message, field: str, *, kind: Any) -> None:
    """Check the values of a message, those of messages within included."""
    check_kind(message, kind, field)
    path = "" if field == "message" else f"{field}."
    # Only the step index of an empty step is read.
    if kind in _STEPS and _check_indices(message, path) == NO_STEP:
        return
    for name, check in _checks(kind).items():
        check(getattr(message, name), f"{path}{name}")
    if kind is Quaternion:
        _check_direction(message, "xyzw", field, "x = y = z = 0, w = 1 is no rotation")
    elif kind is AtlasBehaviorFootData:
        normal: Any = message.normal  # type: ignore[attr-defined]
        level = "x = y = 0, z = 1 is level ground"
        _check_direction(normal, "xyz", f"{path}normal", level)


_STEPS = (AtlasBehaviorStepData, AtlasBehaviorStepSpec)


@functools.cache
def _joint_arrays(kind: type[Message]) -> dict[str, Bounds]:
    """Return the bounds of the joint arrays of a command, by field."""
    found = {}
    for name, hint in _hints(kind):
        value, bounds = _parts(hint)
        if value in _ARRAYS:
            found[name] = bounds or Bounds()
    return found


@functools.cache
def _checks(kind: type[Message]) -> dict[str, _Check]:
    """Return the checks of a message's other fields, by field."""
    found = {name: _check_for(hint) for name, hint in _hints(kind)}
    return {name: check for name, check in found.items() if check is not None}


def _check_for(hint: Any) -> _Check | None:
    """Return the check that a field's annotation asks for; None if it has none."""
    value, declared = _parts(hint)
    if isinstance(declared, Bounds) and value not in _ARRAYS:
        number = partial(check_number, **asdict(declared))
        return partial(_check_optional, check=number) if value == _OPTIONAL else number
    if declared is not None and value is int:
        return partial(check_choice, choices=declared)
    if value == list[AtlasBehaviorStepData]:
        return _check_queue
    if isinstance(value, type) and issubclass(value, Message):
        return partial(_check_fields, kind=value)
    if value is bool:
        return check_flag
    return check_number if value is float else None


def _hints(kind: type[Message]) -> list[tuple[str, Any]]:
    """Return the fields of a message with their annotations."""
    hints = get_type_hints(kind, include_extras=True)
    return [(field.name, hints[field.name]) for field in fields(kind)]  # type: ignore[arg-type]


def _parts(hint: Any) -> tuple[Any, Any]:
    """Return the type and the bounds or choices of an annotation, if it has some."""
    if get_origin(hint) is not Annotated:
        return hint, None
    value, declared = get_args(hint)
    return value, declared


_OPTIONAL = float | None
_ARRAYS = (Numbers, get_args(Shares)[0])
"""Types of the fields with a number for each joint."""


def _check_optional(value: object, field: str, check: _Check) -> None:
    if value is not None:
        check(value, field)


def _check_order(stamp: Any, previous_stamp: float | None) -> None:
    # A stamp of 0 means "now", which is never too early.
    if stamp and previous_stamp is not None and stamp < previous_stamp:
        raise InvalidMessageError(
            "header.stamp",
            stamp,
            f"time ran backward: {float(stamp):g} s is earlier than "
            f"{previous_stamp:g} s, the stamp of the message before; 0 means now",
            ErrorCode.TIME_RAN_BACKWARD,
        )


def _check_queue(queue: object, field: str) -> None:
    """Check the steps of WALK, empty ones included."""
    if not isinstance(queue, (list, tuple)):
        raise InvalidMessageError(
            field, queue, f"must be a list of steps, is {type(queue).__name__}"
        )
    if len(queue) != NUM_REQUIRED_WALK_STEPS:
        raise InvalidMessageError(
            field,
            queue,
            f"must have {NUM_REQUIRED_WALK_STEPS} entries, has {len(queue)}; an empty "
            "AtlasBehaviorStepData() is no step",
        )
    previous = 0
    for position, step in enumerate(queue):
        _check_fields(step, f"{field}[{position}]", kind=AtlasBehaviorStepData)
        if step.step_index == NO_STEP:
            continue
        if step.step_index <= previous:
            raise InvalidMessageError(
                f"{field}[{position}].step_index",
                step.step_index,
                f"must increase from entry to entry, {step.step_index} follows "
                f"{previous}",
                ErrorCode.INVALID_INDEX,
            )
        previous = step.step_index


def _check_indices(step: Any, path: str) -> int:
    """Check and return the step index; the foot index counts only for a real step."""
    index, foot = step.step_index, step.foot_index
    if not is_whole(index) or not (1 <= index <= MAX_INDEX or index == NO_STEP):
        raise InvalidMessageError(
            f"{path}step_index",
            index,
            f"must be a whole number from 1 on, or {NO_STEP} for no step, is "
            f"{shown(index)}",
            ErrorCode.INVALID_INDEX,
        )
    if index != NO_STEP and not (is_whole(foot) and foot in FEET):
        choice = " or ".join(f"{number} ({name})" for number, name in FEET.items())
        raise InvalidMessageError(
            f"{path}foot_index",
            foot,
            f"must be {choice}, is {shown(foot)}",
            ErrorCode.INVALID_INDEX,
        )
    return index


def _check_direction(vector: object, axes: str, field: str, example: str) -> None:
    if math.hypot(*(getattr(vector, axis) for axis in axes)) < MIN_NORM:
        raise InvalidMessageError(field, vector, f"must not be zero; {example}")


def _check_integral_bounds(
    lower: NDArray[np.float64], upper: NDArray[np.float64], joint_names: Sequence[str]
) -> None:
    crossed = lower > upper
    if crossed.any():
        index = int(np.argmax(crossed))
        raise InvalidMessageError(
            f"i_effort_min[{index}]",
            lower[index],
            f"must be at most i_effort_max, {lower[index]:g} is greater than "
            f"{upper[index]:g} (joint {joint_names[index]})",
        )
