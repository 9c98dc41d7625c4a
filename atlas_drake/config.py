"""Declares, reads and checks configurations by pydantic.

Accepts the mapping of a YAML file and a value made in Python. A field's bounds and its
unit stand in its annotation, its text in the string below it.
"""

from __future__ import annotations

import ast
import dataclasses
import functools
import inspect
import itertools
import re
import textwrap
import types
import typing
from collections.abc import Callable, Mapping
from numbers import Integral, Real
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, ClassVar, NamedTuple, Self, TypeGuard, TypeVar

import numpy as np
import yaml
from annotated_types import Ge, Gt, Interval, Len
from pydantic import (
    AfterValidator,
    GetPydanticSchema,
    Strict,
    TypeAdapter,
    ValidationError,
)
from pydantic_core import core_schema

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.errors import ScenarioError, did_you_mean, shown
from atlas_drake.units import Ratio, unit_of


def is_number(value: object) -> TypeGuard[Real]:
    """Returns True for a real number; a truth value is none."""
    return isinstance(value, Real) and not isinstance(value, bool)


def is_whole(value: object) -> TypeGuard[int]:
    """Returns True for a number of an integer type; a truth value is none."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def as_float(value: object) -> float | None:
    """Converts a number to float; returns None for others and numbers too large."""
    try:
        return float(value) if is_number(value) else None
    except OverflowError:
        return None


def plain_number(value: object) -> object:
    """Converts a number or truth value of numpy's to Python's own, and no others."""
    return value.item() if isinstance(value, np.generic) else value


_Number = TypeVar("_Number", bound=float)
Positive = Annotated[_Number, Gt(0)]
"""A number above 0, such as a divisor: ``Positive[Seconds]``."""
NotNegative = Annotated[_Number, Ge(0)]
"""A number that is 0 or more: ``NotNegative[Seconds]``."""
Share = Annotated[Ratio, Interval(ge=0.0, le=1.0)]
"""A share of a whole."""
ProperShare = Annotated[Ratio, Interval(gt=0.0, lt=1.0)]
"""A share of a whole, neither 0 nor 1."""
Vector = Annotated[list[_Number], Len(3, 3)]
"""Three numbers: ``Vector[Meters]``."""


class LeastGreatest(NamedTuple):
    """A least and a greatest value."""

    least: Annotated[float, Strict()]
    greatest: Annotated[float, Strict()]


def _in_order(value: LeastGreatest) -> LeastGreatest:
    if value.least > value.greatest:
        raise ValueError(f"is {list(value)}; the least must not exceed the greatest")
    return value


Range = Annotated[LeastGreatest, AfterValidator(_in_order)]
"""A least and a greatest value, ``[least, greatest]`` in YAML: ``Annotated[Range,
Unit("m")]``."""


class Configuration:
    """Base of the frozen dataclasses that YAML files are read into.

    They are plain dataclasses, which pydantic reads by their annotations: making and
    replacing one in a control tick costs no check.
    """

    __pydantic_config__: ClassVar[dict[str, Any]] = {
        "arbitrary_types_allowed": True,
        "extra": "forbid",
        "strict": True,
        "allow_inf_nan": False,
    }

    def check(self) -> None:
        """Checks what types and bounds of single fields do not express.

        Raises:
            ValueError: Describes the fault; a ``ScenarioError`` names the field, too,
                as a path from this value.
        """

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """Describes the class to pydantic."""
        return finished_by(_after_check, _from_yaml(handler(source)))


class CheckedOnce(Configuration):
    """A configuration that remembers its check; ``replace`` makes one without."""

    is_checked: ClassVar[bool] = False

    def mark_checked(self) -> Self:
        """Marks a value as checked, and returns it."""
        object.__setattr__(self, "is_checked", True)
        return self


def _after_check(value: Configuration) -> Configuration:
    value.check()
    return value


def _from_yaml(part: Any) -> Any:
    """Returns a strict schema that takes mappings for its class, lists for tuples."""
    if isinstance(part, list):
        return [_from_yaml(item) for item in part]
    if not isinstance(part, dict):
        return part
    made = {name: _from_yaml(item) for name, item in part.items()}
    return {**made, "strict": False} if made.get("type") in _OF_YAML else made


def finished_by(function: Callable[[Any], Any], schema: Any) -> Any:
    """Describes a class to pydantic whose values ``function`` gets and returns."""
    # Under the same name: pydantic looks it up where it meets the class again.
    inner = {name: part for name, part in schema.items() if name != "ref"}
    return core_schema.no_info_after_validator_function(
        function, inner, ref=schema.get("ref")
    )


class OfDrake:
    """Annotation of a field that holds one of Drake's configurations."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        """Describes the fields of Drake's class to pydantic."""
        fields = {
            name: core_schema.typed_dict_field(
                handler.generate_schema(kind), required=False
            )
            for name, kind in fields_of(source).items()
        }
        config = core_schema.CoreConfig(strict=True)
        mapping = core_schema.typed_dict_schema(
            fields, extra_behavior="forbid", config=config
        )
        return core_schema.no_info_after_validator_function(
            lambda values: source(**values), mapping
        )


def read_as(kind: Any) -> GetPydanticSchema:
    """Annotation of a field that is read as another type than it is given."""
    return GetPydanticSchema(lambda _, handler: handler.generate_schema(kind))


def declared(kind: Any) -> Any:
    """Returns the type; a user's own dataclass is read as a ``Configuration``."""
    is_class = isinstance(kind, type) and dataclasses.is_dataclass(kind)
    if not is_class or issubclass(kind, Configuration):
        return kind
    kind.__pydantic_config__ = Configuration.__pydantic_config__
    return Annotated[kind, GetPydanticSchema(_of_users)]


