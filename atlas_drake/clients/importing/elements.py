"""Checks the elements of a URDF, whose readers take attributes as they come."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import lxml.etree as etree

from atlas_drake.clients.importing.findings import ImportRefused

DRAKE = "http://drake.mit.edu"
"""Namespace of what Drake's parser reads beside the elements of URDF."""
ROTOR_INERTIA, GEAR_RATIO = f"{{{DRAKE}}}rotor_inertia", f"{{{DRAKE}}}gear_ratio"
"""What Drake's parser reads of an actuator [kg·m²], [-]."""
_LARGEST = 1e9
"""Numbers beyond it are errors, in any unit."""


@dataclass(frozen=True)
class _Numbers:
    """What an attribute must be: so many numbers, within limits."""

    count: int = 1
    or_count: int = 0
    least: float = -_LARGEST
    may_be_infinite: bool = False

    def fault(self, text: str) -> str:
        """Returns what an attribute should be; empty if it is that."""
        wanted = "a number" if self.count == 1 else f"{self.count} numbers"
        try:
            values = [float(one) for one in text.split()]
        except ValueError:
            return wanted
        if len(values) not in (self.count, self.or_count) or not values:
            return wanted
        if any(map(math.isnan, values)) or not (
            self.may_be_infinite or all(abs(value) < _LARGEST for value in values)
        ):
            return f"{wanted}, finite"
        return f"{wanted}, not below 0" if min(values) < self.least else ""


_ANY, _THREE = _Numbers(), _Numbers(3)
_NOT_NEGATIVE = _Numbers(least=0.0)
_NO_LIMIT = _Numbers(may_be_infinite=True)
SHAPES = {
    "box": {"size": _Numbers(3, least=0.0)},
    "sphere": {"radius": _NOT_NEGATIVE},
    "cylinder": {"radius": _NOT_NEGATIVE, "length": _NOT_NEGATIVE},
    "capsule": {"radius": _NOT_NEGATIVE, "length": _NOT_NEGATIVE},
    f"{{{DRAKE}}}capsule": {"radius": _NOT_NEGATIVE, "length": _NOT_NEGATIVE},
    f"{{{DRAKE}}}ellipsoid": dict.fromkeys("abc", _NOT_NEGATIVE),
    "mesh": {"scale": _Numbers(3, or_count=1)},
}
"""Shapes of Drake's parser, and their numbers: all are needed but a mesh's scale."""
_NUMBERS = {
    **SHAPES,
    "origin": {"xyz": _THREE, "rpy": _THREE},
    "axis": {"xyz": _THREE},
    "mass": {"value": _ANY},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), _ANY),
    "color": {"rgba": _Numbers(4, or_count=3)},
    "limit": dict.fromkeys(("lower", "upper", "effort", "velocity"), _NO_LIMIT),
    "dynamics": {"damping": _NOT_NEGATIVE, "friction": _NOT_NEGATIVE},
    "mimic": {"multiplier": _ANY, "offset": _ANY},
}
"""The attributes of each element that are numbers."""
_NEEDED = {
    **{tag: tuple(numbers) for tag, numbers in SHAPES.items()},
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "mesh": ("filename",),
}
"""Attributes without which an element says nothing."""


def check_elements(root: Any) -> None:
    """Checks the attributes of links, joints, materials and motors.

    Raises:
        ImportRefused: If one is missing, or is not the number that it should be.
    """
    for part in root:
        if part.tag in ("link", "joint", "material"):
            elements = part.iter(etree.Element)
        else:  # The <joint> of a transmission is but a name.
            elements = part.iterfind("actuator/*")
        for element in elements:
            where = f"{part.tag} {part.get('name')}, <{spelt(element.tag)}>"
            for fault in _faults(element):
                raise ImportRefused(f"{where}: {fault}")


def _faults(element: Any) -> Iterator[str]:
    """Yields what is wrong with an element, without its children."""
    for name in _NEEDED.get(element.tag, ()):
        if name not in element.attrib:
            yield f"has no {name}"
    numbers = _NUMBERS.get(element.tag, {})
    if element.tag.startswith(f"{{{DRAKE}}}") and "value" in element.attrib:
        numbers = {"value": _ANY}
    for name, rule in numbers.items():
        text = element.get(name)
        wanted = rule.fault(text) if text is not None else ""
        if wanted:
            yield f"{name} is {text!r}; must be {wanted}"
    missing = {"parent", "child"}.difference(one.tag for one in element)
    if element.tag == "joint" and missing:
        yield f"has no <{min(missing)}>"
    if element.tag in ("visual", "collision"):
        shape = element.find("geometry/*")
        if shape is None or shape.tag not in SHAPES:
            found = "nothing" if shape is None else f"<{spelt(shape.tag)}>"
            yield f"its geometry is {found}; must be one of {', '.join(_NAMES)}"


def spelt(tag: str) -> str:
    """Returns the name of an element as files spell it."""
    return tag.replace(f"{{{DRAKE}}}", "drake:")


_NAMES = [spelt(tag) for tag in SHAPES]
