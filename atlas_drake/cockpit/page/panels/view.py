"""The 3D view: Meshcat, the camera, and what the pointer does in it."""

from __future__ import annotations

from functools import partial
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button, light
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.page.panels.pushing import Pushing
from atlas_drake.cockpit.state import RunState

CAMERAS = ("Follow", "Front", "Side", "Above", "Free")
"""Where the camera can be."""


RECORDING = "atlas_drake.html"
"""Name of a recording's file."""


class View:
    """Clicks on the ground walk, drags from a link push, a click on one asks whose."""

    def __init__(self, operating: Operating) -> None:
        """Builds the view, which ``cockpit.js`` draws into."""
        self._on = operating
        card = operating.card
        self._joint_of = {
            link: number for number, one in enumerate(card.joints) for link in one.links
        }
        with ui.element("div").classes("view"):
            ui.html('<div id="view"></div>', sanitize=False).classes("fill")
            ui.html(
                '<div id="age" class="age" title="Age of the picture"></div>',
                sanitize=False,
            )
            ui.html('<div id="hint" class="hint" role="status"></div>', sanitize=False)
            with ui.row().classes("over"):
                self._camera = ui.toggle(list(CAMERAS), value="Follow")
                self._camera.props('dense no-caps unelevated aria-label="Camera"')
                self._camera.on_value_change(self._look)
                with button("Show", icon="layers"):
                    self._overlays = _Overlays(operating)
                if card.log is None:
                    with button("Push", icon="back_hand"):
                        Pushing(operating)
                button("Picture", _save, icon="photo_camera")
                self._record = button("Record", self._toggle, icon="videocam")
                with self._record:
                    ui.tooltip("Record the 3D view from now on, as a web page")
            self._link = ui.card().classes("link")
            self._link.set_visibility(False)
        ui.on("link", self._ask_whose)
        ui.on("push", self._push)
        ui.on("ground", self._plan)
        ui.on("plan_step", self._move_step)
        ui.on("plan_send", partial(operating.order, "walk.send_plan"))
        ui.on("plan_drop", partial(operating.order, "walk.drop_plan"))
        ui.on("stick", self._stick)
        links = sorted({*self._joint_of, *card.pushed})
        commands = "true" if card.log is None else "false"
        ui.run_javascript(f"cockpit.start({links!r}, {card.mass:g}, {commands})")

    def show(self, state: RunState) -> None:
        """Switches the overlays' switches."""
        self._overlays.show(state)
        self._record.set_text("Stop and save" if state.recording else "Record")
        light(self._record, state.recording)

    async def _toggle(self) -> None:
        """Begins a recording, or ends it and downloads it."""
        state = self._on.desk.state
        if state is None or not state.recording:
            await self._on.order("recording.start")
            return
        page = await self._on.order("recording.stop")
        if page is not None:
            ui.download.content(page, RECORDING)

    def _look(self, event: Any) -> None:
        ui.run_javascript(f"cockpit.look({event.value!r})")

    async def _ask_whose(self, event: Any) -> None:
        """Shows whose a link is, and offers to take its joint or give it back."""
        name, state = event.args.get("name"), self._on.desk.state
        number = self._joint_of.get(name)
        self._link.clear()
        self._link.set_visibility(number is not None)
        if number is None or state is None:
            return
        joint, share = self._on.card.joints[number], state.k_effort[number]

        async def give(to: int) -> None:
            self._link.set_visibility(False)
            await self._on.order("joints.share", joints=[joint.name], k_effort=to)

        with self._link:
            ui.label(f"{name}: {joint.name}")
            owner = {0: "the behavior has it", 255: "you have it"}
            ui.label(owner.get(share, f"shared, k_effort {share}")).classes("dim")
            with ui.row():
                mine, back = ("Take it", 255), ("Give it back", 0)
                for text, to in (mine, back):
                    button(text, lambda to=to: give(to)).set_enabled(share != to)
                close = button(
                    icon="close", press=lambda: self._link.set_visibility(False)
                )
                close.props('aria-label="Close"')

    async def _push(self, event: Any) -> None:
        done = await self._on.order(
            "pushes.push",
            body=event.args.get("name"),
            impulse_W=event.args.get("impulse"),
        )
        if done is not None:
            self._on.viewer.tell(f"Pushed {event.args['name']}: {done:.2f} m/s")

    async def _plan(self, event: Any) -> None:
        place = {name: event.args.get(name) for name in ("x", "y")}
        if event.args.get("yaw") is not None:
            place["yaw"] = event.args["yaw"]
        await self._on.order("walk.plan_to", **place)

    async def _move_step(self, event: Any) -> None:
        values = {name: event.args.get(name) for name in ("index", "x", "y")}
        await self._on.order("walk.move_step", **values)

    async def _stick(self, event: Any) -> None:
        shares = {name: event.args.get(name) for name in ("forward", "left", "turn")}
        if any(shares.values()):
            await self._on.order("walk.steer", **shares)
        else:
            await self._on.order("walk.stop")


class _Overlays:
    """A menu with a switch for each overlay."""

    def __init__(self, operating: Operating) -> None:
        card = operating.card
        self._switches: dict[str, ui.switch] = {}
        self._shown: frozenset[str] = frozenset()
        with ui.menu().props("auto-close=false"), ui.column().classes("menu"):
            for name, told in card.overlays.items():
                if name == "follow":
                    continue  # The page's own camera does.

                async def switch(event: Any, name: str = name) -> None:
                    if event.value != (name in self._shown):
                        await operating.order("view.show", overlay=name, on=event.value)

                one = ui.switch(f"{name}: {told}", on_change=switch)
                one.props(f'dense size=sm aria-label="{name}"')
                self._switches[name] = one

    def show(self, state: RunState) -> None:
        """Shows what is switched on."""
        if state.overlays == self._shown:
            return
        self._shown = state.overlays
        for name, switch in self._switches.items():
            switch.set_value(name in state.overlays)


def _save() -> None:
    ui.run_javascript("cockpit.save()")
