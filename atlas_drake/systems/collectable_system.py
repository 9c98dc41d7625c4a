"""The base of this package's LeafSystems: one that Python can free again.

About memory alone; nothing here is simulated.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pydrake.systems.framework import (
    CacheEntry,
    Context,
    DependencyTicket,
    LeafSystem,
    OutputPort,
)


class CachedValue:
    """A cache entry by its number.

    Drake's own ``CacheEntry`` keeps its system, again where nobody can see it, and so
    must not be kept by it.
    """

    def __init__(self, system: LeafSystem, entry: CacheEntry) -> None:
        self._system = system
        self._index = entry.cache_index()

    def Eval(self, context: Context) -> Any:
        """As Drake's."""
        return self._system.get_cache_entry(self._index).Eval(context)

    def ticket(self) -> DependencyTicket:
        """As Drake's."""
        return self._system.get_cache_entry(self._index).ticket()


class CollectableSystem(LeafSystem):
    """A LeafSystem that is freed, with its diagram, when nobody uses it any more.

    A plain LeafSystem in Python is immortal, for three reasons. Drake keeps the
    callbacks of output ports and cache entries, which know their system, where Python's
    garbage collector cannot see them: here Python keeps them, and Drake calls them
    through weak references. A cache entry keeps its system likewise: here a
    ``CachedValue`` stands for it. And Python 3.11 counts twice what is in the
    ``__dict__`` of a subclass of a binding: every subclass has to say
    ``__slots__ = ()``, and uses the ``__dict__`` of its base.

    docs/memory.md has them in a table, and a system that shows the first.
    """

    if not TYPE_CHECKING:  # mypy does not know of the __dict__ of Drake's classes.
        __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        """Checks the rule that one easily forgets.

        Raises:
            TypeError: If the class has a ``__dict__`` of its own.
        """
        super().__init_subclass__(**options)
        if "__slots__" not in cls.__dict__:
            raise TypeError(
                f"{cls.__name__} must say __slots__ = (), or is never freed"
            )

    def callback(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """What Drake may keep in place of a function that knows this system."""
        try:
            reference = weakref.ref(function)
        except TypeError:
            # One of C++'s own, such as ``AbstractValue.Clone``: it knows no system.
            return function
        self.__dict__.setdefault("_callbacks", []).append(function)

        def call(*arguments: Any) -> Any:
            known = reference()
            assert known is not None, "Drake calls a system that is gone"
            return known(*arguments)

        return call

    def DeclareVectorOutputPort(self, *args: Any, **kwargs: Any) -> OutputPort:
        """As Drake's."""
        args, kwargs = self._callbacks_in(args, kwargs)
        return super().DeclareVectorOutputPort(*args, **kwargs)

    def DeclareAbstractOutputPort(self, *args: Any, **kwargs: Any) -> OutputPort:
        """As Drake's."""
        args, kwargs = self._callbacks_in(args, kwargs)
        return super().DeclareAbstractOutputPort(*args, **kwargs)

    def DeclareCacheEntry(self, *args: Any, **kwargs: Any) -> CachedValue:
        """As Drake's, but for what it returns.

        A ``calc`` that knows this system goes through ``callback``: what a
        ``ValueProducer`` calls cannot be exchanged any more.
        """
        return CachedValue(self, super().DeclareCacheEntry(*args, **kwargs))

    def _callbacks_in(
        self, args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> tuple[tuple[Any, ...], dict[str, Any]]:
        def kept(value: Any) -> Any:
            return self.callback(value) if callable(value) else value

        return tuple(map(kept, args)), {name: kept(v) for name, v in kwargs.items()}
