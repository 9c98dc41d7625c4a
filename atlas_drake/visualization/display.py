"""Base of the displays that draw into Meshcat beside Drake's visualiser.

This module decides when to draw; each display is in a file beside this one.
"""

from __future__ import annotations

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import (
    Context,
    DiagramBuilder,
    InputPort,
    LeafSystem,
    System,
)

from atlas_drake.frozen import NOTHING
from atlas_drake.systems.collectable_system import CollectableSystem


class Display(CollectableSystem):
    """Draws at a fixed rate, and whenever its diagram publishes."""

    __slots__ = ()

    def __init__(self, period: float) -> None:
        """Draws every ``period`` [s]."""
        super().__init__()
        self.DeclarePeriodicPublishEvent(period, 0.0, self._publish)
        self.DeclareForcedPublishEvent(self._publish)

    def _publish(self, context: Context) -> None:
        """Draws the present state completely, independent of earlier pictures."""
        raise NotImplementedError


def declare_values(display: LeafSystem, *names: str) -> list[InputPort]:
    """Declares input ports with values of any type."""
    return [
        display.DeclareAbstractInputPort(name, AbstractValue.Make(NOTHING))
        for name in names
    ]


def add_display(
    builder: DiagramBuilder, station: System, name: str, display: LeafSystem
) -> None:
    """Adds a display to a diagram, and connects it to the station's ports."""
    builder.AddNamedSystem(name, display)
    for index in range(display.num_input_ports()):
        port = display.get_input_port(index)
        # A replay has no contact results.
        if station.HasOutputPort(port.get_name()):
            builder.Connect(station.GetOutputPort(port.get_name()), port)
