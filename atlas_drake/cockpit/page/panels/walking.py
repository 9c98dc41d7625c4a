"""Walking: the keys as buttons, and the gait."""

from __future__ import annotations

from functools import partial
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button, light
from atlas_drake.cockpit.page.keys import DIRECTIONS
from atlas_drake.cockpit.page.numbers import Numbers
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import RunState

ARROWS = {
    "u": "north_west",
    "i": "north",
    "o": "north_east",
    "j": "west",
    "k": "stop",
    "l": "east",
    "m": "rotate_left",
    ",": "south",
    ".": "rotate_right",
}


class Walking:
    """Directions and gait."""

    def __init__(self, operating: Operating) -> None:
        """Builds the pad of directions and the sliders of the gait."""
        self._on = operating
        card = operating.card
        self._pads: dict[tuple[float, ...], ui.button] = {}
        with ui.element("div").classes("pad"):
            for key, does in DIRECTIONS.items():
                press = partial(operating.order, does.control, **does.values)
                pad = button(icon=ARROWS[key], press=press)
                pad.props(f'aria-label="{does.text}"')
                with pad:
                    ui.label(key).classes("key")
                    ui.tooltip(f"{does.text} ({key})")
                names = ("forward", "left", "turn")
                if does.control == "walk.steer":
                    way = tuple(does.values.get(name, 0.0) for name in names)
                    self._pads[way] = pad
        ui.label("Gait of the next steps").classes("title")
        self._gait = Numbers(card.gait, self._set)
        ui.label("Walk to a place").classes("title")
        with ui.element("div").classes("goal"):
            self._goal = {
                name: ui.number(label, value=value, step=step).props(
                    f'dense aria-label="{label}"'
                )
                for name, label, value, step in (
                    ("x", "x [m]", 1.0, 0.25),
                    ("y", "y [m]", 0.0, 0.25),
                    ("yaw", "heading [rad]", 0.0, 0.1),
                )
            }
        with ui.row().classes("presets"):
            button("Plan", self._plan)
            button("Send plan", partial(operating.order, "walk.send_plan"))
            button("Drop plan", partial(operating.order, "walk.drop_plan"))
        ui.label(
            "In the view: click the ground to plan a way, click again to walk it. A "
            "gamepad's sticks steer while they are held."
        ).classes("dim")

    def show(self, state: RunState) -> None:
        """Lights the direction, and shows the gait in force."""
        for way, pad in self._pads.items():
            light(pad, way == state.direction)
        self._gait.show(state.gait)

    async def _plan(self) -> None:
        goal = {name: field.value for name, field in self._goal.items()}
        await self._on.order("walk.plan_to", **goal)

    async def _set(self, name: str, value: float) -> Any:
        return await self._on.order("walk.set_gait", **{name: value})
