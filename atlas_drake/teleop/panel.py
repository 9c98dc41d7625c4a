"""The control panel in the browser.

The panel reports pressed buttons and slider positions without blocking; ``commander``
converts them to orders.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from pydrake.geometry import Meshcat

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.robot import Robot
from atlas_drake.teleop.controls import (
    SLIDERS,
    Controls,
    Slider,
    behavior_buttons,
    fitted,
)
from atlas_drake.teleop.paged_controls import PagedControls
from atlas_drake.teleop.pages import SWITCHES, joint_slider, pages_with
from atlas_drake.teleop.walking import Direction
from atlas_drake.visualization.caption import show_paused
from atlas_drake.visualization.overlays import Overlays

DEAD_ZONE = 0.25
"""Dead zone of a stick's deflection."""
STICK_STEP = 0.25
"""Resolution to which deflections are rounded, so that small tremor sends no
command."""


class PanelLike(Protocol):
    """The interface of a panel that a session needs."""

    def read(self) -> Controls:
        """Returns the buttons pressed since the last call, and the slider positions."""

    def set(self, slider: Slider, value: float) -> None:
        """Moves a slider."""

    def show_joints(self, positions: Mapping[int, float]) -> None:
        """Shows sliders for these joints only; new sliders start at given positions."""

    def show_paused(self, paused: bool) -> None:
        """Shows if time stands still."""


class Panel:
    """The panel in Meshcat."""

    def __init__(
        self,
        meshcat: Meshcat,
        robot: Robot,
        overlays: Overlays,
        behaviors: BehaviorCatalog = SHIPPED,
        say: Callable[[str], object] = print,
        config: ControllerConfig | None = None,
    ) -> None:
        """Adds the first page.

        Args:
            meshcat: Meshcat instance that shows the panel.
            robot: Robot whose joints get sliders.
            overlays: Overlays that the panel switches on and off.
            behaviors: Catalog whose user-defined behaviors get buttons.
            say: Called with a message about a value beyond its slider's range.
            config: Gives the ranges of sliders; None for the robot's values.
        """
        self._meshcat = meshcat
        self._robot = robot
        self._overlays = overlays
        self._joints: dict[int, Slider] = {}
        self._buttons = behavior_buttons(behaviors)
        self._own = fitted(robot, config or ControllerConfig.of(robot.file))
        self._controls = PagedControls(
            meshcat, pages_with(robot, self._own, (), self._buttons), self._buttons, say
        )
        self._show_overlays()

    def read(self) -> Controls:
        """Returns the buttons pressed since the last call, and the slider positions."""
        controls = self._controls
        pressed = controls.read()
        self._switch_overlays()
        return Controls(
            clicks=pressed,
            sliders={s.label: controls.value(self._own[s.label]) for s in SLIDERS},
            joints={i: controls.value(slider) for i, slider in self._joints.items()},
            stick=self._stick(),
        )

    def set(self, slider: Slider, value: float) -> None:
        """Moves a slider."""
        self._controls.set(self._own.get(slider.label, slider), value)

    def show_joints(self, positions: Mapping[int, float]) -> None:
        """Shows sliders for these joints only; new sliders start at given positions."""
        robot = self._robot
        new = [index for index in positions if index not in self._joints]
        self._joints = {index: joint_slider(robot, index) for index in positions}
        for index in new:
            self._controls.set(self._joints[index], positions[index])
        self._controls.set_pages(pages_with(robot, self._own, positions, self._buttons))

    def show_paused(self, paused: bool) -> None:
        """Shows in the 3D view if time stands still."""
        show_paused(self._meshcat, paused)

    def _switch_overlays(self) -> None:
        """Reads the switches, and updates those that another switch turned off."""
        overlays = self._overlays
        wanted = {
            name: self._controls.value(switch) > 0.5
            for name, switch in SWITCHES.items()
        }
        changed = [name for name, on in wanted.items() if on != overlays.is_on(name)]
        for name in changed:
            overlays.switch(name, wanted[name])
        if changed:
            self._show_overlays()

    def _show_overlays(self) -> None:
        """Sets the switches to the visible overlays."""
        for name, switch in SWITCHES.items():
            self._controls.set(switch, float(self._overlays.is_on(name)))

    def _stick(self) -> Direction | None:
        pad = self._meshcat.GetGamepad()
        return None if pad.index is None else stick_direction(pad.axes)


def stick_direction(axes: Sequence[float]) -> Direction:
    """Returns the direction of a gamepad's sticks: the left one walks, the right turns.

    Args:
        axes: Left x, left y, right x, ...; x to the right and y down, -1 to 1. Numbers
            that are not finite count as 0.
    """

    def share(index: int) -> float:
        value = axes[index] if index < len(axes) else 0.0
        if not math.isfinite(value) or abs(value) < DEAD_ZONE:
            return 0.0
        return -STICK_STEP * round(min(max(value, -1.0), 1.0) / STICK_STEP)

    return Direction(forward=share(1), left=share(0), turn=share(2))
