"""Checks the entries of behaviors before the behaviors are built.

Names, numbers and colors are checked in ``behavior_catalog``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from keyword import iskeyword

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.errors import did_you_mean, shown
from atlas_drake.messages import AtlasSimInterfaceCommand
from atlas_drake.messages.behavior_catalog import BehaviorCatalog, BehaviorError


def checked_entries(
    behaviors: Iterable[BehaviorEntry], shipped: tuple[BehaviorEntry, ...]
) -> tuple[BehaviorEntry, ...]:
    """Returns entries of behaviors after checking names and places.

    Args:
        behaviors: The entries.
        shipped: Entries of the behaviors beside which they are.
    """
    own = tuple(behaviors) if isinstance(behaviors, Iterable) else (behaviors,)
    if not all(isinstance(entry, BehaviorEntry) for entry in own):
        problem = "must be a list of BehaviorEntry values"
        raise BehaviorError(f"behaviors {problem}, is {shown(behaviors)}")
    catalog = BehaviorCatalog((*shipped, *own))
    names = [entry.name for entry in catalog]
    default = ControllerConfig().with_behaviors(shipped)
    kinds = {one.name: type(getattr(default, one.name)) for one in fields(default)}
    for entry in own:
        _check_configuration(entry, kinds)
        _check_parameters(entry)
        _check_transitions(entry, names)
    return own


def _check_configuration(entry: BehaviorEntry, kinds: dict[str, type]) -> None:
    """Checks where the configuration stands, and adds it to the ``kinds`` in use."""
    if entry.config is None:
        return
    if isinstance(entry.config, type) or not is_dataclass(entry.config):
        raise BehaviorError(
            f"behavior {entry.name!r}: config must be an instance of a frozen "
            f"dataclass, is {shown(entry.config)}"
        )
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


def _check_transitions(entry: BehaviorEntry, names: list[str]) -> None:
    for field in ("follows", "leads_to"):
        for name in getattr(entry, field):
            if name not in names:
                raise BehaviorError(
                    f"behavior {entry.name!r}: {field} names {shown(name)}, which is "
                    f"no behavior.{did_you_mean(str(name), names)} Known are "
                    + ", ".join(names)
                )
