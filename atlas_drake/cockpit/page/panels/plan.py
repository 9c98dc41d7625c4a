"""The plan from above: feet, support polygon, CoM, DCM, CoP, footsteps."""

from __future__ import annotations

import math

from nicegui import ui

from atlas_drake.cockpit.page.operating import Operating
from atlas_drake.cockpit.state import Point, RunState
from atlas_drake.palette import COM, COP, DCM, FEET, SUPPORT, hex_color

AHEAD, ASIDE = 0.75, 0.5
"""What is seen ahead of the robot and behind it, and to each side [m]."""


class Plan:
    """Drawn with the robot's heading to the right."""

    def __init__(self, operating: Operating) -> None:
        """Builds an empty picture."""
        card = operating.card
        self._sole = card.sole
        self._picture = ui.html("", sanitize=False).classes("plan")
        ui.html(_legend(), sanitize=False).classes("dim legend")
        self._loads = ui.label().classes("number")

    def show(self, state: RunState) -> None:
        """Draws a state."""
        self._picture.set_content(draw(state, self._sole))
        left, right = state.loads
        self._loads.set_text(f"feet {left:.0f} N left, {right:.0f} N right")


def draw(state: RunState, sole: Point) -> str:
    """Draws a state from above."""
    x, y, _, yaw = state.robot
    middle = _middle(state) or (x, y)
    cos, sin = math.cos(yaw), math.sin(yaw)

    def at(point: Point) -> Point:
        """Place in the picture: right is ahead, down is to the right [m]."""
        dx, dy = point[0] - middle[0], point[1] - middle[1]
        return cos * dx + sin * dy, sin * dx - cos * dy

    def foot(place: tuple[float, float, float], number: int, style: str) -> str:
        px, py = at((place[0], place[1]))
        turn = math.degrees(yaw - place[2])
        length, width = sole
        return (
            f'<rect x="{-0.5 * length:.3f}" y="{-0.5 * width:.3f}" '
            f'width="{length:.3f}" height="{width:.3f}" rx="0.03" '
            f'transform="translate({px:.3f} {py:.3f}) rotate({turn:.1f})" '
            f'style="--foot: {hex_color(FEET[number])}" class="{style}"/>'
        )

    parts = [
        f'<svg viewBox="{-AHEAD} {-ASIDE} {2 * AHEAD} {2 * ASIDE}" role="img" '
        'aria-label="Feet, CoM, DCM and CoP from above">'
    ]
    parts += [
        foot((sx, sy, a), n, "step") for n, sx, sy, a in (*state.steps, *state.plan)
    ]
    if state.support:
        corners = " ".join("{:.3f},{:.3f}".format(*at(p)) for p in state.support)
        parts.append(
            f'<polygon points="{corners}" class="support" '
            f'style="--support: {hex_color(SUPPORT)}"/>'
        )
    parts += [foot(place, n, "foot") for n, place in enumerate(state.feet)]
    for point, color, radius in (
        (state.com, COM, 0.022),
        (state.dcm, DCM, 0.024),
        (state.cop, COP, 0.016),
    ):
        if point is not None:
            px, py = at(point)
            parts.append(
                f'<circle cx="{px:.3f}" cy="{py:.3f}" r="{radius}" '
                f'fill="{hex_color(color)}"/>'
            )
    return "".join(parts) + "</svg>"


def _middle(state: RunState) -> Point | None:
    if len(state.feet) != 2:
        return None
    (lx, ly, _), (rx, ry, _) = state.feet
    return 0.5 * (lx + rx), 0.5 * (ly + ry)


def _legend() -> str:
    return " ".join(
        f'<span><i style="background: {hex_color(color)}"></i>{name}</span>'
        for name, color in (
            ("CoM", COM),
            ("DCM", DCM),
            ("CoP", COP),
            ("support", SUPPORT),
        )
    )
