"""What the page looks like is remembered by the browser: folds, tab, dark or light."""

from __future__ import annotations

import json
from typing import Any

from nicegui import ui


class Memory:
    """Values of elements that the browser keeps from one visit to the next."""

    def __init__(self) -> None:
        """Waits for what the browser has kept."""
        self._elements: dict[str, Any] = {}
        ui.on("remembered", self._take)

    def keep(self, name: str, element: Any) -> None:
        """Keeps the value of an element under a name."""
        self._elements[name] = element

        def changed(event: Any) -> None:
            value = json.dumps(event.value)
            ui.run_javascript(f"cockpit.remember({json.dumps(name)}, {value})")

        element.on_value_change(changed)

    def recall(self) -> None:
        """Asks the browser for what it has kept."""
        ui.run_javascript("cockpit.recall()")

    def _take(self, event: Any) -> None:
        kept = event.args if isinstance(event.args, dict) else {}
        for name, value in kept.items():
            element = self._elements.get(name)
            if element is not None and isinstance(value, bool | str):
                element.set_value(value)
