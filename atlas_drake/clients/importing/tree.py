"""The tree of links and joints of a URDF, and its poses.

yourdfpy reads the elements; which joints move is decided here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import lxml.etree as etree
import numpy as np
import yourdfpy.urdf as urdf
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RigidTransform

from atlas_drake.clients.importing.elements import (
    DRAKE,
    GEAR_RATIO,
    ROTOR_INERTIA,
    check_elements,
)
from atlas_drake.clients.importing.findings import ImportRefused
from atlas_drake.clients.importing.geometry import take_geometries

MOVING = ("revolute", "continuous")
MOTIONS = (*MOVING, "prismatic")
"""Joints of one degree of freedom; those that turn may be a limb's."""
_TYPES = (*MOTIONS, "fixed", "floating", "planar")


class Tree:
    """Links and joints by name; changed by the repairs.

    Attributes:
        links: The links.
        joints: The joints.
        rotors: Rotor inertia and gear ratio, as Drake's elements, by joint.
    """

    def __init__(self, file: Path) -> None:
        """Reads a file."""
        try:
            root = _read(file)
            self.rotors = _rotors(root)
            robot = _parsed(root)
        except ImportRefused:
            raise
        except Exception as error:  # lxml and yourdfpy raise several kinds.
            said = " ".join(str(error).split()) or type(error).__name__
            raise ImportRefused(f"{file}: is no URDF: {said}") from None
        self.links: dict[str, Any] = _by_name("link", robot.links)
        self.joints: dict[str, Any] = _by_name("joint", robot.joints)
        self._materials = robot.materials
        self._check()

    def _check(self) -> None:
        """Checks that all links hang on one root, each on one joint."""
        above: dict[str, str] = {}
        for joint in self.joints.values():
            self._check_joint(joint)
            if joint.child in above:
                both = f"{above[joint.child]} and {joint.name}"
                raise ImportRefused(f"link {joint.child}: hangs on two joints, {both}")
            above[joint.child] = joint.name
        roots = [name for name in self.links if name not in above]
        if len(roots) != 1:
            named = ", ".join(roots) or "none"
            raise ImportRefused(f"the tree must have one root link, and has {named}")
        self.index()
        loop = set(self.links).difference(self.all_below(self.root))
        if loop:
            names = ", ".join(sorted(loop))
            raise ImportRefused(f"links {names}: hang on each other in a loop")

    def _check_joint(self, joint: Any) -> None:
        """Checks type, links and axis; an axis gets the length 1."""
        if joint.type not in _TYPES:
            raise ImportRefused(
                f"joint {joint.name}: its type is {joint.type!r}; must be one of "
                f"{', '.join(_TYPES)}"
            )
        for end in (joint.parent, joint.child):
            if end not in self.links:
                raise ImportRefused(f"joint {joint.name}: there is no link {end}")
        if joint.type in MOTIONS:
            length = float(np.linalg.norm(joint.axis))
            if not length > 1e-6:
                raise ImportRefused(f"joint {joint.name}: its axis is {joint.axis}")
            joint.axis = joint.axis / length

    @property
    def root(self) -> str:
        """The link on no joint."""
        return next(name for name in self.links if name not in self._above)

    def below(self, link: str) -> list[Any]:
        """Returns the joints that hang on a link."""
        return self._below.get(link, [])

    def index(self) -> None:
        """Notes the tree anew, after a change."""
        self._above = {joint.child: joint for joint in self.joints.values()}
        self._below: dict[str, list[Any]] = {}
        for joint in self.joints.values():
            self._below.setdefault(joint.parent, []).append(joint)

    def all_below(self, link: str) -> Iterator[str]:
        """Yields a link and all that hang on it."""
        yield link
        for joint in self.below(link):
            yield from self.all_below(joint.child)

    def moves(self, joint: Any) -> bool:
        """Returns True for a joint that turns by its own motor."""
        return joint.type in MOVING and joint.mimic is None

    def body_of(self, link: str) -> str:
        """Returns the topmost link that ``link`` is fixed to."""
        joint = self._above.get(link)
        if joint is None or self.moves(joint):
            return link
        return self.body_of(joint.parent)

    def body_named(self, option: str, link: str) -> str:
        """Returns the topmost link that the link of a user's option is fixed to."""
        if link not in self.links:
            raise ImportRefused(f"--{option}: there is no link {link}")
        return self.body_of(link)

    def parts_of(self, link: str) -> list[str]:
        """Returns a link and all links below that are fixed to it."""
        fixed = [joint.child for joint in self.below(link) if not self.moves(joint)]
        return [link, *(part for child in fixed for part in self.parts_of(child))]

    def chain(self, link: str) -> list[Any]:
        """Returns the moving joints from the root to a link."""
        joint = self._above.get(link)
        if joint is None:
            return []
        return self.chain(joint.parent) + ([joint] if self.moves(joint) else [])

    def moving_below(self, link: str) -> list[Any]:
        """Returns the moving joints next below a link, past fixed ones."""
        found = []
        for joint in self.below(link):
            found += [joint] if self.moves(joint) else self.moving_below(joint.child)
        return found

    def all_moving_below(self, link: str) -> list[Any]:
        """Returns all moving joints below a link."""
        above = [self._above.get(part) for part in self.all_below(link)][1:]
        return [joint for joint in above if self.moves(joint)]

    def poses(
        self, positions: Mapping[str, float] | None = None
    ) -> dict[str, np.ndarray]:
        """Computes the pose of each link in the root's frame, shape (4, 4).

        Joints that ``positions`` [rad], [m] do not name are at zero.
        """
        found = {self.root: np.eye(4)}
        pending = [self.root]
        while pending:
            link = pending.pop()
            for joint in self.below(link):
                X = found[link] @ joint.origin
                at = (positions or {}).get(joint.name, 0.0)
                if at:
                    X = X @ _motion(joint, at).GetAsMatrix4()
                found[joint.child] = X
                pending.append(joint.child)
        return found

    def limits(self, joint: Any) -> tuple[float, float]:
        """Returns the least and the greatest position of a joint [rad]."""
        if joint.type == "continuous" or joint.limit is None:
            return -math.pi, math.pi
        lower, upper = float(joint.limit.lower or 0.0), float(joint.limit.upper or 0.0)
        return (
            lower if math.isfinite(lower) else -math.pi,
            upper if math.isfinite(upper) else math.pi,
        )

    def color(self, material: Any) -> np.ndarray | None:
        """Returns red, green, blue and opacity of a material; None without a color."""
        if material is None:
            return None
        for one in (material, *self._materials):
            if one.name == material.name and one.color is not None:
                # Some files leave out the opacity, or count up to 255.
                rgba = np.append(np.asarray(one.color.rgba, dtype=float), 1.0)[:4]
                largest = 255.0 if rgba[:3].max() > 1.0 else 1.0
                return np.clip(rgba / [largest, largest, largest, 1.0], 0.0, 1.0)
        return None

    def mass_of(self, links: list[str]) -> float:
        """Returns the mass of links [kg]."""
        inertials = [self.links[name].inertial for name in links]
        return sum(float(one.mass or 0.0) for one in inertials if one is not None)


