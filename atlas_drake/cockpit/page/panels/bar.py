"""The bar at the top: what runs, its time, and who steers."""

from __future__ import annotations

from functools import partial
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button, light
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import RunState

PACES = {0.1: "0.1 ×", 0.25: "0.25 ×", 0.5: "0.5 ×", 1.0: "1 ×", 2.0: "2 ×", 0.0: "max"}
"""Multiples of real time; 0 is as fast as can be."""


class Bar:
    """Mode, time, and the controls of time."""

    def __init__(self, operating: Operating, dark: Any) -> None:
        """Builds the bar."""
        self._on, self._dark = operating, dark
        ask = operating.order
        card = operating.card
        ui.label(card.robot).classes("robot").props(f'title="Scenario {card.title}"')
        self._mode = ui.label().classes("mode").props('role="status" aria-label="Mode"')
        self._time = ui.label().classes("number").props('aria-label="Time"')
        self._speed = (
            ui.label()
            .classes("number dim")
            .props(
                'aria-label="Speed" title="Simulated seconds per second, and the '
                'computing time of a control tick"'
            )
        )
        ui.space()
        with ui.row().classes("tools"):
            self._pause = _button(
                "Pause", "pause", partial(ask, "clock.toggle"), "space"
            )
            _button(
                "Single step",
                "skip_next",
                partial(ask, "clock.single_step"),
                "n",
            )
            self._pace = ui.select(
                PACES, value=1.0, label="Pace", on_change=self._set_pace
            )
            self._pace.props("dense borderless").classes("pace named")
            _button("Back 10 s", "replay_10", partial(ask, "clock.back"), "b")
            _button("Reset", "restart_alt", partial(ask, "clock.reset"), "r")
            if card.log is None:
                self._add_new_run()
        self._steer = button("Steer", self._ask)
        self._steer.classes("steer").props('aria-label="Steering"')
        _button("Dark or light", "contrast", self._turn_light, "")
        self._shown_pace = 1.0

    def _add_new_run(self) -> None:
        new_run = _button("New run", "casino", None, "")
        with new_run, ui.menu(), ui.row().classes("menu presets"):
            self._seed = ui.number("Seed", value=0, min=0, step=1)
            self._seed.props('dense aria-label="Seed"')
            button("Begin", self._begin)

    def show(self, state: RunState) -> None:
        """Shows mode, time and speed."""
        going = "" if state.behavior == state.desired else f" → {state.desired}"
        self._mode.set_text("FALLEN" if state.fallen else state.behavior + going)
        light(self._mode, state.fallen, "alarm")
        self._time.set_text(f"{state.time:.1f} s")
        paused = "paused" if state.paused else f"{state.rate:.2f} ×"
        self._speed.set_text(f"{paused} · {state.tick_ms:.1f} ms")
        self._pause.props(f"icon={'play_arrow' if state.paused else 'pause'}")
        if state.pace != self._shown_pace and state.pace in PACES:
            self._shown_pace = state.pace
            self._pace.set_value(state.pace)
        self._steer.set_text(self._steering())

    def _steering(self) -> str:
        desk, viewer = self._on.desk, self._on.viewer
        if desk.steers is viewer:
            return "Hand over" if desk.asks else "You steer"
        return "Ask to steer" if desk.steers else "Steer"

    def _ask(self) -> None:
        desk, viewer = self._on.desk, self._on.viewer
        if desk.steers is viewer:
            desk.hand_over(viewer)
        else:
            desk.ask_to_steer(viewer)

    def _turn_light(self) -> None:
        self._dark.set_value(not self._dark.value)

    async def _begin(self) -> None:
        await self._on.order("clock.reset", seed=int(self._seed.value or 0))

    async def _set_pace(self, event: Any) -> None:
        if event.value != self._shown_pace:
            self._shown_pace = event.value
            await self._on.order("clock.pace", rate=event.value)


def _button(name: str, icon: str, press: Any, key: str) -> ui.button:
    tool = button(icon=icon, press=press).props(f'round aria-label="{name}"')
    with tool:
        ui.tooltip(f"{name} ({key})" if key else name)
    return tool
