"""The control panel in the browser: buttons and sliders of Meshcat.

It says what was pressed and where the sliders are; it decides nothing and waits for
nobody.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from pydrake.geometry import Meshcat

from atlas_drake.robot import Robot
from atlas_drake.teleop.controls import SLIDERS, Action, Controls, Slider
from atlas_drake.teleop.limbs import SLIDER_STEP
from atlas_drake.teleop.walking import Direction
from atlas_drake.visualization.overlays import Overlays

DEAD_ZONE = 0.25
"""Deflection of a stick that still means none."""
STICK_STEP = 0.25
"""Deflections are rounded to it, so that a trembling hand is no news."""


class PanelLike(Protocol):
    """What a session needs of a panel."""

    def read(self) -> Controls:
        """What was pressed since the last call, and where the sliders are."""

    def set(self, slider: Slider, value: float) -> None:
        """Moves a slider."""

    def show_joints(self, positions: Mapping[int, float]) -> None:
        """Offers sliders for these joints and no others, new ones at a position."""


class Panel:
    """The panel in Meshcat."""

    def __init__(self, meshcat: Meshcat, robot: Robot, overlays: Overlays) -> None:
        """Adds all widgets.

        Args:
            meshcat: Where to.
            robot: Whose joints get sliders.
            overlays: Which the panel switches on and off.
        """
        self._meshcat = meshcat
        self._robot = robot
        self._overlays = overlays
        self._clicks = dict.fromkeys(Action, 0)
        self._joints: dict[int, str] = {}
        for action in Action:
            meshcat.AddButton(action.label, action.key.code)
        for slider in SLIDERS:
            meshcat.AddSlider(*slider)
        self._shown = {name: f"show {name}" for name in overlays.names}
        for name, label in self._shown.items():
            meshcat.AddSlider(label, 0, 1, 1, int(overlays.is_on(name)))

    def read(self) -> Controls:
        """What was pressed since the last call, and where the sliders are."""
        meshcat = self._meshcat
        pressed = []
        for action, before in self._clicks.items():
            clicks = meshcat.GetButtonClicks(action.label)
            if clicks != before:
                self._clicks[action] = clicks
                pressed.append(action)
        self._switch_overlays()
        return Controls(
            clicks=tuple(pressed),
            sliders={s.label: meshcat.GetSliderValue(s.label) for s in SLIDERS},
            joints={
                index: meshcat.GetSliderValue(label)
                for index, label in self._joints.items()
            },
            stick=self._stick(),
        )

    def set(self, slider: Slider, value: float) -> None:
        """Moves a slider."""
        self._meshcat.SetSliderValue(slider.label, value)

    def show_joints(self, positions: Mapping[int, float]) -> None:
        """Offers sliders for these joints and no others, new ones at a position."""
        robot = self._robot
        for index in [i for i in self._joints if i not in positions]:
            self._meshcat.DeleteSlider(self._joints.pop(index))
        for index, position in positions.items():
            if index not in self._joints:
                label = f"{robot.joint_names[index]} [rad]"
                low, high = robot.position_lower[index], robot.position_upper[index]
                self._meshcat.AddSlider(label, low, high, SLIDER_STEP, position)
                self._joints[index] = label

    def _switch_overlays(self) -> None:
        """Takes over the switches, and shows where one turned another off."""
        meshcat, overlays = self._meshcat, self._overlays
        wanted = {
            name: meshcat.GetSliderValue(label) > 0.5
            for name, label in self._shown.items()
        }
        changed = [name for name, on in wanted.items() if on != overlays.is_on(name)]
        for name in changed:
            overlays.switch(name, wanted[name])
        if changed:
            for name, label in self._shown.items():
                meshcat.SetSliderValue(label, int(overlays.is_on(name)))

    def _stick(self) -> Direction | None:
        pad = self._meshcat.GetGamepad()
        return None if pad.index is None else stick_direction(pad.axes)


def stick_direction(axes: Sequence[float]) -> Direction:
    """Where a gamepad's sticks point: the left one walks, the right one turns.

    Args:
        axes: Left x, left y, right x, ...; x to the right and y down, -1 to 1.
    """

    def share(index: int) -> float:
        value = axes[index] if index < len(axes) else 0.0
        if abs(value) < DEAD_ZONE:
            return 0.0
        return -STICK_STEP * round(min(max(value, -1.0), 1.0) / STICK_STEP)

    return Direction(forward=share(1), left=share(0), turn=share(2))
