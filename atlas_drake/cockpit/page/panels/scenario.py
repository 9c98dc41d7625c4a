"""The scenario: what runs, another one to start, and files to keep."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button
from atlas_drake.cockpit.page.desk import Refused
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import RunState

PRESENT, AS_IT_SAYS = "the present one", "as it says"
LARGEST_FILE = 2_000_000
"""Size of a scenario's file beyond which it is not read [byte]."""


class Scenario:
    """Chooses robot, world, seed or a whole file, and starts it."""

    def __init__(self, operating: Operating) -> None:
        """Builds the choices."""
        self._on = operating
        card = operating.desk.settings
        assert card is not None
        self._examples = card.examples
        self._file, self._text = "", ""
        self._now = ui.label().classes("title")
        self._from = _choice("Scenario", [PRESENT, *card.examples])
        upload = ui.upload(
            label="Open a YAML file",
            auto_upload=True,
            max_file_size=LARGEST_FILE,
            on_upload=self._take_file,
        )
        upload.props('accept=".yaml,.yml" flat aria-label="Open a YAML file"')
        self._robot = _choice("Robot", [AS_IT_SAYS, *card.robots])
        self._world = _choice("World", [AS_IT_SAYS, *card.worlds])
        self._seed = ui.number("Seed", value=None, min=0, step=1, precision=0)
        self._seed.props('dense clearable aria-label="Seed"')
        self._with = ui.label().classes("dim")
        button("Start", self._start).props('aria-label="Start scenario"')
        self._problem = ui.label().classes("problem").props('role="alert"')
        ui.label("What was done by hand since the last reset").classes("title")
        button("Save what I did", self._save)
        self.fill()

    def show(self, state: RunState) -> None:
        """The scenario does not change from state to state."""

    def fill(self) -> None:
        """Says what runs, and what waits."""
        desk = self._on.desk
        card = desk.settings
        if card is None:
            return
        self._now.set_text(
            f"Now: {card.name}, {card.robot}, {card.world}, seed {card.seed}"
        )
        count, why = len(desk.pending), card.why_not
        waiting = f"With the changes of settings that wait: {count}. " if count else ""
        self._with.set_text(waiting + why[:1].upper() + why[1:])
        self._problem.set_text(desk.problem)

    async def _take_file(self, event: Any) -> None:
        try:
            self._text = await event.file.text()
        except UnicodeDecodeError:
            self._problem.set_text(f"{event.file.name}: it is no text")
            return
        name = event.file.name
        self._file = name
        self._from.set_options([PRESENT, name, *self._examples], value=name)

    async def _start(self) -> None:
        """Starts what is chosen; says why if it is refused."""
        source = self._from.value
        changes = {} if source != PRESENT else dict(self._on.desk.pending)
        for path, choice in (("model", self._robot), ("world", self._world)):
            if choice.value != AS_IT_SAYS:
                changes[path] = choice.value
        if self._seed.value is not None:
            changes["seed"] = str(int(self._seed.value))
        values: dict[str, Any] = {"changes": changes}
        if self._file and source == self._file:
            values["text"] = self._text
        elif source != PRESENT:
            values["example"] = source
        self._problem.set_text("")
        try:
            await self._on.desk.order(self._on.viewer, "scenario.start", **values)
        except Refused as refused:
            self._problem.set_text(str(refused))

    async def _save(self) -> None:
        text = await self._on.order("scenario.done")
        if text is not None:
            ui.download.content(text, "by_hand.yaml")


def _choice(name: str, options: list[str]) -> ui.select:
    choice = ui.select(options, value=options[0], label=name)
    return choice.props(f'dense aria-label="{name}"')
