"""The base class of this package's LeafSystems, which Python can free.

Concerns memory only; nothing here is simulated.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    CacheEntry,
    Context,
    DependencyTicket,
    LeafSystem,
    OutputPort,
    ValueProducer,
)


class CachedValue:
    """A cache entry by its index.

    Drake's own ``CacheEntry`` keeps its system alive by a reference that the garbage
    collector does not see, so the system must not hold the entry.
    """

    def __init__(self, system: LeafSystem, entry: CacheEntry) -> None:
        self._system = system
        self._index = entry.cache_index()

    def Eval(self, context: Context) -> Any:
        """Evaluates the entry, as Drake's ``CacheEntry.Eval``."""
        return self._system.get_cache_entry(self._index).Eval(context)

    def ticket(self) -> DependencyTicket:
        """Returns the entry's ticket, as Drake's ``CacheEntry.ticket``."""
        return self._system.get_cache_entry(self._index).ticket()


class CollectableSystem(LeafSystem):
    """A LeafSystem that is freed, with its diagram, when it is no longer used.

    A plain LeafSystem in Python is never freed, for three reasons. First, Drake holds
    the callbacks of output ports and cache entries, which refer to their system, where
    Python's garbage collector cannot see them: here Python holds them, and Drake calls
    them through weak references. Second, a cache entry holds its system in the same
    way: here a ``CachedValue`` replaces the entry. Third, Python 3.11 counts references
    in the ``__dict__`` of a subclass of a binding twice: every subclass has to define
    ``__slots__ = ()``, and uses the ``__dict__`` of its base.

    docs/memory.md lists the reasons in a table, and shows a system with the first.
    """

    if not TYPE_CHECKING:  # mypy does not see the __dict__ of Drake's classes.
        __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        """Checks that a subclass defines ``__slots__``.

        Raises:
            TypeError: If the class does not, and so has its own ``__dict__``.
        """
        super().__init_subclass__(**options)
        if "__slots__" not in cls.__dict__:
            raise TypeError(
                f"{cls.__name__} must define __slots__ = (), or it is never freed"
            )

    def callback(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Returns a wrapper for Drake to hold in place of a function of this system."""
        try:
            reference = weakref.ref(function)
        except TypeError:
            # A C++ function, such as ``AbstractValue.Clone``, refers to no system.
            return function
        self.__dict__.setdefault("_callbacks", []).append(function)

        def call(*arguments: Any) -> Any:
            known = reference()
            assert known is not None, "Drake calls a system that was freed"
            return known(*arguments)

        return call

    def DeclareVectorOutputPort(self, *args: Any, **kwargs: Any) -> OutputPort:
        """Declares the port, as Drake's method."""
        args, kwargs = self._callbacks_in(args, kwargs)
        return super().DeclareVectorOutputPort(*args, **kwargs)

    def DeclareAbstractOutputPort(self, *args: Any, **kwargs: Any) -> OutputPort:
        """Declares the port, as Drake's method."""
        args, kwargs = self._callbacks_in(args, kwargs)
        return super().DeclareAbstractOutputPort(*args, **kwargs)

    def DeclareCacheEntry(self, *args: Any, **kwargs: Any) -> CachedValue:
        """Declares the entry, as Drake's method, and returns a ``CachedValue``.

        Wrap a ``calc`` that refers to this system with ``callback``: the functions of a
        ``ValueProducer`` cannot be replaced later.
        """
        return CachedValue(self, super().DeclareCacheEntry(*args, **kwargs))

    def declare_scratch_context(self, create: Callable[[], Context]) -> CachedValue:
        """Declares a plant's context for calculations, as an entry never calculated.

        It is part of this system's Context, so that every Context has its own.

        Args:
            create: Function that makes it, such as a plant's ``CreateDefaultContext``.

        Returns:
            The entry, whose ``Eval`` returns the plant's context. Set the plant's state
            before each use.
        """
        return self.DeclareCacheEntry(
            "scratch context",
            ValueProducer(
                allocate=self.callback(lambda: AbstractValue.Make(create())),
                calc=ValueProducer.NoopCalc,
            ),
            {self.nothing_ticket()},
        )

    def _callbacks_in(
        self, args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> tuple[tuple[Any, ...], dict[str, Any]]:
        def kept(value: Any) -> Any:
            return self.callback(value) if callable(value) else value

        return tuple(map(kept, args)), {name: kept(v) for name, v in kwargs.items()}
