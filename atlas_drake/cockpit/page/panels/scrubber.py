"""A slider over a log's time, below a band of its behaviors."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import BehaviorCard, LogCard, RunState

STEP = 0.01
"""Smallest change of the time [s]."""
NEAR = 0.3
"""Difference between a time that was asked for and the one shown that is small [s]."""


class Scrubber:
    """View, panels and plots follow it."""

    def __init__(self, operating: Operating) -> None:
        """Builds band and slider."""
        self._on = operating
        card = operating.card
        assert card.log is not None
        log = card.log
        self._asked: float | None = None
        with ui.element("div").classes("scrubber"):
            ui.html(band(log, card.behaviors), sanitize=False)
            self._slider = ui.slider(
                min=round(log.begin, 2), max=round(log.end, 2), step=STEP
            )
            self._slider.props('dense aria-label="Time of the log"')
            self._slider.on("update:model-value", self._seek, throttle=0.1)
            ui.label("A log is shown: play it, or drag the slider").classes("dim")

    def show(self, state: RunState) -> None:
        """Moves the slider, unless it waits for the time that it asked for."""
        if self._asked is not None and abs(state.time - self._asked) > NEAR:
            return
        self._asked = None
        self._slider.set_value(round(state.time, 2))

    async def _seek(self, event: Any) -> None:
        self._asked = float(event.args)
        await self._on.order("replay.seek", time=self._asked)
        self._asked = None


def band(log: LogCard, behaviors: tuple[BehaviorCard, ...]) -> str:
    """Draws the behaviors over the whole log."""
    colors = {one.name: one.color for one in behaviors}
    ends = [begin for begin, _ in log.phases[1:]] + [log.end]
    whole = max(log.end - log.begin, 1e-9)
    parts = []
    for (begin, name), end in zip(log.phases, ends, strict=True):
        share = 100.0 * (end - begin) / whole
        parts.append(
            f'<i style="width: {share:.2f}%; background: {colors.get(name, "#888")}" '
            f'title="{name} from {begin:.1f} s">{name}</i>'
        )
    return f'<div class="band" aria-hidden="true">{"".join(parts)}</div>'
