"""The joints that are nearest to their limits of effort."""

from __future__ import annotations

from nicegui import ui

from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import JointCard, RunState
from atlas_drake.palette import BUSY, IDLE, SPENT, hex_color

SHOWN = 5
"""Number of joints that are listed."""


class Strain:
    """Bars of effort and of position within its limits."""

    def __init__(self, operating: Operating) -> None:
        """Builds an empty list."""
        card = operating.card
        self._joints = card.joints
        self._picture = ui.html("", sanitize=False).classes("strain")

    def show(self, state: RunState) -> None:
        """Lists the hottest joints."""
        rows = hottest(self._joints, state)
        self._picture.set_content("".join(_row(*row) for row in rows))


def hottest(
    joints: tuple[JointCard, ...], state: RunState
) -> list[tuple[str, float, float]]:
    """Returns name, effort [N·m] and share of its limit, the largest share first."""
    shares = [
        (joint.name, effort, abs(effort) / max(joint.effort, 1e-9))
        for joint, effort in zip(joints, state.effort, strict=True)
    ]
    return sorted(shares, key=lambda one: -one[2])[:SHOWN]


def _row(name: str, effort: float, share: float) -> str:
    color = hex_color(IDLE if share < 0.5 else BUSY if share < 0.9 else SPENT)
    return (
        f'<div class="hot"><span>{name}</span>'
        f'<b><i style="width: {100 * min(share, 1):.0f}%; background: {color}"></i></b>'
        f'<span class="number">{effort:.0f} N·m</span></div>'
    )
