"""Links coloured by who has the joint that moves them, or by how hard it works.

The pelvis, which no joint moves, keeps its looks.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat, MeshcatVisualizer
from pydrake.systems.framework import Context, LeafSystem

from atlas_drake.messages import K_EFFORT_MAX
from atlas_drake.robot import Robot
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.palette import (
    BEHAVIOR_RGB,
    BUSY_RGB,
    IDLE_RGB,
    SPENT_RGB,
    USER_RGB,
)

SHADES = 20
"""Steps of a colour scale: what looks the same is not sent again."""
GAMMA = 2.2
"""Meshcat takes the colours of materials as intensities of light."""
REPEAT = 1.0
"""After this time all colours are sent again, for browsers that came later [s]."""

Color = tuple[float, float, float]


def owner_colors(k_effort: np.ndarray) -> list[Color]:
    """From the behaviour's colour to the user's, shared joints in between.

    Args:
        k_effort: User's share per joint, 0 to 255, shape (n,).
    """
    return [
        _between((BEHAVIOR_RGB, USER_RGB), share / K_EFFORT_MAX) for share in k_effort
    ]


def effort_colors(effort: np.ndarray, limit: np.ndarray) -> list[Color]:
    """Over three colours, by the share of the limit [N·m], shapes (n,)."""
    shares = np.minimum(np.abs(effort) / limit, 1.0)
    return [_between((IDLE_RGB, BUSY_RGB, SPENT_RGB), share) for share in shares]


def _between(colors: Sequence[Color], share: float) -> Color:
    """A colour on a scale, in as many shades as there are."""
    place = round(SHADES * float(share)) / SHADES * (len(colors) - 1)
    first = min(int(place), len(colors) - 2)
    into = place - first
    r, g, b = (
        round((1.0 - into) * x + into * y, 3)
        for x, y in zip(colors[first], colors[first + 1], strict=True)
    )
    return r, g, b


class ControlColors(LeafSystem):
    """Colours the links while one of the two colourings is switched on.

    Input ports:
        commands: ``CommandsInForce``
        effort: Of the motors [N·m], shape (n,).
    """

    def __init__(
        self,
        meshcat: Meshcat,
        visualizer: MeshcatVisualizer,
        robot: Robot,
        links: str,
        overlays: Overlays,
        period: float,
    ) -> None:
        """Looks every ``period`` [s].

        Args:
            meshcat: Where the links are.
            visualizer: That draws them, and draws them anew in their own colours.
            robot: Whose links.
            links: Path in Meshcat under which its links are.
            overlays: What is switched on.
            period: Between looks [s].
        """
        super().__init__()
        self._meshcat = meshcat
        self._visualizer = visualizer
        self._limit = robot.effort_limit
        self._paths = [f"{links}/{link}" for link in robot.moved_links]
        self._overlays = overlays
        self._commands = self.DeclareAbstractInputPort(
            "commands", AbstractValue.Make(None)
        )
        self._effort = self.DeclareVectorInputPort("effort", robot.num_joints)
        self._sent: dict[str, Color] = {}
        self._sent_all = -np.inf
        self.DeclarePeriodicPublishEvent(period, 0.0, self._publish)

    def _publish(self, context: Context) -> None:
        if self._overlays.is_on("owner"):
            commands: Any = self._commands.Eval(context)
            colors = owner_colors(commands.k_effort)
        elif self._overlays.is_on("effort"):
            colors = effort_colors(self._effort.Eval(context), self._limit)
        else:
            if self._sent:
                # Their own colours are known to the one that drew them.
                self._visualizer.Delete()
                self._sent.clear()
            return
        time = context.get_time()
        if not self._sent_all <= time < self._sent_all + REPEAT:
            self._sent.clear()
            self._sent_all = time
        for path, color in zip(self._paths, colors, strict=True):
            if self._sent.get(path) != color:
                self._sent[path] = color
                light = [value**GAMMA for value in color]
                self._meshcat.SetProperty(path, "color", [*light, 1.0], time)
