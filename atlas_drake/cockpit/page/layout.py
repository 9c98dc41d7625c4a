"""Builds the page of one viewer, and keeps it up to date."""

from __future__ import annotations

import time
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.desk import Desk, Viewer
from atlas_drake.cockpit.page.keys import KEYS, Key
from atlas_drake.cockpit.page.memory import Memory
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.page.panels.bar import Bar
from atlas_drake.cockpit.page.panels.events import Events
from atlas_drake.cockpit.page.panels.joints import Joints
from atlas_drake.cockpit.page.panels.modes import Modes
from atlas_drake.cockpit.page.panels.panel import Panel
from atlas_drake.cockpit.page.panels.pelvis import Pelvis
from atlas_drake.cockpit.page.panels.plan import Plan
from atlas_drake.cockpit.page.panels.plots import Plots
from atlas_drake.cockpit.page.panels.scenario import Scenario
from atlas_drake.cockpit.page.panels.scrubber import Scrubber
from atlas_drake.cockpit.page.panels.settings import Settings
from atlas_drake.cockpit.page.panels.strain import Strain
from atlas_drake.cockpit.page.panels.timeline import Timeline
from atlas_drake.cockpit.page.panels.view import View
from atlas_drake.cockpit.page.panels.walking import Walking
from atlas_drake.cockpit.state import RunState

ALARMS = ("refusal", "warning", "fall", "recovery")
"""Kinds of events that are also shown over the page."""
RECENT = 1.0
"""Age beyond which they are not [s]."""
ACCENT = "#1559b7"
"""Color of what is chosen, dark enough for white text."""
SEEN_PATIENCE = 2.0
"""Time after which a browser that has not shown a state gets another [s]."""


def build_page(desk: Desk, viewer: Viewer) -> None:
    """Builds the page of a viewer into the present client."""
    client = ui.context.client
    # A transition does not end while states come in.
    ui.menu.default_props("transition-duration=0")
    ui.add_head_html('<link rel="stylesheet" href="/assets/cockpit.css">')
    ui.add_head_html('<script src="/meshcat.js"></script>')
    ui.add_head_html('<script src="/assets/cockpit.js"></script>')
    ui.colors(primary=ACCENT)
    dark, memory = ui.dark_mode(None), Memory()
    memory.keep("dark", dark)
    operating = Operating(desk, viewer)
    content = ui.element("div").classes("cockpit")
    panels: list[Panel] = []
    seen = _Seen()

    def build() -> None:
        """Builds all panels anew for a run."""
        content.clear()
        panels.clear()
        if desk.card is None:
            with content:
                ui.label("Waiting for the simulation ...")
            return
        content.classes(add="replay" if desk.card.log else "")
        with content:
            panels.extend(_build_panels(operating, dark, memory))
            memory.recall()
        if desk.state is not None:
            show(desk.state)

    def show(state: RunState) -> None:
        if not seen.is_due():
            return
        with client:
            for panel in panels:
                panel.show(state)
            for time_, kind, text in state.events:
                if kind in ALARMS and time_ > state.time - RECENT:
                    tell(text)
            seen.sent()
            ui.run_javascript("emitEvent('seen')")

    def tell(text: str) -> None:
        with client:
            ui.notify(text, position="top", timeout=4000, classes="notice")

    def show_card() -> None:
        """Builds the first run's page, and loads it anew for another one."""
        if not panels:
            build()
            return
        with client:
            ui.navigate.reload()

    def show_settings() -> None:
        with client:
            for panel in panels:
                if isinstance(panel, Scenario | Settings):
                    panel.fill()

    viewer.tell, viewer.show, viewer.show_card = tell, show, show_card
    viewer.show_settings = show_settings
    ui.on("seen", seen.came)
    build()
    _add_keys(operating)
    client.on_delete(lambda: desk.remove_viewer(viewer))
    client.on_disconnect(lambda: desk.remove_viewer(viewer))
    client.on_connect(lambda: desk.seat(viewer))


def _build_panels(operating: Operating, dark: Any, memory: Memory) -> list[Panel]:
    panels: list[Panel] = []
    replayed = operating.card.log is not None
    with ui.element("header").classes("bar"):
        panels.append(Bar(operating, dark))
    with ui.element("section").classes("left").props('aria-label="Controls"'):
        with ui.tabs().props("dense no-caps align=justify") as tabs:
            kinds: dict[str, type[Any]] = {
                "Joints": Joints,
                "Walk": Walking,
                "Pelvis": Pelvis,
                "Scenario": Scenario,
                "Settings": Settings,
            }
            if replayed:
                kinds = {"Joints": Joints}  # The others command alone.
            for name in kinds:
                ui.tab(name)
        if not replayed:
            memory.keep("tab", tabs)
        with ui.tab_panels(tabs, value="Joints").props("animated=false keep-alive"):
            for name, kind in kinds.items():
                with ui.tab_panel(name):
                    panels.append(kind(operating))
    with ui.element("main").classes("middle"):
        panels.append(View(operating))
        panels.append(Scrubber(operating) if replayed else Modes(operating))
    with ui.element("section").classes("right").props('aria-label="What it thinks"'):
        thoughts: tuple[tuple[type[Any], str], ...] = (
            (Plan, "From above"),
            (Timeline, "Modes"),
            (Strain, "Hottest joints"),
            (Plots, "Plots"),
            (Events, "Events"),
        )
        for kind, title in thoughts:
            with ui.expansion(title, value=True).props("dense") as fold:
                fold.classes("fold")
                memory.keep(title, fold)
                panels.append(kind(operating))
    return panels


class _Seen:
    """Lets no state go to a browser that has not shown the last one."""

    def __init__(self) -> None:
        self._waiting_since: float | None = None

    def is_due(self) -> bool:
        since = self._waiting_since
        return since is None or time.monotonic() - since > SEEN_PATIENCE

    def sent(self) -> None:
        self._waiting_since = time.monotonic()

    def came(self) -> None:
        self._waiting_since = None


def _add_keys(operating: Operating) -> None:
    """Lets the keyboard alone suffice."""

    async def press(event: Any) -> None:
        if not event.action.keydown or event.action.repeat:
            return
        if event.modifiers.ctrl or event.modifiers.alt or event.modifiers.meta:
            return
        key: Key | None = KEYS.get(event.key.name) or KEYS.get(event.key.code)
        if key is not None:
            await operating.order(key.control, **key.values)

    ui.keyboard(on_key=press, ignore=["input", "select", "textarea", "button"])
