"""What counts as a number, and numbers of any type as Python's own.

Bounds and the fields they belong to are in ``checks`` and in the scenario.
"""

import math
from numbers import Integral, Real
from typing import TypeGuard

import numpy as np

_NOT_NUMBERS = (bool, np.bool_, np.timedelta64)
"""Truth values, and durations, which numpy counts as integers."""


def is_number(value: object) -> TypeGuard[Real]:
    """Tell whether a value is a real number by its type."""
    return isinstance(value, Real) and not isinstance(value, _NOT_NUMBERS)


def is_whole(value: object) -> TypeGuard[int]:
    """Tell whether a value is a whole number by its type."""
    return isinstance(value, Integral) and not isinstance(value, _NOT_NUMBERS)


def as_float(value: object) -> float | None:
    """Convert a number to float, infinite where it is too large; else return None."""
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
    """Return a number as an ``int`` or ``float``, and everything else as it is.

    Truth values of numpy become Python's, and numbers of numpy and fractions the
    nearest float, so that no code behind a check meets a type that it cannot calculate
    with. What is beyond the range of a float stays as it is, for a check to refuse.
    """
    if isinstance(value, np.float64):
        return float(value)  # A float to Python already, but a type of its own.
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, (float, int)) or not is_number(value):
        return value
    if isinstance(value, Integral):
        return int(value)
    number = as_float(value)
    return value if number is None or math.isinf(number) else number
