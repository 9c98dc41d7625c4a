"""Short names for the surfaces that the robot's outside uses most.

Lengths are in metres, in the frame of the link that carries the part.
"""

from __future__ import annotations

from robot_models.parts import Vector
from robot_models.surfaces import Loft, Pair, Section, Tube

_DRUM_ROUND = 2.0
_BLOCK_SQUARE = 6.0


def drum(
    axis: str, center: Vector, radius: float, length: float, rim: float = 0.006
) -> Loft:
    """Returns an upright cylinder along a link axis, with rounded rims.

    Args:
        axis: Link axis that it lies along: `"x"`, `"y"` or `"z"`.
        center: Its center.
        radius: Its radius.
        length: Its length.
        rim: Radius of its rims.
    """
    across, along = _split(axis, center)
    ends = (along - length / 2, along + length / 2)
    sections = tuple(
        Section(end, across, (radius, radius), _DRUM_ROUND) for end in ends
    )
    return Loft(axis, sections, (rim, rim), segments=22, rings=1)


def block(axis: str, center: Vector, size: Vector, rim: float = 0.008) -> Loft:
    """Returns a box with rounded edges.

    Args:
        axis: Link axis at whose ends the rims are.
        center: Its center.
        size: Its size along the link axes.
        rim: Radius of its rims.
    """
    across, along = _split(axis, center)
    (u, v), length = _split(axis, size)
    ends = (along - length / 2, along + length / 2)
    sections = tuple(
        Section(end, across, (u / 2, v / 2), _BLOCK_SQUARE) for end in ends
    )
    return Loft(axis, sections, (rim, rim), segments=28, rings=1)


def rod(start: Vector, end: Vector, radius: float) -> Tube:
    """Returns a straight round rod between two points."""
    return Tube((start, end), radius, rim=0.3 * radius, steps=1)


def hull(
    axis: str,
    sections: tuple[tuple[float, Pair, Pair], ...],
    power: float = 2.5,
    rims: Pair = (0.01, 0.01),
) -> Loft:
    """Returns a hull whose sections all have the same power.

    Args:
        axis: Link axis that it runs along.
        sections: Position, center and half sizes of every section; see `Section`.
        power: Roundness of the sections; see `Section`.
        rims: Radius of the rims at both ends.
    """
    return Loft(
        axis,
        tuple(Section(at, center, half, power) for at, center, half in sections),
        rims,
    )


def _split(axis: str, vector: Vector) -> tuple[Pair, float]:
    """Splits a vector into its parts across an axis and along it."""
    values = dict(zip("xyz", vector, strict=True))
    along = values.pop(axis)
    u, v = values.values()
    return (u, v), along
