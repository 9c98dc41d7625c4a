"""Declares, reads and checks configurations by pydantic.

Accepts the mapping of a YAML file and a value made in Python. A field's bounds stand
in its annotation, its text in the string below it.
"""

from __future__ import annotations

import ast
import dataclasses
import functools
import inspect
import math
import operator
import re
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from numbers import Integral, Real
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, ClassVar, NamedTuple, Self, TypeGuard

import numpy as np
import yaml
from annotated_types import Ge, Gt, Interval, Len
from pydantic import AfterValidator, BeforeValidator, TypeAdapter, ValidationError
from pydantic_core import core_schema

from atlas_drake.errors import ScenarioError, did_you_mean, shown

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


Positive = Annotated[float, Gt(0.0)]
"""A number above 0, such as a divisor."""
NotNegative = Annotated[float, Ge(0.0)]
"""A number that is 0 or more."""
Share = Annotated[float, Interval(ge=0.0, le=1.0)]
"""A share of a whole [-]."""
ProperShare = Annotated[float, Interval(gt=0.0, lt=1.0)]
"""A share of a whole, neither 0 nor 1 [-]."""
Vector = Annotated[list[float], Len(3, 3)]
"""Three numbers."""


class LeastGreatest(NamedTuple):
    """A least and a greatest value."""

    least: float
    greatest: float


def _two_numbers(value: Any) -> Any:
    if isinstance(value, list | tuple) and len(value) == 2:
        return value
    raise ValueError(f"is {shown(value)}; must be two numbers, the least and greatest")


def _in_order(value: LeastGreatest) -> LeastGreatest:
    if value.least > value.greatest:
        raise ValueError(f"is {list(value)}; the least must not exceed the greatest")
    return value


Range = Annotated[
    LeastGreatest, BeforeValidator(_two_numbers), AfterValidator(_in_order)
]
"""A least and a greatest value, ``[least, greatest]`` in YAML."""


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
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> dict[str, Any]:
        """Describes the class to pydantic."""
        schema = take_yaml(handler(source), handler)
        return finished_by(_after_check, schema, handler)


def take_yaml(schema: dict[str, Any], handler: Any) -> dict[str, Any]:
    """Lets a strict schema take mappings for dataclasses, and lists for tuples."""
    whole = handler.resolve_ref_schema(schema)
    whole["strict"] = False
    pending: list[Any] = [whole["schema"]]
    while pending:
        part = pending.pop()
        if isinstance(part, dict):
            pending += part.values()
            if part.get("type") == "tuple":
                part["strict"] = False
        elif isinstance(part, list):
            pending += part
    return schema


def finished_by(
    function: Callable[[Any], Any], schema: dict[str, Any], handler: Any
) -> dict[str, Any]:
    """Lets pydantic hand each value of a class to ``function``, which returns it."""
    # In place, because other places of the same type refer to this description.
    whole = handler.resolve_ref_schema(schema)
    fields = {name: part for name, part in whole.items() if name != "ref"}
    whole.pop("schema")
    after = {"type": "no-info", "function": function}
    whole.update(type="function-after", function=after, schema=fields)
    for name in fields.keys() - {"type", "schema", "metadata"}:
        whole.pop(name, None)
    return schema


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
    from pydrake.common.yaml import yaml_load

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
    if _is_drake_pose(value):
        from pydrake.common.yaml import yaml_dump_typed

        return read_yaml(yaml_dump_typed(value))
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


def _is_drake_pose(value: Any) -> bool:
    """Returns True for Drake's ``Transform``, without loading Drake."""
    return type(value).__name__ == "Transform"


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
    if isinstance(value, type) or _is_drake_pose(value):
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


def trailing_strings(owner: type | ModuleType) -> dict[str, str]:
    """Returns the string after each assignment in a class or a module, by name.

    Raises:
        OSError: If there is no source.
    """
    body = _body(str(inspect.getsourcefile(owner)))
    if inspect.isclass(owner):
        for name in owner.__qualname__.split("."):
            body = next(
                (one.body for one in body if getattr(one, "name", None) == name),  # type: ignore[attr-defined]
                [],
            )
    found: dict[str, str] = {}
    names: list[str] = []
    for node in body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            names = [node.target.id]
        elif isinstance(node, ast.Assign):
            names = [t.id for t in node.targets if isinstance(t, ast.Name)]
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            found |= dict.fromkeys(names, inspect.cleandoc(str(node.value.value)))
            names = []
        else:
            names = []
    return found


@functools.lru_cache(maxsize=64)
def _body(path: str) -> Sequence[ast.stmt]:
    """Parses a file once for all its classes."""
    return ast.parse(Path(path).read_text()).body
