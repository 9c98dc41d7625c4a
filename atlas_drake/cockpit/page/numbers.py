"""Sliders for named numbers with limits and units."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.state import Range

TITLES = {"com_v0": "CoM to the left", "com_v1": "CoM ahead"}
"""What a number is called, if not by its name."""


class Numbers:
    """A slider for each number, which shows the value in force."""

    def __init__(
        self,
        ranges: Mapping[str, Range],
        change: Callable[[str, float], Awaitable[Any]],
    ) -> None:
        """Builds the sliders."""
        self._sliders: dict[str, ui.slider] = {}
        self._values: dict[str, ui.label] = {}
        self._units = {name: one.unit for name, one in ranges.items()}
        with ui.element("div").classes("numbers"):
            for name, one in ranges.items():
                title = TITLES.get(name, name.replace("_", " "))
                ui.label(title)
                slider = ui.slider(
                    min=round(one.low, 3),
                    max=round(one.high, 3),
                    step=one.step,
                    value=one.usual,
                )
                slider.props(f'dense aria-label="{title}"')

                async def moved(event: Any, name: str = name) -> None:
                    await change(name, float(event.args))

                slider.on("update:model-value", moved, throttle=0.1)
                self._sliders[name] = slider
                self._values[name] = ui.label().classes("number")

    def show(self, values: Mapping[str, float]) -> None:
        """Shows the values in force beside the sliders, and moves those."""
        for name, slider in self._sliders.items():
            text = f"{round(values[name], 3) + 0.0:g} {self._units[name]}"
            if self._values[name].text != text:
                self._values[name].set_text(text)
                slider.set_value(values[name])
