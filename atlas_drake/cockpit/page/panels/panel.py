"""What the panels of the page have in common."""

from __future__ import annotations

from typing import Protocol

from atlas_drake.cockpit.state import RunState


class Panel(Protocol):
    """A part of the page."""

    def show(self, state: RunState) -> None:
        """Shows a state."""