def _of_users(kind: Any, handler: Any) -> Any:
    schema = _from_yaml(handler.resolve_ref_schema(handler(kind)))
    return {name: part for name, part in schema.items() if name != "ref"}


LARGEST = 1e6
"""Largest absolute value of a number in a scenario, in any unit: a thousand kilometres
from the origin, positions are still exact to a nanometre."""
_UNKNOWN = ("unexpected_keyword_argument", "extra_forbidden")
_OF_YAML = ("dataclass", "tuple")
"""Types of pydantic's schemas for which YAML has mappings and lists."""


def checked(kind: Any, given: Any, path: str = "", *, base: Any = None) -> Any:
    """Checks a value with all its parts, and converts it to its declared type.

    Numpy's numbers and arrays become Python's own numbers and lists.

    ``path`` is the value's place in its file for errors, such as ``terrain[0]``;
    ``base`` has the fields that a mapping leaves out, None stands for the defaults.
    """
    plain = as_plain(defaults(kind) if base is None else base)
    try:
        made = _adapter(kind).validate_python(overlaid(plain, as_plain(given)))
    except ValidationError as error:
        raise _first(error, kind, path) from None
    _check_size(made, path)
    return made


@functools.cache
def _adapter(kind: Any) -> TypeAdapter[Any]:
    return TypeAdapter(declared(kind))


def defaults(kind: Any) -> dict[str, Any] | None:
    """Returns the defaults of a dataclass' fields; None for another type."""
    if not dataclasses.is_dataclass(kind):
        return None
    found = {}
    for field in dataclasses.fields(kind):
        if field.default is not dataclasses.MISSING:
            found[field.name] = field.default
        elif field.default_factory is not dataclasses.MISSING:
            found[field.name] = field.default_factory()
    return found


def overlaid(base: Any, given: Any) -> Any:
    """Returns ``base`` with the fields of ``given``, mapping by mapping."""
    if not (isinstance(base, Mapping) and isinstance(given, Mapping)):
        return given
    changed = {
        name: overlaid(base[name], value) if name in base else value
        for name, value in given.items()
    }
    return {**base, **changed}


