"""Plots of any column of a log's row, by name."""

from __future__ import annotations

import html
from functools import partial
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button
from atlas_drake.cockpit.page.chart import charts, color_of
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import RunState

WINDOWS = {2.0: "2 s", 5.0: "5 s", 10.0: "10 s", 30.0: "30 s", 60.0: "60 s"}
"""Times that the plots can reach back [s]."""
USUAL_WINDOW = 10.0
"""The one at first [s]."""
MOST = 12
"""Number of columns that a viewer can plot."""


class Plots:
    """A choice of columns, and their curves; each viewer has its own."""

    def __init__(self, operating: Operating) -> None:
        """Builds the choice; what the viewer plotted before is chosen."""
        self._on = operating
        card = operating.card
        self._units = card.columns
        self._names = [n for n in operating.viewer.plotted if n in card.columns]
        self._values: dict[str, ui.label] = {}
        options = "".join(
            f'<option value="{html.escape(name)}">' for name in sorted(card.columns)
        )
        # The browser's own list of suggestions searches as one types.
        ui.html(f'<datalist id="columns">{options}</datalist>', sanitize=False)
        with ui.element("div").classes("plots-bar"):
            self._search = ui.input(placeholder="Plot a channel", on_change=self._add)
            self._search.props(
                'dense list=columns autocomplete=off aria-label="Channel to plot"'
            )
            self._window = ui.select(WINDOWS, value=USUAL_WINDOW, label="Time plotted")
            self._window.props("dense borderless").classes("named")
        self._legend = ui.element("div").classes("plots-legend")
        self._picture = ui.html("", sanitize=False).classes("plots")
        self._fill_legend()
        if self._names:
            ui.timer(0.0, self._tell, once=True)

    def show(self, state: RunState) -> None:
        """Draws the latest samples."""
        if not self._names:
            return
        samples = list(self._on.desk.history.samples)
        latest = samples[-1][1] if samples else {}
        for name, label in self._values.items():
            if name in latest:
                label.set_text(f"{latest[name]:.4g} {self._units[name]}")
        begin = state.time - self._window.value
        self._picture.set_content(
            charts(samples, self._names, self._units, begin, state.time)
        )

    def _fill_legend(self) -> None:
        self._legend.clear()
        self._values = {}
        with self._legend:
            for place, name in enumerate(self._names):
                with ui.row().classes("curve"):
                    ui.element("i").style(f"background: {color_of(place)}")
                    ui.label(name)
                    self._values[name] = ui.label().classes("number")
                    drop = button(icon="close", press=partial(self._remove, name))
                    drop.props(f'flat size=xs aria-label="Remove {name}"')
        if not self._names:
            self._picture.set_content("")

    async def _add(self, event: Any) -> None:
        """Plots a column once its name is complete."""
        name = event.value
        if name not in self._units or name in self._names or len(self._names) >= MOST:
            return
        self._search.set_value("")
        self._names.append(name)
        await self._tell()

    async def _remove(self, name: str) -> None:
        self._names.remove(name)
        await self._tell()

    async def _tell(self) -> None:
        self._fill_legend()
        await self._on.plot(tuple(self._names))
