"""Checks the entries of the user's own behaviors before the behaviors are built.

Names, numbers and colors are checked in ``behavior_catalog``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import fields
from keyword import iskeyword
from typing import Any

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.errors import did_you_mean, shown
from atlas_drake.messages import AtlasSimInterfaceCommand
from atlas_drake.messages.behavior_catalog import BehaviorCatalog, BehaviorError


def checked_entries(
    behaviors: Iterable[BehaviorEntry], shipped: tuple[BehaviorEntry, ...]
) -> tuple[BehaviorEntry, ...]:
    """Returns the entries of the user's own behaviors after checking every field.

    Args:
        behaviors: The entries.
        shipped: Entries of the behaviors beside which they are.
    """
    if not isinstance(behaviors, Iterable):
        raise BehaviorError(
            f"behaviors must be a list of BehaviorEntry values, is {shown(behaviors)}"
        )
    own = tuple(behaviors)
    for entry in own:
        if not isinstance(entry, BehaviorEntry):
            raise BehaviorError(
                f"behaviors must be BehaviorEntry values, has {shown(entry)}"
            )
    catalog = BehaviorCatalog((*shipped, *own))
    names = [entry.name for entry in catalog]
    default = ControllerConfig().with_behaviors(shipped)
    kinds = {one.name: type(getattr(default, one.name)) for one in fields(default)}
    for entry in own:
        _check_fields(entry)
        _check_configuration(entry, kinds)
        _check_parameters(entry)
        _check_transitions(entry, names)
    return own


def _is_frozen_dataclass(value: object) -> bool:
    declared = getattr(value, "__dataclass_params__", None)
    return declared is not None and declared.frozen and not isinstance(value, type)


_FIELDS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "make": (callable, "callable with (tools, config)"),
    "config": (
        lambda value: value is None or _is_frozen_dataclass(value),
        "an instance of a frozen dataclass",
    ),
    "config_field": (
        lambda value: isinstance(value, str),
        "the name of a field, or empty",
    ),
    "check": (
        lambda value: value is None or callable(value),
        "callable with (params, field)",
    ),
    "conditions": (
        lambda value: isinstance(value, tuple) and all(map(callable, value)),
        "a tuple of callables",
    ),
    "follows": (lambda value: isinstance(value, tuple), "a tuple of names"),
    "leads_to": (lambda value: isinstance(value, tuple), "a tuple of names"),
}
"""Which values each field may have, and what it must be."""


def _check_fields(entry: BehaviorEntry) -> None:
    for field, (is_usable, requirement) in _FIELDS.items():
        value = getattr(entry, field)
        if not is_usable(value):
            raise BehaviorError(
                f"behavior {entry.name!r}: {field} must be {requirement}, is "
                f"{shown(value)}"
            )


def _check_configuration(entry: BehaviorEntry, kinds: dict[str, type]) -> None:
    """Checks where the configuration stands, and adds it to the ``kinds`` in use."""
    if entry.config is None:
        return
    place, kind = entry.configured_at, type(entry.config)
    usable = place.isidentifier() and not iskeyword(place)
    usable = usable and not hasattr(ControllerConfig, place)
    if not usable or kinds.setdefault(place, kind) is not kind:
        raise BehaviorError(
            f"behavior {entry.name!r}: its configuration cannot be the field "
            f"{place!r} of the controller; choose another config_field"
        )


def _check_parameters(entry: BehaviorEntry) -> None:
    # An entry made from a shipped entry reads the same parameters of the command.
    shared = getattr(AtlasSimInterfaceCommand(), str(entry.params_field), None)
    if entry.params_field != "params" and type(shared) is not entry.params:
        raise BehaviorError(
            f"behavior {entry.name!r}: params_field must be 'params', or a command's "
            f"field for these parameters, is {shown(entry.params_field)}"
        )
    if entry.params is None:
        return
    try:
        entry.params()
    except Exception as error:  # The user's own class may raise any error.
        raise BehaviorError(
            f"behavior {entry.name!r}: {entry.params.__name__}() fails with "
            f"{type(error).__name__}: {error}; all its fields need defaults"
        ) from error


def _check_transitions(entry: BehaviorEntry, names: list[str]) -> None:
    for field in ("follows", "leads_to"):
        for name in getattr(entry, field):
            if name not in names:
                raise BehaviorError(
                    f"behavior {entry.name!r}: {field} names {shown(name)}, which is "
                    f"no behavior.{did_you_mean(str(name), names)} Known are "
                    + ", ".join(names)
                )
