"""Value types that the model tables are written in, and their mirror images.

No figure of any robot lives here. Lengths are in metres, angles in radians; every
pose is expressed in the frame of the link that carries the part.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

Vector: TypeAlias = tuple[float, float, float]

ZERO: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Box:
    """Box with edges along the axes of its pose."""

    size: Vector


@dataclass(frozen=True)
class Capsule:
    """Capsule about the z axis of its pose; `length` leaves out the round ends."""

    radius: float
    length: float


@dataclass(frozen=True)
class Sphere:
    """Sphere about the origin of its pose."""

    radius: float


@dataclass(frozen=True)
class Mesh:
    """Mesh file, drawn in the frame of its pose; path relative to the URDF."""

    path: str


Geometry: TypeAlias = Box | Capsule | Sphere | Mesh


@dataclass(frozen=True)
class Placed:
    """Geometry on a link, at `xyz` [m] turned by roll, pitch and yaw `rpy` [rad]."""

    geometry: Geometry
    xyz: Vector = ZERO
    rpy: Vector = ZERO


@dataclass(frozen=True)
class Inertial:
    """Mass properties of a link.

    Attributes:
        mass: Mass [kg].
        center_of_mass: Center of mass in the link frame [m].
        moments: ixx, iyy, izz about the center of mass, in link axes [kg·m²].
        products: ixy, ixz, iyz about the same point, in the same axes [kg·m²].
    """

    mass: float
    center_of_mass: Vector
    moments: Vector
    products: Vector = ZERO


@dataclass(frozen=True)
class Joint:
    """Revolute joint between two links.

    Attributes:
        name: Name of the joint, and of the actuator that drives it.
        parent: Link that the joint hangs on.
        child: Link that the joint carries; its frame is the joint frame.
        xyz: Origin of the child frame in the parent frame [m].
        axis: Axis of rotation, the same in both frames; need not be of unit length.
        lower: Lowest position [rad].
        upper: Highest position [rad].
        effort: Effort limit [N·m].
    """

    name: str
    parent: str
    child: str
    xyz: Vector
    axis: Vector
    lower: float
    upper: float
    effort: float


def mirror_point(xyz: Vector) -> Vector:
    """Returns the mirror image of a point in the plane y = 0."""
    x, y, z = xyz
    return (x, -y, z)


def mirror_placed(part: Placed) -> Placed:
    """Returns the mirror image in y = 0 of a shape that is symmetric in itself."""
    roll, pitch, yaw = part.rpy
    return replace(part, xyz=mirror_point(part.xyz), rpy=(-roll, pitch, -yaw))


def mirror_inertial(inertial: Inertial) -> Inertial:
    """Returns the mass properties of the mirror image in the plane y = 0."""
    ixy, ixz, iyz = inertial.products
    return replace(
        inertial,
        center_of_mass=mirror_point(inertial.center_of_mass),
        products=(-ixy, ixz, -iyz),
    )


def mirror_joint(joint: Joint) -> Joint:
    """Returns the mirror image in y = 0 of a joint, names left as they are.

    An axis turns over in a mirror as a pseudovector. Where that would only reverse
    it, the axis is kept and the range is reversed instead, which is how Atlas counts
    its right-hand joints.
    """
    x, y, z = joint.axis
    mirrored = replace(joint, xyz=mirror_point(joint.xyz))
    if y == 0.0:
        return replace(mirrored, lower=-joint.upper, upper=-joint.lower)
    return replace(mirrored, axis=(-x, y, -z))
