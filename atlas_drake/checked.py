"""Reads and checks configurations by pydantic, with this package's error messages.

Accepts the mapping of a YAML file and a value made in Python. What the fields may be is
declared beside them, see ``configuration``.
"""

from __future__ import annotations

import dataclasses
import functools
import operator
import re
import types
import typing
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
import yaml
from pydantic import TypeAdapter, ValidationError
from pydantic_core import core_schema
from pydrake.common.schema import Transform
from pydrake.common.yaml import yaml_dump, yaml_dump_typed, yaml_load, yaml_load_typed
from pydrake.math import RigidTransform

from atlas_drake.configuration import Configuration, take_yaml
from atlas_drake.errors import ScenarioError, did_you_mean, shown
from atlas_drake.numeric import is_number, plain_number

LARGEST = 1e6
"""Largest absolute value of a number in a scenario, in any unit: a thousand kilometres
from the origin, positions are still exact to a nanometre."""
_EXPONENT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+")
_SHOULD_BE = "Input should be "
_UNKNOWN = ("unexpected_keyword_argument", "extra_forbidden")


def checked(
    kind: Any, given: Any, path: str = "", *, base: Any = None, from_text: bool = False
) -> Any:
    """Checks a value with all its parts, and converts it to its declared type.

    Fractions, numpy's numbers and arrays become Python's own numbers and lists.

    Args:
        kind: Declared type, such as a ``Configuration``.
        given: A value of this type, or a mapping of some or all fields.
        path: Path of the value, such as ``terrain[0]``; empty for the whole file.
        base: Has the fields that a mapping leaves out; None for the defaults.
        from_text: True if ``given`` was read from YAML, which reads 1e-3 as a word.

    Raises:
        ScenarioError: Naming the first field that cannot be used.
    """
    plain = _plain(given, from_text)
    plain = overlaid(_defaults(kind) if base is None else _plain(base), plain)
    try:
        made = _adapter(kind).validate_python(plain)
    except ValidationError as error:
        raise _first(error, kind, path) from None
    _check_size(made, path)
    return made


def read_yaml(text: str) -> Any:
    """Reads a YAML text of mappings, lists and plain values.

    Raises:
        yaml.YAMLError: Naming line and column, if the text is not YAML, or if an alias
            stands within what it names: such a value has no end.
    """
    around: list[str | None] = []  # Anchors of the collections around an event.
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        if isinstance(event, yaml.CollectionStartEvent):
            around.append(event.anchor)
        elif isinstance(event, yaml.CollectionEndEvent):
            around.pop()
        elif isinstance(event, yaml.AliasEvent) and event.anchor in around:
            problem = f"the alias *{event.anchor} stands within what it names"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
    return yaml_load(data=text)


def overlaid(base: Any, given: Any) -> Any:
    """Returns ``base`` with the fields of ``given``, mapping by mapping."""
    if not (isinstance(base, Mapping) and isinstance(given, Mapping)):
        return given
    changed = {
        name: overlaid(base[name], value) if name in base else value
        for name, value in given.items()
    }
    return {**base, **changed}


def as_plain(value: Any) -> Any:
    """Converts the value to mappings, lists and plain values, as in YAML."""
    if isinstance(value, Transform):
        return yaml_load(data=yaml_dump_typed(value))
    if isinstance(value, list | tuple):
        return [as_plain(element) for element in value]
    if (names := _names(type(value))) is not None:
        return {name: as_plain(getattr(value, name)) for name in names}
    return value


class OfDrake:
    """Annotation of a field that holds one of Drake's configurations."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Describes the fields of Drake's class to pydantic."""
        fields = {
            field.name: core_schema.typed_dict_field(
                handler.generate_schema(field.type), required=False
            )
            for field in source.__fields__
        }
        config = core_schema.CoreConfig(strict=True)
        mapping = core_schema.typed_dict_schema(
            fields, extra_behavior="forbid", config=config
        )
        return core_schema.no_info_after_validator_function(
            lambda values: source(**values), mapping
        )


@dataclasses.dataclass(frozen=True)
class As:
    """Annotation of a field that is read as another type than it is given."""

    kind: Any

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Describes the other type to pydantic."""
        return handler.generate_schema(self.kind)


class Pose:
    """Annotation of a field that holds Drake's ``Transform``."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Describes to pydantic how a pose is read; its rotation has several forms."""
        return core_schema.no_info_plain_validator_function(_pose)


def _pose(value: Any) -> Transform:
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
        raise ValueError(f"is {shown(value)}: {why}") from error
    wanted = "a pose, such as {translation: [1.0, 0.0, 0.5]}"
    raise ValueError(f"is {shown(value)}; must be {wanted}")


@functools.cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(declared(kind))


def declared(kind: Any) -> Any:
    """Returns the type; a user's own dataclass is read as a ``Configuration``."""
    is_class = isinstance(kind, type) and dataclasses.is_dataclass(kind)
    if not is_class or issubclass(kind, Configuration):
        return kind
    kind.__pydantic_config__ = Configuration.__pydantic_config__
    return Annotated[kind, _Mapping()]


class _Mapping:
    """Annotation of a user's own dataclass, to be read as a ``Configuration`` is."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return take_yaml(handler(source), handler)


def _names(kind: Any) -> dict[str, Any] | None:
    """Returns the fields' types by name; None if the type has no fields."""
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind, include_extras=True)
        return {field.name: hints[field.name] for field in dataclasses.fields(kind)}
    fields = getattr(kind, "__fields__", None)
    return None if fields is None else {one.name: one.type for one in fields}


