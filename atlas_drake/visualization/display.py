"""Base of the displays that draw into Meshcat beside Drake's visualiser.

This module decides when to draw; each display is in a file beside this one.
"""

from __future__ import annotations

from pydrake.systems.framework import Context

from atlas_drake.systems.collectable_system import CollectableSystem
from atlas_drake.visualization.viewer_gate import ViewerGate


class Display(CollectableSystem):
    """Draws at a fixed rate, unless a gate is closed.

    Attributes:
        gate: Allows a picture if viewers can take it; None allows all pictures.
    """

    __slots__ = ()

    def __init__(self, period: float) -> None:
        """Draws every ``period`` [s]."""
        super().__init__()
        self.gate: ViewerGate | None = None
        self.DeclarePeriodicPublishEvent(period, 0.0, self._publish_if_seen)
        self.DeclareForcedPublishEvent(self._publish_if_seen)

    def _publish_if_seen(self, context: Context) -> None:
        if self.gate is None or self.gate.is_open:
            self._publish(context)

    def _publish(self, context: Context) -> None:
        """Draws the present state completely, independent of earlier pictures."""
        raise NotImplementedError
