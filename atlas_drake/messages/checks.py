"""Checks of the arguments of a call, one each: a number, a vector, a flag.

``door`` checks messages.
"""

import math

import numpy as np
from numpy.typing import NDArray

from atlas_drake.config import as_float, is_whole
from atlas_drake.errors import InvalidMessageError, shown
from atlas_drake.messages.fields import LARGEST


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
