"""A push by numbers, for those who do not drag one in the view."""

from __future__ import annotations

import math

from nicegui import ui

from atlas_drake.cockpit.page.buttons import button
from atlas_drake.cockpit.page.operating import Operating

DIRECTIONS = {0: "ahead", 90: "to the left", 180: "back", -90: "to the right"}
"""Directions from the robot's heading [degree]."""
USUAL, LARGEST = 20.0, 200.0
"""Impulse at first, and the largest [N·s]."""


class Pushing:
    """Link, direction and impulse."""

    def __init__(self, operating: Operating) -> None:
        """Builds the form."""
        self._on = operating
        card = operating.card
        links = list(card.pushed)
        with ui.menu().props("persistent=false"), ui.column().classes("menu"):
            self._body = ui.select(links, value=links[0], label="Link")
            self._body.props('dense aria-label="Link"')
            self._direction = ui.select(DIRECTIONS, value=0, label="Direction")
            self._direction.props('dense aria-label="Direction"')
            self._impulse = ui.number(
                "Impulse [N·s]", value=USUAL, min=0.0, max=LARGEST, step=5.0
            ).props('dense aria-label="Impulse"')
            button("Push now", self.push)

    async def push(self) -> None:
        """Pushes."""
        state = self._on.desk.state
        if state is None or self._impulse.value is None:
            return
        angle = state.robot[3] + math.radians(self._direction.value)
        size = self._impulse.value
        impulse = [size * math.cos(angle), size * math.sin(angle), 0.0]
        done = await self._on.order(
            "pushes.push", body=self._body.value, impulse_W=impulse
        )
        if done is not None:
            self._on.viewer.tell(f"Pushed {self._body.value}: {done:.2f} m/s")
