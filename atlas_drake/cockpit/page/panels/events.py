"""The events of the run, the newest first, with a search."""

from __future__ import annotations

import html

from nicegui import ui

from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import RunState

SHOWN = 60
"""Number of events that are listed."""


class Events:
    """A list with a search."""

    def __init__(self, operating: Operating) -> None:
        """Builds the search and an empty list."""
        self._on = operating
        self._search = ui.input(placeholder="Search", on_change=self._fill)
        self._search.props('dense clearable aria-label="Search events"')
        self._list = ui.html("", sanitize=False).classes("events")
        self._list.props('role="log" aria-label="Events"')
        self._seen = -1, -1

    def show(self, state: RunState) -> None:
        """Adds new events."""
        if (state.run, state.event_count) != self._seen:
            self._seen = state.run, state.event_count
            self._fill()

    def _fill(self) -> None:
        word = (self._search.value or "").lower()
        found = [
            one
            for one in reversed(self._on.desk.history.events)
            if word in f"{one[1]} {one[2]}".lower()
        ]
        rows = [
            f'<p class="{html.escape(kind)}"><b>{time:.2f}</b> {html.escape(text)}</p>'
            for time, kind, text in found[:SHOWN]
        ]
        self._list.set_content("".join(rows) or '<p class="dim">nothing yet</p>')
