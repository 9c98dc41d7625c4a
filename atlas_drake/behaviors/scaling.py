"""Scales the controller's defaults from Atlas to a robot of another size, by units.

Two walking robots whose speeds have the same Froude number v²/(g·h) move alike
(Alexander, "The gaits of bipedal and quadrupedal animals", 1984): with lengths in
proportion to the height h of the center of mass, times to √h and forces to the mass m,
all accelerations are equal. So each parameter scales as its unit says:

    m: h    s: √h    kg: m    N = kg·m/s²: m    rad, -: 1

and a weight of the QP, per squared unit of a task, keeps what the task costs. What the
soles bound scales with the soles, and what bounds a hasty swing with the hips. A robot
of Atlas' proportions needs no value of its own. Values of a robot's file replace scaled
ones.
"""

from __future__ import annotations

import functools
import re
from dataclasses import is_dataclass, replace
from typing import Any, NamedTuple, TypeVar

from atlas_drake.config import LeastGreatest, fields_of
from atlas_drake.robot import ATLAS, Size
from atlas_drake.units import unit_of

_T = TypeVar("_T")


ALONG_SOLE = ("length_margin", "toes", "cop_forward", "tolerated_forward")
"""Parameters that scale with the length of the soles."""
ACROSS_SOLE = (
    "width_margin",
    "yaw_moment_arm",
    "cop_sideways",
    "tolerated_sideways",
    "cop_inward",
)
"""Parameters that scale with the width of the soles."""
CLEARANCE = 0.02
"""Least distance between the soles in a step, in heights of the center of mass [-]."""
NARROWEST, WIDEST = 0.75, 1.6
"""Distances between the feet that a walk needs, in widths of the stance [-]."""


class Dimension(NamedTuple):
    """Powers of a unit."""

    length: int = 0
    time: int = 0
    mass: int = 0


_UNITS = {
    "m": Dimension(length=1),
    "s": Dimension(time=1),
    "kg": Dimension(mass=1),
    "N": Dimension(1, -2, 1),
    "W": Dimension(2, -3, 1),
    "rad": Dimension(),
    "-": Dimension(),
    "1": Dimension(),
}


def scaled(defaults: _T, size: Size) -> _T:
    """Returns a configuration with Atlas' values scaled to a robot of another size.

    Args:
        defaults: The configuration; each field's unit is in its annotation.
        size: Of the robot.
    """
    h, hips = size.height / ATLAS.height, size.hip_time / ATLAS.hip_time
    own = {
        # The hips bound how fast a leg swings.
        "shortest_swing": hips,
        "foot_speed": h / hips,
        **dict.fromkeys(ALONG_SOLE, size.sole_length / ATLAS.sole_length),
        **dict.fromkeys(ACROSS_SOLE, size.sole_width / ATLAS.sole_width),
    }

    def factor(unit: str) -> float:
        length, time, mass = dimension(unit)
        return h ** (length + 0.5 * time) * (size.mass / ATLAS.mass) ** mass

    def scale(value: Any, outer: str) -> Any:
        """Scales the fields of a dataclass whose own field has the unit ``outer``."""
        changed: dict[str, Any] = {}
        for name, kind in fields_of(value.__class__).items():
            unit, part = unit_of(kind), getattr(value, name)
            if is_dataclass(part):
                changed[name] = scale(part, unit or outer)
            elif unit:
                by = own.get(name) or factor(unit.replace("unit", outer or "-"))
                changed[name] = _times(part, by)
        return replace(value, **changed)

    made: _T = scale(defaults, "")
    return made


def feet_fitting(limits: LeastGreatest, size: Size) -> LeastGreatest:
    """Returns limits of the distance between the feet that suit the stance [m]."""
    apart = min(size.sole_width + CLEARANCE * size.height, size.stance_width)
    return LeastGreatest(
        max(min(limits.least, NARROWEST * size.stance_width), apart),
        max(limits.greatest, WIDEST * size.stance_width),
    )


def _times(value: Any, factor: float) -> Any:
    if factor == 1.0:
        return value
    if isinstance(value, LeastGreatest):
        return LeastGreatest(*(factor * end for end in value))
    return factor * value


@functools.cache
def dimension(unit: str) -> Dimension:
    """Returns the dimension of a unit such as ``1/(m/s²)²``.

    Args:
        unit: Factors ``m``, ``s``, ``kg``, ``N``, ``W``, ``rad`` with ``·``, ``/``,
            squares and parentheses.

    Raises:
        ValueError: If there is another factor in it.
    """
    total = [0, 0, 0]
    sign = 1
    for operator, group, name, square in re.findall(
        r"([·/]?)(?:\(([^()]*)\)|([^·/()²]+))(²?)", unit
    ):
        sign = -1 if operator == "/" else 1
        if not group and name not in _UNITS:
            raise ValueError(f"the unit {unit} has the unknown factor {name}")
        part = dimension(group) if group else _UNITS[name]
        power = sign * (2 if square else 1)
        total = [have + power * more for have, more in zip(total, part, strict=True)]
    return Dimension(*total)
