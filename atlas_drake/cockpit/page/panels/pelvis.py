"""The pelvis in MANIPULATE, and what was clamped."""

from __future__ import annotations

from functools import partial
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button
from atlas_drake.cockpit.page.numbers import Numbers
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import RunState

NEAR = 0.003
"""Difference from what was asked below which a value is not clamped [m], [rad]."""


class Pelvis:
    """Height, orientation, and center of mass over the feet."""

    def __init__(self, operating: Operating) -> None:
        """Builds the sliders."""
        self._on = operating
        self._asked: dict[str, float] = {}
        with ui.row().classes("presets"):
            manipulate = partial(operating.order, "modes.request", name="MANIPULATE")
            button("MANIPULATE", manipulate)
            button("Level", self._level)
        self._numbers = Numbers(operating.card.pelvis, self._move)
        self._clamped = ui.label().classes("dim")

    def show(self, state: RunState) -> None:
        """Shows the pose, and which coordinates were clamped."""
        if state.behavior != "MANIPULATE":
            self._asked = {}
            self._clamped.set_text("The pelvis moves in MANIPULATE")
            return
        self._numbers.show(state.pelvis)
        clamped = [
            f"{name.replace('_', ' ')} {value:.2f} → {state.pelvis[name]:.2f}"
            for name, value in self._asked.items()
            if abs(value - state.pelvis[name]) > NEAR
        ]
        text = f"Clamped: {', '.join(clamped)}" if clamped else "As asked"
        self._clamped.set_text(text)

    async def _level(self) -> None:
        names = ("pelvis_yaw", "pelvis_pitch", "pelvis_roll", "com_v0", "com_v1")
        self._asked = dict.fromkeys(names, 0.0)
        await self._on.order("pelvis.move", **self._asked)

    async def _move(self, name: str, value: float) -> Any:
        self._asked[name] = value
        await self._on.order("pelvis.move", **{name: value})
