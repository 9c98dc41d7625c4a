"""The settings of the run: search, change, save, restart with the changes."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.settings import SHOWN, Setting, matching, text_of
from atlas_drake.cockpit.state import RunState


class Settings:
    """Rows for the settings that are searched for; changes wait for a restart."""

    def __init__(self, operating: Operating) -> None:
        """Builds search, groups and an empty list."""
        self._on = operating
        self._search = ui.input(placeholder="Search settings", on_change=self.fill)
        self._search.props('dense clearable debounce=300 aria-label="Search settings"')
        self._changed = ui.switch("Changed only", on_change=self.fill)
        self._changed.props('dense size=sm aria-label="Changed only"')
        self._waiting = ui.element("div").classes("waiting")
        self._found = ui.label().classes("dim").props('role="status"')
        self._rows = ui.element("div").classes("settings")
        button("Save settings", self._save).props('aria-label="Save settings"')
        self.fill()

    def show(self, state: RunState) -> None:
        """Settings do not change from state to state."""

    def fill(self) -> None:
        """Lists what is searched for, and what waits."""
        desk = self._on.desk
        if desk.settings is None:
            return
        words, every = self._search.value or "", desk.settings.settings
        found = matching(every, words, desk.pending, self._changed.value)
        asked = bool(words.strip() or self._changed.value)
        self._rows.clear()
        with self._rows:
            if asked:
                for one in found[:SHOWN]:
                    _Row(self, one, desk.pending.get(one.path))
            else:
                self._add_groups(every)
        more = f", {SHOWN} are shown" if asked and len(found) > SHOWN else ""
        self._found.set_text(f"{len(found)} of {len(every)} settings{more}")
        self._waiting.clear()
        if desk.pending:
            with self._waiting:
                self._add_waiting()

    def _add_groups(self, settings: tuple[Setting, ...]) -> None:
        for group in dict.fromkeys(one.group for one in settings):

            def look(group: str = group) -> None:
                self._search.set_value(group)

            button(group, look)

    def _add_waiting(self) -> None:
        """Says what waits, and offers to begin with it."""
        desk = self._on.desk
        count = len(desk.pending)
        text = "1 change needs" if count == 1 else f"{count} changes need"
        ui.label(f"{text} a restart").classes("title").props('role="status"')
        for path, value in desk.pending.items():
            ui.label(f"{path}: {value}").classes("path")
        with ui.row().classes("presets"):
            button("Restart with changes", self._restart)
            button("Forget changes", lambda: desk.set_pending({}))

    async def change(self, setting: Setting, text: str) -> None:
        """Lets a value wait for a restart, if it can be used."""
        desk = self._on.desk
        pending = {path: v for path, v in desk.pending.items() if path != setting.path}
        if text != text_of(setting.value):
            pending[setting.path] = text
        if pending == desk.pending:
            return
        if await self._on.order("scenario.check", changes=pending):
            desk.set_pending(pending)
        else:
            self.fill()  # What was in force is shown again.

    async def _restart(self) -> None:
        await self._on.order("scenario.start", changes=self._on.desk.pending)

    async def _save(self) -> None:
        pending = self._on.desk.pending
        text = await self._on.order("scenario.written", changes=pending)
        if text is not None:
            ui.download.content(text, "scenario.yaml")


class _Row:
    """One setting: path, value, unit, bounds and usual value."""

    def __init__(self, panel: Settings, setting: Setting, pending: str | None) -> None:
        self._panel, self._setting = panel, setting
        self._text = text_of(setting.value) if pending is None else pending
        usual = text_of(setting.usual)
        changed = " changed" if self._text != usual else ""
        with ui.element("div").classes(f"setting{changed}"):
            ui.label(setting.path).classes("path")
            self._add_field()
            ui.label(setting.unit).classes("dim")
            told = [f"usually {usual}", setting.bounds, f"needs {setting.needs}"]
            ui.label(" · ".join(filter(None, told))).classes("dim told")
            ui.label(setting.text).classes("told")

    def _add_field(self) -> None:
        setting = self._setting
        field: Any = None
        if setting.kind == "choice":
            field = ui.select(
                list(setting.choices), value=self._text, label=setting.path
            ).classes("named")
        elif setting.kind == "flag":
            field = ui.select(
                ["true", "false"], value=self._text, label=setting.path
            ).classes("named")
        if field is not None:
            field.on_value_change(lambda event: self._change(event.value))
        else:
            text = ui.input(value=self._text)
            text.on("keydown.enter", lambda: self._change(text.value))
            text.on("blur", lambda: self._change(text.value))
            field = text
        field.props(f'dense aria-label="{setting.path}"')

    async def _change(self, text: Any) -> None:
        if isinstance(text, str) and text != self._text:
            await self._panel.change(self._setting, text)
