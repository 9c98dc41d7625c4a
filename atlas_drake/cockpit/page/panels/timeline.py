"""The modes of the last minute, and the user's share of all joints."""

from __future__ import annotations

from nicegui import ui

from atlas_drake.cockpit.page.history import SPAN, Moment
from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import RunState
from atlas_drake.palette import BEHAVIOR, USER, hex_color

WIDTH, HEIGHT = 300.0, 46.0
"""Of the picture [pixel]."""


class Timeline:
    """A band of modes above the shares of behavior and user."""

    def __init__(self, operating: Operating) -> None:
        """Builds an empty picture."""
        self._on = operating
        card = operating.card
        self._colors = {one.name: one.color for one in card.behaviors}
        self._picture = ui.html("", sanitize=False).classes("timeline")

    def show(self, state: RunState) -> None:
        """Draws the last minute."""
        moments = list(self._on.desk.history.moments)
        self._picture.set_content(draw(moments, self._colors))


def draw(moments: list[Moment], colors: dict[str, str]) -> str:
    """Draws modes and shares over time."""
    if not moments:
        return ""
    end = max(moments[-1].time, SPAN)

    def at(time: float) -> float:
        return WIDTH * (1.0 - (end - time) / SPAN)

    bands, begin = [], 0
    for i in range(1, len(moments) + 1):
        if i == len(moments) or moments[i].behavior != moments[begin].behavior:
            one = moments[begin]
            last = moments[min(i, len(moments) - 1)].time
            left, width = at(one.time), max(at(last) - at(one.time), 1.0)
            text = ""
            if width > 7.0 * len(one.behavior):
                text = f'<text x="{left + 3:.1f}" y="13">{one.behavior}</text>'
            bands.append(
                f'<rect x="{left:.1f}" y="2" width="{width:.1f}" height="15" '
                f'fill="{colors.get(one.behavior, "#888")}"><title>{one.behavior} from '
                f"{one.time:.1f} s</title></rect>{text}"
            )
            begin = i
    line = " ".join(f"{at(m.time):.1f},{HEIGHT - 2 - 22 * m.user:.1f}" for m in moments)
    first, last = at(moments[0].time), at(moments[-1].time)
    area = f"{first:.1f},{HEIGHT - 2} {line} {last:.1f},{HEIGHT - 2}"
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="Modes of the '
        f"last minute, and the user's share\">{''.join(bands)}"
        f'<rect x="{first:.1f}" y="22" width="{last - first:.1f}" height="22" '
        f'fill="{hex_color(BEHAVIOR)}" opacity="0.55"/>'
        f'<polygon points="{area}" fill="{hex_color(USER)}"/></svg>'
    )
