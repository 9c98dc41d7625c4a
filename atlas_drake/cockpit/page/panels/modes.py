"""A button for each behavior, and STOP."""

from __future__ import annotations

from functools import partial
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page import keys
from atlas_drake.cockpit.page.buttons import button, light
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import BehaviorCard, RunState

KEY_OF = {name: key for key, name in keys.MODES.items()}


class Modes:
    """The active behavior is lit; one that would be refused says why."""

    def __init__(self, operating: Operating) -> None:
        """Builds the buttons."""
        self._on = operating
        card = operating.card
        self._buttons: dict[str, ui.button] = {}
        self._whys: dict[str, Any] = {}
        with ui.element("nav").classes("modes").props('aria-label="Modes"'):
            for behavior in card.behaviors:
                self._add(behavior)
            stop = button("STOP", partial(operating.order, "modes.stop"))
            stop.classes("stop").props('aria-label="STOP"')
            with stop:
                ui.label("Esc").classes("key")

    def _add(self, behavior: BehaviorCard) -> None:
        name = behavior.name
        one = button(name.replace("_", " "), partial(self._ask, behavior))
        one.props(f'aria-label="{name}"').classes("behavior")
        one.style(f"--own: {behavior.color}")
        with one:
            key = KEY_OF.get(name)
            if key is not None:
                ui.label(key).classes("key")
            # Above, so that it does not cover STOP.
            self._whys[name] = ui.tooltip(behavior.description).props(
                'anchor="top middle" self="bottom middle"'
            )
        self._buttons[name] = one

    def show(self, state: RunState) -> None:
        """Lights the active behavior, and greys those that would be refused."""
        for name, one in self._buttons.items():
            light(one, name == state.behavior)
            why = state.refusals.get(name, "")
            one.props(add="disable" if why else "", remove="" if why else "disable")
            told = why or self._described(name)
            self._whys[name].set_text(told)

    def _described(self, name: str) -> str:
        card = self._on.card
        return next(one.description for one in card.behaviors if one.name == name)

    async def _ask(self, behavior: BehaviorCard) -> None:
        if behavior.params:
            _Form(self._on, behavior).open()
        else:
            await self._on.order("modes.request", name=behavior.name)


class _Form:
    """The parameters of a behavior of the user's own."""

    def __init__(self, operating: Operating, behavior: BehaviorCard) -> None:
        self._values = {one.name: one.default for one in behavior.params}
        with ui.dialog() as self._dialog, ui.card().classes("form"):
            ui.label(behavior.name).classes("title")
            ui.label(behavior.description).classes("dim")
            for one in behavior.params:
                label = one.name.replace("_", " ")
                if one.kind == "bool":
                    field: Any = ui.switch(label, value=one.default)
                elif one.kind in ("int", "float"):
                    field = ui.number(label, value=one.default)
                else:
                    field = ui.input(label, value=one.default)
                field.bind_value_to(self._values, one.name)
                field.props(f'dense aria-label="{label}"')

            async def send() -> None:
                self._dialog.close()
                kinds = {one.name: one.kind for one in behavior.params}
                params = {
                    name: int(value) if kinds[name] == "int" else value
                    for name, value in self._values.items()
                }
                await operating.order(
                    "modes.request", name=behavior.name, params=params
                )

            button(f"Start {behavior.name}", send)

    def open(self) -> None:
        """Shows the form."""
        self._dialog.open()
