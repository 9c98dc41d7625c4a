"""The shapes of links, all that Drake's parser reads: yourdfpy knows fewer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import lxml.etree as etree

from atlas_drake.clients.importing.elements import DRAKE, SHAPES, spelt


@dataclass(frozen=True)
class Geometry:
    """One shape.

    Attributes:
        tag: Name of its element, with the namespace.
        numbers: The attributes that are numbers, by name.
        file: Name of a mesh's file.
        properties: Elements with Drake's properties of the contact.
    """

    tag: str
    numbers: Mapping[str, tuple[float, ...]]
    file: str = ""
    properties: tuple[Any, ...] = ()

    @property
    def kind(self) -> str:
        """Name of the shape, such as ``capsule``."""
        return spelt(self.tag).removeprefix("drake:")

    @property
    def is_mesh(self) -> bool:
        """True for a mesh, False for a shape that its numbers describe."""
        return self.tag == "mesh"

    @property
    def has_size(self) -> bool:
        """False if one of its numbers is 0."""
        return all(all(values) for values in self.numbers.values())

    def size(self, name: str) -> float:
        """Returns a number of the shape [m]."""
        return self.numbers[name][0]


def take_geometries(root: Any) -> list[dict[str, list[Geometry]]]:
    """Returns the shapes of each link, of its visuals and of its collisions.

    In their place the tree gets a shape that every reader knows.
    """
    return [
        {
            kind: [_take(shown) for shown in link.findall(kind)]
            for kind in ("visual", "collision")
        }
        for link in root.findall("link")
    ]


def _take(shown: Any) -> Geometry:
    """Returns the shape of a visual or a collision, and replaces it in the tree."""
    element = shown.find("geometry/*")
    numbers = {
        name: tuple(float(one) for one in element.get(name).split())
        for name in SHAPES[element.tag]
        if name in element.attrib
    }
    found = Geometry(
        element.tag,
        numbers,
        element.get("filename", ""),
        tuple(shown.findall(f"{{{DRAKE}}}proximity_properties")),
    )
    element.getparent().replace(element, etree.Element("box", size="1 1 1"))
    return found
