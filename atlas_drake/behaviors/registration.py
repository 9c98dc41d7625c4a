"""Checks the entries of the user's own behaviors before the behaviors are built.

Names, numbers and colors are checked in ``behavior_catalog``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from keyword import iskeyword
from typing import Any

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.shipped import SHIPPED_ENTRIES
from atlas_drake.errors import did_you_mean, shown
from atlas_drake.messages import AtlasSimInterfaceCommand
from atlas_drake.messages.behavior_catalog import BehaviorCatalog, BehaviorError


def registered(behaviors: Iterable[BehaviorEntry]) -> tuple[BehaviorEntry, ...]:
    """Returns the entries of the user's own behaviors after checking every field."""
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
    catalog = BehaviorCatalog((*SHIPPED_ENTRIES, *own))
    names = [entry.name for entry in catalog]
    default = ControllerConfig()
    kinds = {one.name: type(getattr(default, one.name)) for one in fields(default)}
    for entry in own:
        _check(entry, names, kinds)
    return own


def _check(entry: Any, names: list[str], kinds: dict[str, type]) -> None:
    """Raises BehaviorError if a field of an entry cannot be used."""

    def refuse(field: str, requirement: str) -> None:
        raise BehaviorError(
            f"behavior {entry.name!r}: {field} must be {requirement}, is "
            f"{shown(getattr(entry, field))}"
        )

    if not callable(entry.make):
        refuse("make", "callable with (tools, config)")
    config = entry.config
    frozen = getattr(config, "__dataclass_params__", None)
    if config is not None and (
        isinstance(config, type) or frozen is None or not frozen.frozen
    ):
        refuse("config", "an instance of a frozen dataclass")
    if not isinstance(entry.config_field, str):
        refuse("config_field", "the name of a field, or empty")
    if config is not None:
        place, kind = entry.configured_at, type(config)
        usable = place.isidentifier() and not iskeyword(place)
        usable = usable and not hasattr(ControllerConfig, place)
        if not usable or kinds.setdefault(place, kind) is not kind:
            raise BehaviorError(
                f"behavior {entry.name!r}: its configuration cannot be the field "
                f"{place!r} of the controller; choose another config_field"
            )
    if entry.check is not None and not callable(entry.check):
        refuse("check", "callable with (params, field)")
    # An entry made from a shipped entry reads the same parameters of the command.
    shared = getattr(AtlasSimInterfaceCommand(), str(entry.params_field), None)
    if entry.params_field != "params" and type(shared) is not entry.params:
        refuse("params_field", "'params', or a command's field for these parameters")
    if entry.params is not None:
        try:
            entry.params()
        except Exception as error:
            raise BehaviorError(
                f"behavior {entry.name!r}: {entry.params.__name__}() fails with "
                f"{type(error).__name__}: {error}; all its fields need defaults"
            ) from error
    if not isinstance(entry.conditions, tuple) or not all(
        map(callable, entry.conditions)
    ):
        refuse("conditions", "a tuple of callables")
    for field in ("follows", "leads_to"):
        value = getattr(entry, field)
        if not isinstance(value, tuple):
            refuse(field, "a tuple of names of behaviors")
        for name in value:
            if name not in names:
                raise BehaviorError(
                    f"behavior {entry.name!r}: {field} names {shown(name)}, which is "
                    f"no behavior.{did_you_mean(str(name), names)} Known are "
                    + ", ".join(names)
                )
