"""The robot's figure from the front, with a button for each limb and joint, as SVG."""

from __future__ import annotations

import html
from collections.abc import Sequence

from atlas_drake.cockpit.state import JointCard, Point
from atlas_drake.palette import BEHAVIOR, SHARED, USER, hex_color

LEAST = 0.15
"""Least distance between two joints in the figure [m]."""
PULL = 0.15
"""Share of the way back to its place that a joint goes at each turn."""
TURNS = 80
"""Turns in which joints are moved apart."""
RADIUS, TARGET = 0.045, 0.065
"""Of a joint in the figure, and of the place around it that a click hits [m]."""


def spread(places: Sequence[Point]) -> list[Point]:
    """Moves places apart that are closer than ``LEAST``, to click each of them."""
    now = [[x + 1e-4 * i, y - 2e-4 * i] for i, (x, y) in enumerate(places)]
    for _ in range(TURNS):
        for i, one in enumerate(now):
            for axis in (0, 1):
                one[axis] += PULL * (places[i][axis] - one[axis])
        for i, one in enumerate(now):
            for other in now[i + 1 :]:
                dx, dy = other[0] - one[0], other[1] - one[1]
                distance = max((dx * dx + dy * dy) ** 0.5, 1e-6)
                if distance < LEAST:
                    push = 0.5 * (LEAST / distance - 1.0)
                    one[0] -= push * dx
                    one[1] -= push * dy
                    other[0] += push * dx
                    other[1] += push * dy
    return [(x, y) for x, y in now]


def owner_color(k_effort: int) -> str:
    """Returns the color of a share: blue, violet and amber, and mixtures of them."""
    share = min(max(k_effort / 255.0, 0.0), 1.0)
    first, second = (BEHAVIOR, SHARED) if share < 0.5 else (SHARED, USER)
    way = 2.0 * share if share < 0.5 else 2.0 * share - 1.0
    mixed = [a + way * (b - a) for a, b in zip(first, second, strict=True)]
    return hex_color((mixed[0], mixed[1], mixed[2]))


class Figure:
    """The figure of one robot."""

    def __init__(self, joints: Sequence[JointCard]) -> None:
        """Lays the joints out."""
        self._joints = joints
        self._places = spread([joint.place for joint in joints])
        self._parents: list[Point] = []
        known: dict[Point, Point] = {}  # Of two joints at one place, the second.
        for joint, place in zip(joints, self._places, strict=True):
            self._parents.append(known.get(joint.parent, joint.parent))
            known[joint.place] = place
        every = [*self._places, *self._parents]
        margin = 0.09
        self._left = min(-x for x, _ in every) - margin
        self._top = min(-y for _, y in every) - margin
        self._width = max(-x for x, _ in every) + margin - self._left
        self._height = max(-y for _, y in every) + margin - self._top

    def svg(self, k_effort: Sequence[int], chosen: str) -> str:
        """Draws the figure."""
        box = f"{self._left:.3f} {self._top:.3f} {self._width:.3f} {self._height:.3f}"
        parts = [
            f'<svg class="figure" viewBox="{box}" role="group" '
            'aria-label="Who has which joint">'
        ]
        for limb in dict.fromkeys(joint.limb for joint in self._joints):
            parts.append(self._limb(limb, limb == chosen))
        parts += [self._joint(i, k) for i, k in enumerate(k_effort)]
        return "".join(parts) + "</svg>"

    def _limb(self, limb: str, chosen: bool) -> str:
        """Draws the bones of a limb, which are one button."""
        lines = "".join(
            f'<line x1="{-a[0]:.3f}" y1="{-a[1]:.3f}" '
            f'x2="{-b[0]:.3f}" y2="{-b[1]:.3f}"/>'
            for joint, a, b in zip(
                self._joints, self._parents, self._places, strict=True
            )
            if joint.limb == limb
        )
        return (
            f'<g class="limb{" chosen" if chosen else ""}" role="button" tabindex="0" '
            f'aria-label="{html.escape(limb)}" '
            f"{_on_press('limb', limb)}>{lines}</g>"
        )

    def _joint(self, index: int, k_effort: int) -> str:
        joint, (x, y) = self._joints[index], self._places[index]
        name = html.escape(joint.name)
        owner = {0: "behavior", 255: "yours"}.get(k_effort, f"k_effort {k_effort}")
        return (
            f'<g class="joint" role="button" tabindex="0" aria-label="{name}: {owner}" '
            f"{_on_press('joint', joint.name)}><title>{name}: {owner}</title>"
            f'<circle class="target" cx="{-x:.3f}" cy="{-y:.3f}" r="{TARGET}"/>'
            f'<circle cx="{-x:.3f}" cy="{-y:.3f}" r="{RADIUS}" '
            f'fill="{owner_color(k_effort)}"/></g>'
        )


def _on_press(kind: str, name: str) -> str:
    """Makes the handlers of a click and of Enter, which tell the page."""
    name = html.escape(name)
    tell = f"cockpit.tell('{kind}', {{name: '{name}', keep: event.shiftKey}})"
    return (
        f'onclick="{tell}" onkeydown="if (event.key === \'Enter\') '
        f'{{ {tell}; event.stopPropagation() }}"'
    )