@functools.singledispatch
def as_plain(value: Any) -> Any:
    """Converts the value to mappings, lists and plain values, as in YAML."""
    if isinstance(value, np.ndarray):
        return as_plain(value.tolist())
    if isinstance(value, list | tuple):
        return [as_plain(element) for element in value]
    if isinstance(value, Mapping):
        return {name: as_plain(item) for name, item in value.items()}
    kind: Any = type(value)
    if fields := fields_of(kind):
        return {name: as_plain(getattr(value, name)) for name in fields}
    return plain_number(value)


def _check_size(value: Any, path: str) -> None:
    """Refuses numbers so large that positions lose their precision."""
    if isinstance(value, float) and abs(value) > LARGEST:
        raise ScenarioError.about(path, value, f"must be within ±{LARGEST:g}")
    if isinstance(value, list | tuple):
        for index, item in enumerate(value):
            _check_size(item, f"{path}[{index}]")
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            _check_size(getattr(value, field.name), joined(path, field.name))


def _first(error: ValidationError, kind: Any, path: str) -> ScenarioError:
    """Returns the first of pydantic's errors, with path, value and unit in front."""
    faults = error.errors(include_url=False)
    # A field with a mistyped name is missing, too.
    fault = next((one for one in faults if one["type"] in _UNKNOWN), faults[0])
    where, value, owner = path, fault["input"], None
    for part in fault["loc"]:
        owner = _structure(kind)
        if isinstance(part, int):
            where = f"{where}[{part}]"
            kind = next(iter(typing.get_args(owner)), None)
        else:
            where = joined(where, part)
            kind = fields_of(owner).get(part)
    if fault["type"] in _UNKNOWN:
        known = fields_of(owner)
        hint = did_you_mean(str(fault["loc"][-1]), known)
        hint = hint or f" There are {', '.join(known)}."
        return ScenarioError(where, value, f"there is no such field.{hint}")
    if fault["type"] == "missing":
        return ScenarioError(where, None, "is missing")
    if isinstance(cause := fault.get("ctx", {}).get("error"), ValueError):
        if isinstance(cause, ScenarioError):
            below = joined(where, cause.field) if cause.field else where
            return ScenarioError(below, cause.value, cause.problem)
        return ScenarioError(where, value, str(cause))
    said = fault["msg"].replace("Input should be", "must be")
    with_unit = shown(value)
    if is_number(value) and (unit := unit_of(kind)) not in (None, "-"):
        with_unit += f" {unit}"
    return ScenarioError(where or "file", value, f"is {with_unit}; {said}")


def _structure(kind: Any) -> Any:
    """Returns the type without annotations and without None."""
    if typing.get_origin(kind) is Annotated:
        return _structure(typing.get_args(kind)[0])
    if typing.get_origin(kind) in (types.UnionType, typing.Union):
        one = next(a for a in typing.get_args(kind) if a is not type(None))
        return _structure(one)
    return kind


@functools.cache
def fields_of(kind: Any) -> dict[str, Any]:
    """Returns the fields' annotations by name; empty if the type has no fields."""
    if isinstance(kind, type) and dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind, include_extras=True)
        return {field.name: hints[field.name] for field in dataclasses.fields(kind)}
    return {field.name: field.type for field in getattr(kind, "__fields__", ())}


def joined(path: str, name: object) -> str:
    """Returns the path of a field below a path, which may be empty."""
    return f"{path}.{name}" if path else str(name)


MAX_VALUES = 1_000_000
"""Largest number of values in a YAML text; an alias counts as all that it names."""