def _defaults(kind: Any) -> Any:
    """Returns the defaults of a dataclass' fields, as mappings."""
    if not dataclasses.is_dataclass(kind):
        return None
    found = {}
    for field in dataclasses.fields(kind):
        if field.default is not dataclasses.MISSING:
            found[field.name] = _plain(field.default)
        elif field.default_factory is not dataclasses.MISSING:
            found[field.name] = _plain(field.default_factory())
    return found


def _plain(value: Any, from_text: bool = False) -> Any:
    """Converts structures to mappings, and numbers and sequences to Python's own."""
    if isinstance(value, Transform | type):
        return value
    if isinstance(value, str):
        is_exponent = from_text and _EXPONENT.fullmatch(value)
        return float(value) if is_exponent else value
    if isinstance(value, Mapping):
        return {name: _plain(item, from_text) for name, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        items = [_plain(item, from_text) for item in value]
        # An error shows the list that was given, where nothing in it changed.
        same = isinstance(value, list) and all(map(operator.is_, items, value))
        return value if same else items
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value)]
        return {name: _plain(getattr(value, name)) for name in names}
    if hasattr(value, "__fields__"):
        names = [field.name for field in value.__fields__]
        return {name: getattr(value, name) for name in names}
    return plain_number(value)


def _check_size(value: Any, path: str) -> None:
    """Refuses numbers so large that positions lose their precision."""
    if isinstance(value, float) and abs(value) > LARGEST:
        raise _wrong(path, value, f"within ±{LARGEST:g}")
    if isinstance(value, list | tuple):
        for index, item in enumerate(value):
            _check_size(item, f"{path}[{index}]")
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            _check_size(getattr(value, field.name), joined(path, field.name))


def _first(error: ValidationError, kind: Any, path: str) -> ScenarioError:
    """Returns the first of pydantic's errors as this package reports it."""
    faults = error.errors(include_url=False)
    # A field with a mistyped name is missing, too.
    fault = next((one for one in faults if one["type"] in _UNKNOWN), faults[0])
    where, known = path, kind
    for part in fault["loc"]:
        owner = _structure(known)
        where = f"{where}[{part}]" if isinstance(part, int) else joined(where, part)
        known = _part(owner, part)
    value = fault["input"]
    name = fault["type"]
    if name in _UNKNOWN:
        names = list(_names(owner) or ())
        last = str(fault["loc"][-1])
        hint = did_you_mean(last, names) or f" There are {', '.join(names)}."
        return ScenarioError(where, value, f"there is no such field.{hint}")
    if name in ("missing", "string_too_short"):
        hints = [note for note in _notes(known) if isinstance(note, str)]
        return ScenarioError(where, None, "; ".join(["is missing", *hints]))
    if isinstance(cause := fault.get("ctx", {}).get("error"), ScenarioError):
        below = cause.field
        where = joined(where, below) if below else where
        return ScenarioError(where, cause.value, cause.problem)
    if name == "value_error":
        return ScenarioError(where, value, str(fault["ctx"]["error"]))
    if name == "float_type" and is_number(value):
        return _wrong(where, value, f"within ±{LARGEST:g}")
    if name in ("dataclass_type", "dict_type") and _names(_structure(known)):
        return _wrong(where, value, _example(_structure(known)))
    if name == "bool_type":  # In the words of YAML.
        return _wrong(where, value, "true or false")
    said = fault["msg"].replace(" after validation", "")
    if said.startswith(_SHOULD_BE):
        return _wrong(where, value, said.removeprefix(_SHOULD_BE))
    return ScenarioError.about(where, value, said)


def _structure(kind: Any) -> Any:
    """Returns the type without annotations and without None."""
    if typing.get_origin(kind) is Annotated:
        return _structure(typing.get_args(kind)[0])
    if typing.get_origin(kind) in (types.UnionType, typing.Union):
        one = next(a for a in typing.get_args(kind) if a is not type(None))
        return _structure(one)
    return kind


def _part(kind: Any, part: str | int) -> Any:
    """Returns the type of a field or of an element; None if it is not known."""
    names = _names(kind)
    if names is not None:
        return names.get(str(part))
    arguments = typing.get_args(kind)
    return arguments[0] if isinstance(part, int) and arguments else None


def _notes(kind: Any) -> tuple[Any, ...]:
    """Returns the annotations of a type that may be None."""
    if typing.get_origin(kind) is Annotated:
        inner, *notes = typing.get_args(kind)
        return (*notes, *_notes(inner))
    if typing.get_origin(kind) in (types.UnionType, typing.Union):
        return sum((_notes(one) for one in typing.get_args(kind)), ())
    return ()


def _example(kind: Any) -> str:
    example = next(iter(_names(kind) or ()))
    default = shown(as_plain(getattr(kind(), example)))
    return f"fields of a {kind.__name__}, such as {example}: {default}"


def joined(path: str, name: object) -> str:
    """Returns the path of a field below a path, which may be empty."""
    return f"{path}.{name}" if path else str(name)


def _wrong(path: str, value: object, wanted: str) -> ScenarioError:
    return ScenarioError.about(path or "scenario", value, f"must be {wanted}")
