"""Checks of one value each: a finite number, a whole number, a joint array.

``validation`` assigns the checks to the fields.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from atlas_drake.errors import InvalidMessageError, shown
from atlas_drake.messages.base import Message
from atlas_drake.numeric import as_float, is_whole


def check_kind(value: object, kind: type[Message], field: str) -> None:
    """Raise InvalidMessageError unless the value is a message of this kind."""
    if not isinstance(value, kind):
        raise InvalidMessageError(
            field, value, f"must be {kind.__name__}, is {type(value).__name__}"
        )


LARGEST = 1e12
"""Largest magnitude of a number in a message, in any unit: products of larger numbers
could leave the range of floating point."""


def check_number(
    value: object,
    field: str,
    lower: float = -math.inf,
    upper: float = math.inf,
    *,
    strictly: bool = False,
) -> float:
    """Check that a value is a finite number, not too large and not too small.

    Args:
        value: The value; truth values are not numbers.
        field: Path of the value in its message.
        lower: The least value allowed, without the unit.
        upper: The largest value allowed.
        strictly: The value must be greater than ``lower``.

    Returns:
        The number.

    Raises:
        InvalidMessageError: If it is not a number, not finite, beyond ``LARGEST``, too
            small or too large.
    """
    number = as_float(value)
    if number is None:
        raise InvalidMessageError(field, value, f"must be a number, is {shown(value)}")
    if not math.isfinite(number):
        raise InvalidMessageError(field, value, f"must be finite, is {shown(value)}")
    if abs(number) > LARGEST:
        raise InvalidMessageError(
            field, value, f"must be within ±{LARGEST:g}, is {shown(value)}"
        )
    if number < lower or (strictly and number == lower):
        bound = "greater than" if strictly else "at least"
        raise InvalidMessageError(
            field, value, f"must be {bound} {lower:g}, is {shown(value)}"
        )
    if number > upper:
        raise InvalidMessageError(
            field, value, f"must be at most {upper:g}, is {shown(value)}"
        )
    return number


MAX_INDEX = 2**31 - 1
"""Largest number of a step or a behavior: the original has 32 bits for them."""


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


def check_joint_array(
    values: object,
    field: str,
    joint_names: Sequence[str],
    lower: float = -math.inf,
    upper: float = math.inf,
    *,
    whole: bool = False,
) -> NDArray[np.float64]:
    """Check that a value has one valid number per joint, or is empty.

    Args:
        values: A list, tuple or one-dimensional array.
        field: Path of the value in its message.
        joint_names: The robot's joints in message order.
        lower: The least number allowed, without the unit.
        upper: The greatest number allowed, without the unit.
        whole: Only whole numbers are allowed.

    Returns:
        The numbers; shape (number of joints,) or (0,).

    Raises:
        InvalidMessageError: If it is not such a list, has another length, or an element
            is not a number, not finite, beyond ``LARGEST``, out of bounds, or not
            whole.
    """
    numbers = _joint_numbers(values, field, joint_names)
    bad = ~np.isfinite(numbers)
    requirement = "must be finite"
    if not bad.any():
        bad = np.abs(numbers) > LARGEST
        requirement = f"must be within ±{LARGEST:g}"
    if not bad.any():
        bad = (numbers < lower) | (numbers > upper)
        requirement = f"must be at least {lower:g}"
        if math.isfinite(upper):
            requirement = f"must be {lower:g} to {upper:g}"
    if not bad.any() and whole:
        bad = numbers != np.floor(numbers)
        requirement = "must be a whole number"
    if bad.any():
        index = int(np.argmax(bad))
        # The error shows the value as it was sent: 10**400 reads better than infinity.
        value = values[index]  # type: ignore[index]
        raise InvalidMessageError(
            f"{field}[{index}]",
            value,
            f"{requirement}, is {shown(value)} (joint {joint_names[index]})",
        )
    return numbers


def _joint_numbers(
    values: object, field: str, joint_names: Sequence[str]
) -> NDArray[np.float64]:
    if isinstance(values, np.ma.MaskedArray):
        raise InvalidMessageError(
            field,
            values,
            "must be a list of numbers or a plain array, is a masked array; give the "
            "masked elements values with its filled()",
        )
    is_array = isinstance(values, np.ndarray)
    if not (isinstance(values, (list, tuple)) or is_array):
        raise InvalidMessageError(
            field,
            values,
            "must be a list of numbers, one per joint, or an empty list, is "
            f"{type(values).__name__}",
        )
    if is_array and values.ndim != 1:  # type: ignore[attr-defined]
        raise InvalidMessageError(
            field,
            values,
            f"must have one dimension, has shape {values.shape}",  # type: ignore[attr-defined]
        )
    elements: Any = values
    if len(elements) not in (0, len(joint_names)):
        raise InvalidMessageError(
            field,
            values,
            f"must have {len(joint_names)} elements, one per joint, or none, has "
            f"{len(elements)}",
        )
    if is_array and elements.dtype.kind in "iuf":
        with np.errstate(
            over="ignore"
        ):  # An overflow gives infinity, which is refused.
            return np.asarray(elements, dtype=float)
    numbers = np.empty(len(elements))
    for index, element in enumerate(elements):
        number = as_float(element)
        if number is None:
            raise InvalidMessageError(
                f"{field}[{index}]",
                element,
                f"must be a number, is {shown(element)} (joint {joint_names[index]})",
            )
        numbers[index] = number
    return numbers
