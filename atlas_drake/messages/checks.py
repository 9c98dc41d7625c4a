"""Bounds of fields, and checks of one value each: a number, a flag, a joint array.

Messages declare the bounds beside their fields; ``validation`` applies the checks.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import IntEnum
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from atlas_drake.errors import InvalidMessageError, shown
from atlas_drake.numeric import as_float, is_whole

LARGEST = 1e12
"""Largest magnitude of a number in a message, in any unit: products of larger numbers
could leave the range of floating point."""

MAX_INDEX = 2**31 - 1
"""Largest number of a step or a behavior: the original has 32 bits for them."""

K_EFFORT_MAX = 255
"""``k_effort`` of a joint that the user controls alone."""


@dataclass(frozen=True)
class Bounds:
    """Bounds of a number, or of each number of an array, in the field's unit.

    Attributes:
        lower: The least value allowed.
        upper: The largest value allowed.
        strictly: The value must be greater than ``lower``.
        whole: Only whole numbers are allowed.
    """

    lower: float = -math.inf
    upper: float = math.inf
    strictly: bool = False
    whole: bool = False


NotNegative = Annotated[float, Bounds(0.0)]
Positive = Annotated[float, Bounds(0.0, strictly=True)]

Numbers = list[float] | NDArray[Any]
"""One number for each joint in message order, or none: "keep the values in force"."""
Gains = Annotated[Numbers, Bounds(0.0)]
Shares = Annotated[
    list[int] | NDArray[Any], Bounds(0.0, float(K_EFFORT_MAX), whole=True)
]
"""A share of user control for each joint, or none: 0 for the behavior alone."""


def check_kind(value: object, kind: type, field: str) -> None:
    """Raise InvalidMessageError unless the value is a message of this kind."""
    if not isinstance(value, kind):
        raise InvalidMessageError(
            field, value, f"must be {kind.__name__}, is {type(value).__name__}"
        )


def check_number(
    value: object,
    field: str,
    lower: float = -math.inf,
    upper: float = math.inf,
    *,
    strictly: bool = False,
    whole: bool = False,
) -> float:
    """Check that a value is a finite number, not too large and not too small.

    Args:
        value: The value; truth values are not numbers.
        field: Path of the value in its message.
        lower: The least value allowed, in the field's unit.
        upper: The largest value allowed.
        strictly: The value must be greater than ``lower``.
        whole: Only whole numbers are allowed.

    Returns:
        The number.

    Raises:
        InvalidMessageError: If it is not a number, not finite, beyond ``LARGEST``, out
            of bounds, or not whole.
    """
    number = as_float(value)
    if number is None:
        requirement = "a number"
    elif not math.isfinite(number):
        requirement = "finite"
    elif abs(number) > LARGEST:
        requirement = f"within ±{LARGEST:g}"
    elif number < lower or (strictly and number == lower):
        requirement = f"{'greater than' if strictly else 'at least'} {lower:g}"
    elif number > upper:
        requirement = f"at most {upper:g}"
    elif whole and not number.is_integer():
        requirement = "a whole number"
    else:
        return number
    raise InvalidMessageError(field, value, f"must be {requirement}, is {shown(value)}")


def check_vector(
    values: object, field: str, size: int, largest: float = LARGEST
) -> NDArray[np.float64]:
    """Check that a value has ``size`` finite numbers, none larger than ``largest``.

    Returns:
        The numbers; shape (size,).

    Raises:
        InvalidMessageError: If it is no list, tuple or array of such numbers.
    """
    is_list = isinstance(values, (list, tuple)) or (
        isinstance(values, np.ndarray)
        and values.ndim == 1
        and not isinstance(values, np.ma.MaskedArray)
    )
    numbers = [as_float(element) for element in values] if is_list else []  # type: ignore[attr-defined]
    vector = np.array([math.nan if number is None else number for number in numbers])
    if vector.shape != (size,) or not np.isfinite(vector).all():
        problem = f"must be {size} finite numbers, is {shown(values)}"
        raise InvalidMessageError(field, values, problem)
    if np.abs(vector).max() > largest:
        problem = f"must be within ±{largest:g}, is {shown(values)}"
        raise InvalidMessageError(field, values, problem)
    return vector


def check_flag(value: object, field: str) -> None:
    """Raise InvalidMessageError unless the value is True or False."""
    yes_or_no = isinstance(value, (bool, np.bool_)) or is_whole(value)
    if not (yes_or_no and value in (0, 1)):
        raise InvalidMessageError(
            field, value, f"must be True or False, is {shown(value)}"
        )


def check_choice(value: object, field: str, choices: type[IntEnum]) -> None:
    """Raise InvalidMessageError unless the value is the number of a member."""
    if not is_whole(value) or value not in set(choices):
        known = ", ".join(f"{member.value} ({member.name})" for member in choices)
        raise InvalidMessageError(
            field, value, f"must be one of {known}, is {shown(value)}"
        )


def check_joint_array(
    values: object, field: str, joint_names: Sequence[str], bounds: Bounds
) -> NDArray[np.float64]:
    """Check that a value has one valid number per joint, or is empty.

    Args:
        values: A list, tuple or one-dimensional array.
        field: Path of the value in its message.
        joint_names: The robot's joints in message order.
        bounds: Bounds of each number.

    Returns:
        The numbers; shape (number of joints,) or (0,).

    Raises:
        InvalidMessageError: If it is not such a list, has another length, or an element
            is not a number, not finite, beyond ``LARGEST``, out of bounds, or not
            whole.
    """
    is_array, count = isinstance(values, np.ndarray), len(joint_names)
    given: Any = values
    problem = ""
    if isinstance(values, np.ma.MaskedArray):
        problem = (
            "must be a list of numbers or a plain array, is a masked array; give the "
            "masked elements values with its filled()"
        )
    elif not (isinstance(values, (list, tuple)) or is_array):
        problem = (
            "must be a list of numbers, one per joint, or an empty list, is "
            f"{type(values).__name__}"
        )
    elif is_array and given.ndim != 1:
        problem = f"must have one dimension, has shape {given.shape}"
    elif len(given) not in (0, count):
        problem = (
            f"must have {count} elements, one per joint, or none, has {len(given)}"
        )
    if problem:
        raise InvalidMessageError(field, values, problem)
    if is_array and given.dtype.kind in "iuf":
        # An overflow gives infinity, which is refused.
        with np.errstate(over="ignore"):
            numbers = np.asarray(given, dtype=float)
    else:
        found = map(as_float, given)
        numbers = np.array([math.nan if number is None else number for number in found])
    # False for NaN, too.
    sound = (np.abs(numbers) <= LARGEST) & (numbers >= bounds.lower)
    sound &= numbers <= bounds.upper
    if bounds.whole:
        sound &= numbers == np.floor(numbers)
    if not sound.all():
        index = int(np.argmin(sound))
        try:
            check_number(given[index], f"{field}[{index}]", **asdict(bounds))
        except InvalidMessageError as error:
            problem = f"{error.problem} (joint {joint_names[index]})"
            raise InvalidMessageError(error.field, error.value, problem) from None
    return numbers
