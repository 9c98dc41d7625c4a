"""Types of the fields of messages: what a field may hold, and in which form it is kept.

The messages declare them beside their fields; ``door`` checks values against them.
"""

import math
from typing import Annotated, Any

import numpy as np
from annotated_types import Ge, Gt, Interval
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, GetPydanticSchema

from atlas_drake.config import plain_number, read_as

LARGEST = 1e12
"""Greatest magnitude of a number in a message, in any unit: products of larger numbers
could leave the range of floating point."""
MAX_INDEX = 2**31 - 1
"""Greatest number of a step or a behavior: the original has 32 bits for them."""
K_EFFORT_MAX = 255
"""``k_effort`` of a joint that the user controls alone."""
MIN_NORM = 1e-6
"""Below this norm the direction of a quaternion or ground normal is rounding noise."""


def _number(value: Any) -> Any:
    """Converts a number of any type to Python's own."""
    value = plain_number(value)
    if isinstance(value, bool) or not isinstance(value, float | int):
        raise ValueError("must be a number")
    return value


def _whole(value: Any) -> Any:
    """Converts a number without fraction to ``int``."""
    value = plain_number(value)
    is_whole = isinstance(value, float) and value.is_integer()
    return int(value) if is_whole else value


def _flag(value: Any) -> Any:
    """Converts 0 and 1 of any type to a truth value."""
    value = plain_number(value)
    return bool(value) if type(value) is int and value in (0, 1) else value


Number = Annotated[float, BeforeValidator(_number), Interval(ge=-LARGEST, le=LARGEST)]
"""A finite number."""
NotNegative = Annotated[Number, Ge(0.0)]
"""A number that is 0 or more."""
Positive = Annotated[Number, Gt(0.0)]
"""A number above 0."""
Flag = Annotated[bool, BeforeValidator(_flag)]
"""True or False; 1 or 0 in the original interface."""
Byte = Annotated[int, BeforeValidator(_whole), Interval(ge=0, le=255)]
"""A whole number of one byte."""
Index = Annotated[int, BeforeValidator(plain_number)]
"""A whole number of 32 bits."""


def several(element: Any) -> GetPydanticSchema:
    """Returns the annotation of a list, tuple or array that is kept as a tuple."""
    elements: Any = tuple[element, ...]
    return read_as(Annotated[elements, BeforeValidator(_as_tuple)])


def _as_tuple(value: Any) -> tuple[Any, ...]:
    if isinstance(value, list | tuple):
        return tuple(value)
    if not isinstance(value, np.ndarray):
        raise ValueError("must be a list, tuple or array")
    if value.ndim != 1:
        raise ValueError(f"must have one dimension, has shape {value.shape}")
    # Elements of another type than a number keep it, to be refused one by one.
    return tuple(value.tolist() if value.dtype.kind in "iuf" else value)


Numbers = Annotated[list[float] | NDArray[Any], several(Number)]
"""One number for each joint in message order, or none: "keep the values in force"."""
Gains = Annotated[list[float] | NDArray[Any], several(NotNegative)]
"""A gain for each joint, or none."""
Shares = Annotated[list[int] | NDArray[Any], several(Byte)]
"""The user's share for each joint, 0 for the behavior alone to 255, or none."""


def not_zero(axes: str) -> AfterValidator:
    """Returns the annotation of a vector or quaternion with these axes."""

    def check(vector: Any) -> Any:
        if math.hypot(*(getattr(vector, axis) for axis in axes)) < MIN_NORM:
            raise ValueError("must not be zero")
        return vector

    return AfterValidator(check)
