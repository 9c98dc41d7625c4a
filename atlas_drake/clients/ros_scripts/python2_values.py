"""What depends on the types of values in Python 2, and so cannot be translated.

That is ``/`` of whole numbers, functions that returned floats, and functions that took
floats for whole numbers.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from numbers import Integral
from types import ModuleType
from typing import Any

import numpy
import yaml

DIVIDE, DIVIDE_IN_PLACE = "__python2_div__", "__python2_idiv__"
"""Names of the functions for ``/`` and ``/=`` in the program's builtins."""


def divide(one: Any, other: Any) -> Any:
    """``/`` of Python 2."""
    return one // other if _whole(one) and _whole(other) else one / other


def _divide_in_place(one: Any, other: Any) -> Any:
    if _whole(one) and _whole(other):
        one //= other
    else:
        one /= other
    return one


def _whole(value: Any) -> bool:
    kind = getattr(getattr(value, "dtype", None), "kind", "no array")
    return isinstance(value, Integral) or kind in ("i", "u")


def _round(number: float, digits: int = 0) -> float:
    """Round halves away from zero; return a float."""
    scale = 10.0**digits
    return math.copysign(math.floor(abs(number) * scale + 0.5) / scale, number)


def _as_whole(value: Any) -> Any:
    """Return whole floats as integers, also those in a shape of several."""
    if isinstance(value, tuple | list):
        return [_as_whole(part) for part in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _counting(function: Callable[..., Any], place: int, name: str) -> Any:
    """Return a function that takes a whole float as its count or shape.

    The argument has a ``place`` among those by position, and a ``name``.
    """

    @functools.wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        given = list(arguments)
        given[place : place + 1] = map(_as_whole, given[place : place + 1])
        if name in named:
            named[name] = _as_whole(named[name])
        return function(*given, **named)

    return call


BUILTINS: dict[str, Any] = {
    DIVIDE: divide,
    DIVIDE_IN_PLACE: _divide_in_place,
    "cmp": lambda one, other: (one > other) - (one < other),
    "file": open,
    "range": lambda *limits: range(*map(_as_whole, limits)),
    "reduce": functools.reduce,
    "round": _round,
}
"""Builtins of Python 2 that fissix does not translate."""

NUMPY_COUNTS = {
    **dict.fromkeys(("empty", "ones", "zeros"), (0, "shape")),
    "eye": (0, "N"),
    "identity": (0, "n"),
    "linspace": (2, "num"),
}
"""Functions of numpy that took whole floats: place and name of that argument."""


def old_modules() -> dict[str, ModuleType]:
    """Return ``math``, ``numpy`` and ``yaml`` as they were."""
    changed = {
        "ceil": lambda number: float(math.ceil(number)),
        "floor": lambda number: float(math.floor(number)),
    }
    counting = {
        name: _counting(getattr(numpy, name), place, argument)
        for name, (place, argument) in NUMPY_COUNTS.items()
    }
    types = {kind.__name__: kind for kind in (bool, float, int)}

    def load(stream: Any, Loader: Any = yaml.SafeLoader) -> Any:
        return yaml.load(stream, Loader)

    return {
        "math": with_names(math, changed),
        "numpy": with_names(numpy, counting | types),
        "yaml": with_names(yaml, {"load": load}),
    }


def with_names(module: ModuleType, names: dict[str, Any]) -> ModuleType:
    """Return a copy of a module in which some names have another meaning."""
    result = ModuleType(module.__name__, module.__doc__)
    vars(result).update({**vars(module), **names})
    return result
