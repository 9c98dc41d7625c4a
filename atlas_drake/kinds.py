"""Checks names, kinds and bounds of a scenario's values against its dataclasses.

Accepts the mapping of a YAML file and a scenario made in Python, and Drake's own
configurations as well as dataclasses. The dataclasses themselves check the meaning of
values and their combinations.

Drake's ``yaml_load_typed`` builds no frozen dataclass, checks no bounds, and names
neither the path of a fault nor the nearest valid word.
"""

from __future__ import annotations

import copy
import dataclasses
import math
import types
import typing
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydrake.common.schema import Transform
from pydrake.common.yaml import yaml_dump, yaml_dump_typed, yaml_load, yaml_load_typed
from pydrake.math import RigidTransform

from atlas_drake.bounds import Bounds
from atlas_drake.errors import ScenarioError, did_you_mean, shown
from atlas_drake.numeric import is_number, is_whole, plain_number

LARGEST = 1e6
"""Largest absolute value of a number in a scenario, in any unit: a thousand kilometres
from the origin, positions are still exact to a nanometre."""
_NAMES = {
    float: "a number",
    int: "a whole number",
    str: "a word",
    bool: "true or false",
    type(None): "null",
}


def typed(
    value: Any,
    kind: Any,
    path: str = "",
    *,
    default: Any = None,
    bounds: Bounds | None = None,
    from_text: bool = False,
) -> Any:
    """Checks a value with all its parts, and converts it to its declared type.

    Fractions, numpy's numbers and arrays become Python's own numbers and lists, because
    they cannot be written to a file or given to Drake.

    Args:
        value: Value of a field: plain, a sequence, a dataclass or, from text, a
            mapping.
        kind: Declared type of the field.
        path: Path of the field, such as ``terrain[0].size``; empty for the whole.
        default: Values of the fields that a mapping leaves out.
        bounds: Bounds of every number without bounds of its own.
        from_text: True if ``value`` was read from YAML, which reads 1e-3 as a word.

    Returns:
        The value; lists, and dataclasses that are not frozen, are changed in place.

    Raises:
        ScenarioError: If a field does not exist, is of another type or out of bounds;
            names the first one.
    """
    if typing.get_origin(kind) is Annotated:
        kind, *notes = typing.get_args(kind)
        bounds = next((note for note in notes if isinstance(note, Bounds)), bounds)
    if kind is Transform:
        return _transform(value, path)
    if _is_structure(kind):
        return _structure(value, kind, path, default, bounds, from_text)
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if origin is dict:
        if not isinstance(value, Mapping) or not all(isinstance(k, str) for k in value):
            raise _wrong(path, value, "a mapping of words")
        return dict(value)
    if origin in (list, tuple):
        if isinstance(value, str) or not isinstance(value, (Sequence, np.ndarray)):
            raise _wrong(path, value, "a list")
        # In this package all elements of a list or tuple have the same type.
        elements = [
            typed(
                element,
                arguments[0],
                f"{path}[{index}]",
                bounds=bounds,
                from_text=from_text,
            )
            for index, element in enumerate(value)
        ]
        if origin is tuple:
            return tuple(elements)
        if isinstance(value, list):
            value[:] = elements
            return value
        return elements
    kinds = arguments if origin in (types.UnionType, typing.Union) else (kind,)
    if value is None and type(None) in kinds:
        return None
    structures = [one for one in kinds if _is_structure(one)]
    nested = structures or any(typing.get_origin(one) is list for one in kinds)
    if nested:
        # What words and paths stand for has been read before: a structure is left.
        only = next(one for one in kinds if one is not type(None))
        return typed(
            value, only, path, default=default, bounds=bounds, from_text=from_text
        )
    if not any(_is(value, one, from_text) for one in kinds):
        names = [_NAMES.get(one, getattr(one, "__name__", str(one))) for one in kinds]
        raise _wrong(path, value, " or ".join(names))
    if float not in kinds:
        plain: Any = plain_number(value)
        if int in kinds and bounds is not None and not bounds.allow(plain):
            raise _wrong(path, plain, str(bounds))
        return plain
    return _number(value, path, bounds)


def as_plain(value: Any) -> Any:
    """Converts the value to mappings, lists and plain values, as in YAML."""
    if isinstance(value, Transform):
        return yaml_load(data=yaml_dump_typed(value))
    if isinstance(value, list | tuple):
        return [as_plain(element) for element in value]
    if _is_structure(type(value)):
        names = _fields(type(value))
        return {name: as_plain(getattr(value, name)) for name in names}
    return value


