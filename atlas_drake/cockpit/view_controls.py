"""Overlays of the 3D view."""

from __future__ import annotations

from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages.checks import check_flag
from atlas_drake.visualization.overlays import Overlays


class ViewControls:
    """Switches of the overlays, which are the same for all viewers."""

    def __init__(self, overlays: Overlays) -> None:
        """Switches ``overlays``."""
        self._overlays = overlays

    @property
    def shown(self) -> frozenset[str]:
        """Overlays that are switched on."""
        return self._overlays.on

    def show(self, overlay: str, on: bool) -> None:
        """Switches an overlay.

        Args:
            overlay: Name of the overlay.
            on: True to show it.
        """
        check_flag(on, "on")
        if not isinstance(overlay, str):
            raise InvalidMessageError("overlay", overlay, "must be a name")
        self._overlays.switch(overlay, bool(on))
