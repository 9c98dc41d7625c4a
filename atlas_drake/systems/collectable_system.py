"""The base class of this package's LeafSystems, which Python can free.

A plain LeafSystem in Python is never freed, nor is a diagram that has one
(https://github.com/RobotLocomotion/drake/issues/22515): each simulation that a program
builds would leave 3 MB, and with a view 7 MB, a thread and a port.
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
    InputPort,
    LeafSystem,
    OutputPort,
    State,
    ValueProducer,
)

from atlas_drake.frozen import NOTHING

Compute = Callable[[Context], Any]
"""Computes the value of a port or cache entry; it depends on its prerequisites."""
Tickets = set[DependencyTicket]


class CachedValue:
    """A cache entry by its index; Drake's ``CacheEntry`` keeps its system alive."""

    def __init__(self, system: LeafSystem, entry: CacheEntry) -> None:
        self._system, self._index = system, entry.cache_index()

    def Eval(self, context: Context) -> Any:
        """Evaluates the entry, as Drake's ``CacheEntry.Eval``."""
        return self._system.get_cache_entry(self._index).Eval(context)

    def ticket(self) -> DependencyTicket:
        """Returns the entry's ticket, as Drake's ``CacheEntry.ticket``."""
        return self._system.get_cache_entry(self._index).ticket()


class ValueState:
    """A state of a system that holds any Python object."""

    def __init__(self, system: LeafSystem, start: Any) -> None:
        self.index = system.DeclareAbstractState(AbstractValue.Make(start))

    def get(self, context: Context) -> Any:
        """Returns the value."""
        return context.get_abstract_state(self.index).get_value()

    def set(self, state: Context | State, value: Any) -> None:
        """Sets the value in a context, or in the state that an update fills in."""
        state.get_mutable_abstract_state(self.index).set_value(value)


class CollectableSystem(LeafSystem):
    """A LeafSystem that is freed, with its diagram, when it is no longer used.

    Drake holds the callbacks of output ports and cache entries, which refer to their
    system, where Python's garbage collector cannot see them. Here the system holds
    them, and Drake calls them through a weak reference. Give a subclass ``__slots__ =
    ()``, so that it uses the ``__dict__`` of its base: Python 3.11 counts references in
    one of its own twice.
    """

    if not TYPE_CHECKING:  # mypy does not see the __dict__ of Drake's classes.
        __slots__ = ()

    def DeclareVectorOutputPort(self, *args: Any, **kwargs: Any) -> OutputPort:
        """Declares the port, as Drake's method."""
        return super().DeclareVectorOutputPort(*map(self._weakly, args), **kwargs)

    def DeclareAbstractOutputPort(self, *args: Any, **kwargs: Any) -> OutputPort:
        """Declares the port, as Drake's method."""
        return super().DeclareAbstractOutputPort(*map(self._weakly, args), **kwargs)

    def declare_value_input(self, name: str) -> InputPort:
        """Declares an input port whose value is any Python object."""
        return self.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))

    def declare_value_output(
        self, name: str, compute: Compute, prerequisites: Tickets | None = None
    ) -> OutputPort:
        """Declares an output port whose value is the Python object of ``compute``."""
        return self.DeclareAbstractOutputPort(
            name,
            lambda: AbstractValue.Make(NOTHING),
            lambda context, output: output.set_value(compute(context)),
            prerequisites_of_calc=prerequisites or {self.all_sources_ticket()},
        )

    def declare_vector_output(
        self,
        name: str,
        size: int,
        compute: Compute,
        prerequisites: Tickets | None = None,
    ) -> OutputPort:
        """Declares a vector output port whose numbers are those of ``compute``."""
        return self.DeclareVectorOutputPort(
            name,
            size,
            lambda context, output: output.SetFromVector(compute(context)),
            prerequisites_of_calc=prerequisites or {self.all_sources_ticket()},
        )

    def declare_value_state(self, start: Any, output: str = "") -> ValueState:
        """Declares a state, and an output port that shows it if it is named."""
        state = ValueState(self, start)
        if output:
            self.DeclareStateOutputPort(output, state.index)
        return state

    def declare_cached(
        self, name: str, compute: Compute, prerequisites: Tickets | None = None
    ) -> CachedValue:
        """Declares a cache entry whose value is the Python object of ``compute``."""
        producer = ValueProducer(
            allocate=lambda: AbstractValue.Make(NOTHING),
            calc=self._weakly(lambda context, out: out.set_value(compute(context))),
        )
        tickets = prerequisites or {self.all_sources_ticket()}
        return CachedValue(self, self.DeclareCacheEntry(name, producer, tickets))

    def declare_scratch_context(self, create: Callable[[], Context]) -> CachedValue:
        """Declares a plant's context for calculations, to be set before each use."""
        producer = ValueProducer(
            allocate=self._weakly(lambda: AbstractValue.Make(create())),
            calc=ValueProducer.NoopCalc,
        )
        entry = self.DeclareCacheEntry("scratch", producer, {self.nothing_ticket()})
        return CachedValue(self, entry)

    def _weakly(self, value: Any) -> Any:
        """Returns what Drake holds in place of a function of this system."""
        if not callable(value):
            return value
        functions = self.__dict__.setdefault("_functions", [])
        functions.append(value)
        owner, index = weakref.ref(self), len(functions) - 1

        def call(*arguments: Any) -> Any:
            system = owner()
            assert system is not None, "Drake calls a system that was freed"
            return system._functions[index](*arguments)

        return call
