"""Units of the numbers in configurations, as types; and standard gravity.

A field's annotation says its unit, ``stride: Positive[Meters]`` for example: scaling,
errors, forms and documentation read the unit there. Bounds are in ``config``. A unit
that is used in one file alone is declared in that file.
"""

from __future__ import annotations

import typing
from typing import Annotated, Any

from annotated_types import Unit

GRAVITY = 9.81
"""Magnitude of the gravitational acceleration [m/s²]. No setting: Drake's plants have
the same."""

Ratio = Annotated[float, Unit("-")]
"""A number without unit, such as a factor or a share."""
Meters = Annotated[float, Unit("m")]
MetersPerSecond = Annotated[float, Unit("m/s")]
MetersPerSecondSquared = Annotated[float, Unit("m/s²")]
MetersPerRadian = Annotated[float, Unit("m/rad")]
Radians = Annotated[float, Unit("rad")]
RadiansPerSecond = Annotated[float, Unit("rad/s")]
RadiansPerMeter = Annotated[float, Unit("rad/m")]
Seconds = Annotated[float, Unit("s")]
PerSecond = Annotated[float, Unit("1/s")]
PerSecondSquared = Annotated[float, Unit("1/s²")]
Kilograms = Annotated[float, Unit("kg")]
Newtons = Annotated[float, Unit("N")]
NewtonSeconds = Annotated[float, Unit("N·s")]
NewtonMeters = Annotated[float, Unit("N·m")]
NewtonMetersPerRadian = Annotated[float, Unit("N·m/rad")]
NewtonMeterSecondsPerRadian = Annotated[float, Unit("N·m·s/rad")]
PerAngularAccelerationSquared = Annotated[float, Unit("1/(rad/s²)²")]
"""Weight of a task of orientation or posture in the QP."""


def unit_of(kind: Any) -> str | None:
    """Returns the unit of an annotation, or of the numbers in it.

    Args:
        kind: A type, such as ``Positive[Meters]`` or ``list[Meters] | None``.

    Returns:
        The unit, such as ``m``; ``-`` for numbers without unit; None if none is said.
    """
    for note in getattr(kind, "__metadata__", ()):
        if isinstance(note, Unit):
            return note.unit
    units = map(unit_of, typing.get_args(kind))
    return next((unit for unit in units if unit is not None), None)
