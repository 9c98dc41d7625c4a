"""Names and kinds of a scenario's values, checked against its dataclasses.

Serves a YAML file's mapping and a scenario made in Python alike. What values mean, and
which go together, is for the dataclasses to check themselves.
"""

from __future__ import annotations

import dataclasses
import math
import types
import typing
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from atlas_drake.errors import ScenarioError, did_you_mean, shown
from atlas_drake.numeric import is_number, is_whole, plain_number

_NAMES = {
    float: "a number",
    int: "a whole number",
    str: "a word",
    bool: "true or false",
    type(None): "null",
}


def check_kinds(
    value: object, kind: Any, path: str = "", *, from_text: bool = False
) -> None:
    """Checks a value and all within it.

    Args:
        value: Of a field: plain, a sequence, a mapping or a dataclass.
        kind: What the field is declared to be.
        path: Of the field, such as ``terrain[0].size``; empty for the whole.
        from_text: Whether it was read from YAML, which takes 1e-3 for a word.

    Raises:
        ScenarioError: Naming the first field that does not exist or is of another kind.
    """
    if dataclasses.is_dataclass(kind):
        _check_fields(value, kind, path, from_text)
        return
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is list:
        if isinstance(value, str) or not isinstance(value, (Sequence, np.ndarray)):
            raise _wrong(path, value, "a list")
        element: object
        for index, element in enumerate(value):
            check_kinds(element, arguments[0], f"{path}[{index}]", from_text=from_text)
        return
    kinds = arguments if origin in (types.UnionType, typing.Union) else (kind,)
    if not any(_is(value, one, from_text) for one in kinds):
        raise _wrong(path, value, " or ".join(_NAMES[one] for one in kinds))
    if float in kinds and value is not None:
        number: Any = float(value) if isinstance(value, str) else plain_number(value)
        # Infinity and NaN are for each field to refuse in its own words.
        if number not in (math.inf, -math.inf) and abs(number) > LARGEST:
            raise _wrong(path, value, f"within ±{LARGEST:g}")


LARGEST = 1e6
"""Largest size of a number in a scenario, whatever its unit: a thousand kilometres from
the origin positions are still exact to a nanometre."""


def make_plain(value: Any) -> Any:
    """Returns a value of the right kind with numbers and lists as Python's own.

    Fractions, numpy's numbers and arrays mean the same, but cannot be written to a file
    or given to Drake. Dataclasses and lists are changed in place.
    """
    if dataclasses.is_dataclass(value):
        for name, item in vars(value).items():
            setattr(value, name, make_plain(item))
        return value
    if isinstance(value, list):
        value[:] = [make_plain(element) for element in value]
        return value
    if isinstance(value, (tuple, np.ndarray)):
        return [make_plain(element) for element in value]
    return plain_number(value)


def _check_fields(value: object, kind: Any, path: str, from_text: bool) -> None:
    if isinstance(value, Mapping):
        given: Mapping[Any, object] = value
    elif isinstance(value, kind):
        given = vars(value)
    else:
        wanted = f"fields of a {kind.__name__}, such as {_example(kind)}"
        raise _wrong(path, value, wanted)
    if isinstance(value, Mapping) and not isinstance(value, kind) and not from_text:
        names = [field.name for field in dataclasses.fields(kind)]
        if set(given) <= set(names):
            raise _wrong(path, value, f"a {kind.__name__}({', '.join(names)})")
    kinds = typing.get_type_hints(kind)
    for name, item in given.items():
        where = f"{path}.{name}" if path else str(name)
        if name not in kinds:
            known = ", ".join(kinds)
            hint = did_you_mean(str(name), kinds) or f" There are {known}."
            raise ScenarioError(where, item, f"there is no such field.{hint}")
        check_kinds(item, kinds[name], where, from_text=from_text)


def _example(kind: Any) -> str:
    name = dataclasses.fields(kind)[0].name
    return f"{name}: {getattr(kind(), name)}"


def _is(value: object, kind: type, from_text: bool) -> bool:
    if kind is float:
        if from_text and isinstance(value, str):
            return _reads_as_number(value)
        return is_number(value)
    if kind is int:
        return is_whole(value)
    return isinstance(value, kind)


def _reads_as_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _wrong(path: str, value: object, wanted: str) -> ScenarioError:
    return ScenarioError(
        path or "scenario", value, f"is {shown(value)}; must be {wanted}"
    )
