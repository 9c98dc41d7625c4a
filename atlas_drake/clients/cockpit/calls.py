"""Calls functions by name with arguments from outside, whose types are checked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import ConfigDict, ValidationError, validate_call

from atlas_drake.errors import InvalidMessageError

_STRICT = ConfigDict(strict=True, arbitrary_types_allowed=True)


def offered(**functions: Callable[..., Any]) -> dict[str, Callable[..., Any]]:
    """Offers functions by name; their annotations say what they take."""
    checked = validate_call(config=_STRICT)
    return {name: checked(function) for name, function in functions.items()}


def call(
    functions: Mapping[str, Callable[..., Any]],
    name: str,
    values: Mapping[str, Any],
    *arguments: Any,
) -> Any:
    """Calls one of the functions that are offered, with values by name.

    Raises:
        InvalidMessageError: If there is none of this name, or it takes other values.
    """
    if name not in functions:
        raise InvalidMessageError("do", name, f"nothing here does {name!r}")
    try:
        return functions[name](*arguments, **values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(map(str, first["loc"]))
        problem = f"{name} cannot use this {field}: {first['msg']}"
        raise InvalidMessageError(field, first["input"], problem) from None
