"""Positions, orientations, velocities and forces in messages.

Data only: compute rotations and rigid transforms with Drake.
"""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from atlas_drake.messages.base import Message
from atlas_drake.messages.fields import NotNegative, Number, not_zero


@dataclass(slots=True, eq=False)
class Header(Message):
    """Time and frame of a message.

    Attributes:
        stamp: Simulation time [s]. 0 or ``None`` in a command means "now".
        frame_id: Name of the frame; empty means the frame that the message documents.
    """

    stamp: NotNegative | None = 0.0
    frame_id: str = ""


@dataclass(slots=True, eq=False)
class Vector3(Message):
    """A vector: a position [m], a velocity [m/s or rad/s], a force [N], ..."""

    x: Number = 0.0
    y: Number = 0.0
    z: Number = 0.0

    @classmethod
    def from_array(cls, xyz: ArrayLike) -> "Vector3":
        """Make a vector from numbers.

        Args:
            xyz: x, y, z; shape (3,).
        """
        x, y, z = np.asarray(xyz, dtype=float).tolist()
        return cls(x, y, z)

    def to_array(self) -> NDArray[np.float64]:
        """Return x, y, z; shape (3,)."""
        return np.array([self.x, self.y, self.z], dtype=float)


@dataclass(slots=True, eq=False)
class Quaternion(Message):
    """An orientation; x, y, z, w in this order, the scalar last.

    The default is the identity, so that a pose with only a position is valid. Readers
    normalise the quaternion.
    """

    x: Number = 0.0
    y: Number = 0.0
    z: Number = 0.0
    w: Number = 1.0

    @classmethod
    def from_wxyz(cls, wxyz: ArrayLike) -> "Quaternion":
        """Make a quaternion from numbers in the order of Drake and Eigen.

        Args:
            wxyz: w, x, y, z; shape (4,).
        """
        w, x, y, z = np.asarray(wxyz, dtype=float).tolist()
        return cls(x, y, z, w)

    def to_wxyz(self) -> NDArray[np.float64]:
        """Return w, x, y, z, the order of Drake and Eigen; shape (4,)."""
        return np.array([self.w, self.x, self.y, self.z], dtype=float)


Rotation = Annotated[Quaternion, not_zero("xyzw")]
"""A quaternion that can be normalised."""


@dataclass(slots=True, eq=False)
class Pose(Message):
    """Position [m] and orientation of a frame."""

    position: Vector3 = field(default_factory=Vector3)
    orientation: Rotation = field(default_factory=Quaternion)


@dataclass(slots=True, eq=False)
class Twist(Message):
    """A linear [m/s] and an angular [rad/s] velocity."""

    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass(slots=True, eq=False)
class Wrench(Message):
    """A force [N] and a torque [N·m]."""

    force: Vector3 = field(default_factory=Vector3)
    torque: Vector3 = field(default_factory=Vector3)
