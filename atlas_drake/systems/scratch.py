"""A scratch context of a plant, for systems that compute with a plant.

The scratch context is part of the system's Context, so that every Context has its own.
"""

from collections.abc import Callable

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import CacheEntry, Context, LeafSystem, ValueProducer

from atlas_drake.systems.collectable_system import CachedValue, CollectableSystem


def declare_scratch_context(
    system: LeafSystem, create: Callable[[], Context]
) -> CachedValue | CacheEntry:
    """Declares a scratch context as a cache entry that is never calculated.

    Args:
        system: The system whose Context shall hold the scratch context.
        create: Function that makes it, such as a plant's ``CreateDefaultContext``.

    Returns:
        The entry, whose ``Eval`` returns the plant's context. Set the plant's state
        before each use.
    """

    def allocate() -> AbstractValue:
        return AbstractValue.Make(create())

    # A user's system may be a plain LeafSystem, which holds its callbacks for ever.
    kept = isinstance(system, CollectableSystem)
    return system.DeclareCacheEntry(
        "scratch context",
        ValueProducer(
            allocate=system.callback(allocate) if kept else allocate,
            calc=ValueProducer.NoopCalc,
        ),
        {system.nothing_ticket()},
    )