def _transform(value: Any, path: str) -> Transform:
    """Converts a value to Drake's ``Transform``, whose rotation has several forms."""
    if isinstance(value, Transform):
        return value
    try:
        if isinstance(value, RigidTransform):
            return Transform(value)
        if isinstance(value, Mapping):
            text = yaml_dump(dict(value))
            pose: Transform = yaml_load_typed(schema=Transform, data=text)
            return pose
    except Exception as error:  # Drake raises several kinds.
        why = str(error).partition("\n")[0].removeprefix("(): ")
        raise ScenarioError(path, value, f"is {shown(value)}: {why}") from error
    raise _wrong(path, value, "a pose, such as {translation: [1.0, 0.0, 0.5]}")


def _is_structure(kind: Any) -> bool:
    """Returns True for a dataclass or one of Drake's configurations."""
    return dataclasses.is_dataclass(kind) or hasattr(kind, "__fields__")


def _fields(kind: Any) -> dict[str, Any]:
    """Returns the types of a structure's fields by name."""
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind, include_extras=True)
        return {field.name: hints[field.name] for field in dataclasses.fields(kind)}
    return {field.name: field.type for field in kind.__fields__}


def _structure(
    value: Any,
    kind: Any,
    path: str,
    default: Any,
    bounds: Bounds | None,
    from_text: bool,
) -> Any:
    """Checks a dataclass, one of Drake's configurations, or the mapping of either."""
    kinds = _fields(kind)
    if isinstance(value, kind):
        base = value
        # Attributes with a mistyped name shall be found, too.
        given: Mapping[Any, Any] = getattr(value, "__dict__", None) or {
            name: getattr(value, name) for name in kinds
        }
    elif isinstance(value, Mapping):
        base = kind() if default is None else default
        given = value
    else:
        example = next(iter(kinds))
        base = kind() if default is None else default
        wanted = f"fields of a {kind.__name__}, such as {example}: "
        raise _wrong(path, value, wanted + shown(as_plain(getattr(base, example))))
    changes = {}
    for name, item in given.items():
        where = f"{path}.{name}" if path else str(name)
        if name not in kinds:
            hint = did_you_mean(str(name), kinds) or f" There are {', '.join(kinds)}."
            raise ScenarioError(where, item, f"there is no such field.{hint}")
        changes[name] = typed(
            item,
            kinds[name],
            where,
            default=_default(kind, name) if base is value else getattr(base, name),
            bounds=bounds,
            from_text=from_text,
        )
    try:
        return _changed(base, changes, in_place=base is value)
    except ScenarioError:
        raise
    except ValueError as error:  # From the structure's own check.
        raise ScenarioError(path, value, str(error)) from error


def _default(kind: Any, name: str) -> Any:
    """Returns the default of a dataclass' field, of which a mapping has a part."""
    for one in dataclasses.fields(kind) if dataclasses.is_dataclass(kind) else ():
        if one.name == name and one.default_factory is not dataclasses.MISSING:
            return one.default_factory()
    return None


def _changed(base: Any, changes: Mapping[str, Any], in_place: bool) -> Any:
    """Returns the structure with some fields changed, or a copy of a frozen one."""
    parameters = getattr(base, "__dataclass_params__", None)
    if parameters is not None and parameters.frozen:
        return dataclasses.replace(base, **changes)
    target = base if in_place else copy.deepcopy(base)
    for name, item in changes.items():
        setattr(target, name, item)
    return target


def _number(value: Any, path: str, bounds: Bounds | None) -> float:
    number: Any = float(value) if isinstance(value, str) else plain_number(value)
    # Without bounds, infinity and NaN are left to the field's own check.
    if number not in (math.inf, -math.inf) and abs(number) > LARGEST:
        raise _wrong(path, value, f"within ±{LARGEST:g}")
    if bounds is not None and not bounds.allow(number):
        # Show the number: YAML reads 1e-3 as a word.
        raise _wrong(path, float(number), str(bounds))
    return float(number)


def _is(value: object, kind: Any, from_text: bool) -> bool:
    if kind is float:
        if from_text and isinstance(value, str):
            return _reads_as_number(value)
        return is_number(value)
    if kind is int:
        return is_whole(value)
    if kind is Any:
        return True
    if typing.get_origin(kind) is Literal:
        return value in typing.get_args(kind)
    # No plain value is an instance of another generic type, such as an array of floats.
    return isinstance(kind, type) and isinstance(value, kind)


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
