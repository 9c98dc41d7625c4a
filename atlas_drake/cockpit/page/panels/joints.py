"""Who has what: the figure, presets, and the joints of a limb as dials."""

from __future__ import annotations

from functools import partial
from typing import Any

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button
from atlas_drake.cockpit.page.figure import Figure, owner_color
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import JointCard, RunState

ARMS = ("l_arm", "r_arm")


class Joints:
    """A click takes a joint or limb, or gives it back; sliders give a part of it."""

    def __init__(self, operating: Operating) -> None:
        """Builds figure, presets and dials."""
        self._on = operating
        card = operating.card
        self._joints = card.joints
        self._figure = Figure(card.joints)
        limbs = list(dict.fromkeys(joint.limb for joint in card.joints))
        self._limb = "r_arm" if "r_arm" in limbs else limbs[0]
        self._shares: tuple[int, ...] = (0,) * len(card.joints)
        self._poses: tuple[str, ...] = ()
        self._dials: dict[int, _Dial] = {}
        self._picture = ui.html(
            self._figure.svg(self._shares, self._limb), sanitize=False
        ).classes("figure-box")
        self._add_presets()
        with ui.row().classes("share"):
            self._title = ui.label().classes("title")
            self._slider = ui.slider(min=0, max=255, step=1, value=0)
            self._slider.props("dense label")
            self._slider.on("update:model-value", self._share_limb, throttle=0.1)
            self._share_value = ui.label().classes("number")
        self._box = ui.element("div").classes("dials")
        ui.on("joint", self._press_joint)
        ui.on("limb", self._press_limb)
        self._choose(self._limb)

    def _add_presets(self) -> None:
        with ui.row().classes("presets"):
            for text, limbs, share in (
                ("Arms mine", ARMS, 255),
                ("All mine", None, 255),
                ("None mine", None, 0),
            ):
                button(text, partial(self._give, self._of(limbs), share))
            button("Hold", partial(self._on.order, "joints.hold"))
            button("Go limp", partial(self._on.order, "joints.go_limp"))
            with button("Pose"):
                self._menu = ui.menu()

    def show(self, state: RunState) -> None:
        """Colors the figure and moves the dials."""
        if state.k_effort != self._shares:
            self._shares = state.k_effort
            self._draw()
        for index, dial in self._dials.items():
            dial.show(state, index)
        if state.poses != self._poses:
            self._poses = state.poses
            self._fill_menu()

    def _draw(self) -> None:
        self._picture.set_content(self._figure.svg(self._shares, self._limb))
        shares = [self._shares[i] for i in self._of((self._limb,))]
        value = max(shares)
        self._slider.set_value(value)
        self._share_value.set_text(f"{value}" if len(set(shares)) == 1 else "mixed")

    def _choose(self, limb: str) -> None:
        self._limb = limb
        self._title.set_text(limb)
        self._slider.props(f'aria-label="k_effort of {limb}"')
        self._box.clear()
        with self._box:
            self._dials = {
                index: _Dial(self._on, self._joints[index])
                for index in self._of((limb,))
            }
        self._draw()
        if self._on.desk.state is not None:
            for index, dial in self._dials.items():
                dial.show(self._on.desk.state, index)

    def _of(self, limbs: Any) -> list[int]:
        return [
            i
            for i, joint in enumerate(self._joints)
            if limbs is None or joint.limb in limbs
        ]

    async def _give(self, indices: list[int], share: int) -> None:
        names = [self._joints[i].name for i in indices]
        await self._on.order("joints.share", joints=names, k_effort=share)

    async def _press_joint(self, event: Any) -> None:
        name = event.args.get("name")
        index = next((i for i, j in enumerate(self._joints) if j.name == name), None)
        if index is None:
            return
        self._choose(self._joints[index].limb)
        if not event.args.get("keep"):
            await self._give([index], 0 if self._shares[index] else 255)

    async def _press_limb(self, event: Any) -> None:
        limb = event.args.get("name")
        indices = self._of((limb,))
        if not indices:
            return
        was_chosen = limb == self._limb
        self._choose(limb)
        if was_chosen and not event.args.get("keep"):
            mine = all(self._shares[i] for i in indices)
            await self._give(indices, 0 if mine else 255)

    async def _share_limb(self, event: Any) -> None:
        await self._give(self._of((self._limb,)), int(event.args))

    def _fill_menu(self) -> None:
        self._menu.clear()
        with self._menu:
            for name in self._poses:

                async def go(name: str = name) -> None:
                    await self._on.order("joints.go_to_pose", name=name)

                ui.menu_item(f"Go to {name}", on_click=go)
            with ui.row().classes("menu"):
                field = ui.input("Save as").props("dense")

                async def save() -> None:
                    await self._on.order("joints.save_pose", name=field.value)

                button("Save", save)


