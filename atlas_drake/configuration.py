"""Declares configurations: their base class, and the bounds of their numbers.

Declarations only; ``checked`` reads and checks values against them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, ClassVar, NamedTuple, Self

from annotated_types import Ge, Gt, Interval, Len
from pydantic import AfterValidator, BeforeValidator

from atlas_drake.errors import shown

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