def _read(file: Path) -> Any:
    """Reads and checks the elements of a file.

    An element without an origin gets that of its link.
    """
    parser = etree.XMLParser(remove_comments=True, remove_pis=True)
    root = etree.parse(str(file), parser).getroot()
    if root.tag != "robot":
        raise ValueError(f"its outermost element is <{root.tag}>, not <robot>")
    for element in root.iter(etree.Element):
        if element.prefix == "drake":  # Drake goes by the prefix.
            element.tag = f"{{{DRAKE}}}{etree.QName(element).localname}"
    check_elements(root)
    root.set("name", file.stem)  # yourdfpy wants one.
    for placed in root.iter("inertial", "visual", "collision", "joint"):
        if placed.find("origin") is None:
            etree.SubElement(placed, "origin")
    return root


def _rotors(root: Any) -> dict[str, dict[str, float]]:
    """Returns what is known of the rotors, by joint."""
    return {
        joint.get("name"): {
            tag: float(rotor.get("value", 0.0))
            for tag in (ROTOR_INERTIA, GEAR_RATIO)
            for rotor in transmission.iterfind(f"actuator/{tag}")
        }
        for transmission in root.iterfind("transmission")
        for joint in transmission.iterfind("joint")
    }


def _parsed(root: Any) -> urdf.Robot:
    """Reads elements by yourdfpy, which reads on past faults."""
    geometries = take_geometries(root)
    robot = urdf.URDF.load(
        BytesIO(etree.tostring(root)),
        build_scene_graph=False,
        load_meshes=False,
        load_collision_meshes=False,
    ).robot
    for link, taken in zip(robot.links, geometries, strict=True):
        for kind, shapes in taken.items():
            for shown, geometry in zip(getattr(link, f"{kind}s"), shapes, strict=True):
                shown.geometry = geometry
    return robot


def _motion(joint: Any, at: float) -> RigidTransform:
    """Returns the motion of a joint to a position [rad] or [m]."""
    if joint.type in MOVING:
        return RigidTransform(AngleAxis(at, joint.axis), [0.0, 0.0, 0.0])
    return RigidTransform(at * joint.axis)


def _by_name(kind: str, parts: Iterable[Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for part in parts:
        if part.name in found:
            raise ImportRefused(f"{kind} {part.name}: is there twice")
        found[part.name] = part
    return found
