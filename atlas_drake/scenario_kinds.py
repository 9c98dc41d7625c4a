"""Names and kinds of a scenario's values, checked against its dataclasses.

Serves a YAML file's mapping and a scenario made in Python alike. What values mean, and
which go together, is for the dataclasses to check themselves.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Mapping, Sequence
from numbers import Integral, Real
from typing import Any

import numpy as np

from atlas_drake.errors import ScenarioError, did_you_mean, shown

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


def _check_fields(value: object, kind: Any, path: str, from_text: bool) -> None:
    if isinstance(value, Mapping):
        given: Mapping[Any, object] = value
    elif isinstance(value, kind):
        given = vars(value)
    else:
        wanted = f"fields of a {kind.__name__}, such as {_example(kind)}"
        raise _wrong(path, value, wanted)
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
        return isinstance(value, Real) and not isinstance(value, (bool, np.bool_))
    if kind is int:
        return isinstance(value, Integral) and not isinstance(value, (bool, np.bool_))
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
