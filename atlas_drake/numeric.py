"""Recognizes numbers of any type, and converts them to Python's own.

Bounds of fields stand beside them.
"""

import math
from numbers import Integral, Real
from typing import TypeGuard

import numpy as np

_NOT_NUMBERS = (bool, np.bool_, np.timedelta64)
"""Truth values, and durations, which numpy counts as integers."""


def is_number(value: object) -> TypeGuard[Real]:
    """Returns True if the type of a value is that of a real number."""
    return isinstance(value, Real) and not isinstance(value, _NOT_NUMBERS)


def is_whole(value: object) -> TypeGuard[int]:
    """Returns True if the type of a value is that of a whole number."""
    return isinstance(value, Integral) and not isinstance(value, _NOT_NUMBERS)


def as_float(value: object) -> float | None:
    """Converts a number to float, infinite if too large; returns None for others."""
    if type(value) is float:
        return value
    if not is_number(value):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf  # type: ignore[operator]
    except (TypeError, ValueError):
        return None


def plain_number(value: object) -> object:
    """Converts a number to ``int`` or ``float``, and returns other values unchanged.

    Truth values of numpy become Python's, and numbers of numpy and fractions the
    nearest float, so that code after a check can calculate with them. A number beyond
    the range of a float is not changed, for a check to refuse.
    """
    if isinstance(value, np.float64):
        return float(value)  # A subclass of float.
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, (float, int)) or not is_number(value):
        return value
    if isinstance(value, Integral):
        return int(value)
    number = as_float(value)
    return value if number is None or math.isinf(number) else number
