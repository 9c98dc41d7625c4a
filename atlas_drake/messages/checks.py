"""Checks of the arguments of a call, one each: a number, a vector, a flag, a type.

``door`` checks messages.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from atlas_drake.config import as_float
from atlas_drake.errors import InvalidMessageError, shown
from atlas_drake.messages.fields import LARGEST


def check_number(
    value: object,
    field: str,
    lower: float = -LARGEST,
    upper: float = LARGEST,
    *,
    whole: bool = False,
) -> float:
    """Check that a value is a number from ``lower`` to ``upper``, and return it.

    Args:
        value: The value; truth values are not numbers.
        field: Name of the argument, for the error.
        lower: Least value, in the field's unit.
        upper: Greatest value.
        whole: Only whole numbers are allowed.

    Raises:
        InvalidMessageError: If it is not; it names the field.
    """
    number = as_float(value)
    if number is None or not math.isfinite(number):
        requirement = "a finite number"
    elif number < lower:
        requirement = f"at least {lower:g}"
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
    """Check that a value has ``size`` numbers within ±``largest``; return an array."""
    values = values.tolist() if isinstance(values, np.ndarray) else values
    numbers = [*map(as_float, values)] if isinstance(values, list | tuple) else []
    vector = np.array(numbers, dtype=float)  # None becomes NaN.
    if vector.shape != (size,) or not (np.abs(vector) <= largest).all():
        problem = f"must be {size} numbers within ±{largest:g}, is {shown(values)}"
        raise InvalidMessageError(field, values, problem)
    return vector


def check_type(value: Any, kind: Any, name: str) -> Any:
    """Raise TypeError unless the value is of a type, and return it."""
    if not isinstance(value, kind):
        expected = getattr(kind, "__name__", kind)
        raise TypeError(f"{name} must be {expected}, is {shown(value)}")
    return value
