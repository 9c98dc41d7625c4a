"""A plant's context to calculate in, for systems that have a plant but are none.

It lies in the system's own Context, so that every Context calculates in its own.
"""

from collections.abc import Callable

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, ValueProducer

from atlas_drake.systems.collectable_system import CachedValue, CollectableSystem


def declare_scratch_context(
    system: CollectableSystem, create: Callable[[], Context]
) -> CachedValue:
    """Declares it as a cache entry that is allocated and never calculated.

    Args:
        system: Whose Context shall hold it.
        create: Makes one, such as a plant's ``CreateDefaultContext``.

    Returns:
        The entry, whose ``Eval`` gives the plant's context. Whoever uses it sets the
        plant's state first.
    """
    return system.DeclareCacheEntry(
        "scratch context",
        ValueProducer(
            allocate=system.callback(lambda: AbstractValue.Make(create())),
            calc=ValueProducer.NoopCalc,
        ),
        {system.nothing_ticket()},
    )