class _Dial:
    """A joint: set-point on a knob within its limits, measured position, effort."""

    def __init__(self, operating: Operating, joint: JointCard) -> None:
        self._joint = joint
        self._moved: float | None = None

        async def move(event: Any) -> None:
            self._moved = float(event.args)
            await operating.order("joints.move", joint=joint.name, position=self._moved)

        short = joint.name.split("_", 1)[-1] if "_" in joint.name else joint.name
        with ui.element("div").classes("dial"):
            self._knob = ui.knob(
                0.0, min=joint.lower, max=joint.upper, step=0.01, color=None
            )
            self._knob.props(
                f'size=48px thickness=0.24 aria-label="{joint.name} [rad]"'
            )
            self._knob.on("update:model-value", move, throttle=0.08)
            with self._knob:
                self._value = ui.label().classes("number")
            with button(short) as name:
                name.classes("name").props(f'flat aria-label="Gains of {joint.name}"')
                ui.tooltip(
                    f"{joint.name}: {joint.lower:.2f} to {joint.upper:.2f} rad, "
                    f"{joint.effort:.0f} N·m; click for its gains"
                )
                self._gains = _Gains(operating, joint)
            self._bar = ui.element("div").classes("effort")

    def show(self, state: RunState, index: int) -> None:
        """Shows position, set-point and effort."""
        share = state.k_effort[index]
        self._gains.show(state, index)
        self._value.set_text(f"{state.position[index]:.2f}")
        self._knob.style(f"color: {owner_color(share)}")
        self._knob.props(
            add="" if share else "readonly", remove="readonly" if share else ""
        )
        place = state.set_point[index] if share else state.position[index]
        place = min(max(place, self._joint.lower), self._joint.upper)
        if self._moved is not None and abs(place - self._moved) > NEAR:
            place = self._moved  # The set-point is on its way to the knob.
        else:
            self._moved = None
        if abs(self._knob.value - place) > NEAR:
            self._knob.set_value(round(place, 2))
        load = min(abs(state.effort[index]) / max(self._joint.effort, 1e-9), 1.0)
        self._bar.style(f"--load: {load:.2f}")


class _Gains:
    """The gains of a joint's controller, in a menu."""

    def __init__(self, operating: Operating, joint: JointCard) -> None:
        self._fields: dict[str, ui.number] = {}
        self._shown: dict[str, float] = {}
        with ui.menu(), ui.column().classes("menu"):
            ui.label(f"{joint.name}: gains of the user's controller").classes("dim")
            for name, unit in GAINS.items():
                field = ui.number(f"{name} [{unit}]", min=0.0)
                field.props(f'dense aria-label="{name}"')
                self._fields[name] = field

            async def apply() -> None:
                gains = {name: field.value for name, field in self._fields.items()}
                await operating.order("joints.gains", joint=joint.name, **gains)

            button("Apply", apply)

    def show(self, state: RunState, index: int) -> None:
        """Shows gains that have changed; what is typed stays until then."""
        now = {name: state.gains[name][index] for name in GAINS}
        if now != self._shown:
            self._shown = now
            for name, field in self._fields.items():
                field.set_value(now[name])


GAINS = {
    "kp_position": "N·m/rad",
    "ki_position": "N·m/(rad·s)",
    "kd_position": "N·m·s/rad",
    "kp_velocity": "N·m·s/rad",
}
"""The gains, and their units."""
NEAR = 0.011
"""Difference below which a knob is not moved [rad]."""