class _Loader(yaml.SafeLoader):
    """Refuses what would be read otherwise than it looks.

    A tag, such as ``!Rpy``, becomes the key ``_tag``, as Drake reads it.
    """

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Composes a node, and counts the values within."""
        event = self.peek_event()
        node = super().compose_node(parent, index)
        if isinstance(event, yaml.AliasEvent):
            if not hasattr(node, "size"):
                problem = f"the alias *{event.anchor} stands within what it names"
                raise yaml.MarkedYAMLError(
                    problem=problem, problem_mark=event.start_mark
                )
            return node
        parts = node.value if isinstance(node.value, list) else []
        if isinstance(node, yaml.MappingNode):
            _check_keys(node)
            parts = [part for pair in parts for part in pair]
        node.size = 1 + sum(part.size for part in parts)
        if node.size > MAX_VALUES:
            problem = f"there are more than {MAX_VALUES} values"
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=event.start_mark)
        return node

    def construct_tagged(self, tag: str, node: Any) -> dict[str, Any]:
        """Returns the mapping of a node with a tag."""
        return {**self.construct_mapping(node), "_tag": tag}


def _check_keys(node: yaml.MappingNode) -> None:
    known = set()
    for key, _ in node.value:
        problem = ""
        if key.tag == "tag:yaml.org,2002:merge":
            continue
        if key.tag != "tag:yaml.org,2002:str":
            shown_key = key.value if isinstance(key.value, str) else "of several values"
            problem = f"the key {shown_key} is no text; must be a field's name"
        elif key.value in known:
            problem = f"the key {key.value} is given twice"
        if problem:
            raise yaml.MarkedYAMLError(problem=problem, problem_mark=key.start_mark)
        known.add(key.value)


_Loader.add_multi_constructor("", _Loader.construct_tagged)
# YAML 1.1 demands a point, and reads 1e-3 as a word.
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+"),
    list("-+.0123456789"),
)


def read_yaml(text: str) -> Any:
    """Reads a YAML text of mappings, lists and plain values; None if it is empty.

    Keys of the whole text that begin with an underscore hold parts for aliases, and are
    left out.
    A fault raises a ValueError, in one line with the line's number.
    """
    try:
        found = yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        said = ": ".join(filter(None, (error.context, error.problem)))
        raise ValueError(f"line {mark.line + 1}: {said}" if mark else said) from None
    except yaml.YAMLError as error:
        raise ValueError(" ".join(str(error).split())) from None
    except RecursionError:
        raise ValueError("mappings and lists are nested too deeply") from None
    if isinstance(found, dict):
        return {name: item for name, item in found.items() if not name.startswith("_")}
    return found


def read_file(path: str | Path) -> str:
    """Reads a text file."""
    try:
        if problem := why_not_readable(Path(path)):
            raise OSError(problem)
        return Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ScenarioError("file", str(path), f"cannot be read: {error}") from None


def read_fields(text: str, example: str) -> dict[str, Any]:
    """Reads a YAML text of a mapping; ``example`` shows one of its fields."""
    try:
        raw = read_yaml(text)
    except ValueError as error:
        raise ScenarioError("file", text, f"cannot be read: {error}") from None
    if not isinstance(raw, dict):
        raise ScenarioError("file", raw, f"must have fields, such as {example}")
    return raw


@functools.cache
def trailing_strings(owner: type | ModuleType) -> dict[str, str]:
    """Returns the string after each assignment in a class or a module, by name.

    There are none without the source, as in a package of compiled files.
    """
    try:
        source = inspect.getsource(owner)
    except (OSError, TypeError):
        return {}
    body: list[ast.stmt] = ast.parse(textwrap.dedent(source)).body
    if isinstance(body[0], ast.ClassDef) and inspect.isclass(owner):
        body = body[0].body
    found: dict[str, str] = {}
    for node, after in itertools.pairwise(body):
        if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
            targets = getattr(node, "targets", [getattr(node, "target", None)])
            names = [one.id for one in targets if isinstance(one, ast.Name)]
            found |= dict.fromkeys(names, inspect.cleandoc(str(after.value.value)))
    return found
