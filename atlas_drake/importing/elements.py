"""Checks the elements of a URDF, whose readers take attributes as they come."""

from __future__ import annotations

import math
from typing import Any

import lxml.etree as etree

from atlas_drake.importing.findings import ImportRefused

_NUMBERS = {"xyz": 3, "rpy": 3, "size": 3, "scale": 3, "radius": 1, "length": 1}
_NUMBERS |= dict.fromkeys(
    ("ixx", "ixy", "ixz", "iyy", "iyz", "izz", "damping", "friction", "mass"), 1
)
"""How many numbers an attribute has; a scale may also be one."""
_POSITIVE, _NOT_NEGATIVE = ("size", "radius", "length"), ("damping", "friction")
_LARGEST = 1e9
"""Numbers beyond it are errors, in any unit."""
_SHAPES = ("box", "sphere", "cylinder", "mesh")
_NEEDED = {
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "mesh": ("filename",),
}
"""Attributes without which an element says nothing."""
_LIMITS = ("lower", "upper", "effort", "velocity")
"""Attributes that may also say that there is no limit, as inf."""


def check_elements(root: Any) -> None:
    """Checks the attributes of links and joints.

    Raises:
        ImportRefused: If one is missing, or is not the number that it should be.
    """
    for part in root:
        if part.tag not in ("link", "joint"):
            continue
        for element in part.iter(etree.Element):
            where = f"{part.tag} {part.get('name')}, <{element.tag}>"
            for name in _NEEDED.get(element.tag, ()):
                if name not in element.attrib:
                    raise ImportRefused(f"{where}: has no {name}")
            for name, text in element.attrib.items():
                is_mass = element.tag == "mass" and name == "value"
                wanted = _fault("mass" if is_mass else name, text)
                if wanted:
                    raise ImportRefused(
                        f"{where}: {name} is {text!r}; must be {wanted}"
                    )
            missing = {"parent", "child"}.difference(one.tag for one in element)
            if element.tag == "joint" and missing:
                raise ImportRefused(f"{where}: has no <{min(missing)}>")
            if element.tag in ("visual", "collision"):
                shape = element.find("geometry/*")
                if shape is None or shape.tag not in _SHAPES:
                    found = "nothing" if shape is None else f"<{shape.tag}>"
                    raise ImportRefused(
                        f"{where}: its geometry is {found}; must be one of "
                        f"{', '.join(_SHAPES)}"
                    )


def _fault(name: str, text: str) -> str:
    """Returns what an attribute should be; empty if it is that."""
    count = 1 if name in _LIMITS else _NUMBERS.get(name)
    if count is None:
        return ""
    wanted = "a number" if count == 1 else f"{count} numbers"
    try:
        values = [float(one) for one in text.split()]
    except ValueError:
        return wanted
    if len(values) != count and not (name == "scale" and len(values) == 1):
        return wanted
    has_no_limit = name in _LIMITS and not any(map(math.isnan, values))
    if not has_no_limit and not all(abs(value) < _LARGEST for value in values):
        return f"{wanted}, finite"
    if name in _POSITIVE and min(values) <= 0.0:
        return f"{wanted}, above 0"
    if name in _NOT_NEGATIVE and min(values) < 0.0:
        return f"{wanted}, not below 0"
    if name == "scale" and 0.0 in values:
        return f"{wanted}, not 0"
    return ""
