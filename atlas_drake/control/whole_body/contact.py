"""Contacts of the robot with its surroundings, as the whole-body QP assumes them.

A ``ContactPatch`` is the constant part: the surface on which forces can act, and its
friction. A ``Contact`` holds what a behavior allows in one tick. The cone of wrenches
is that of Caron, Pham, Nakamura, "Stability of surface contacts for humanoid robots",
ICRA 2015.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from pydrake.math import RollPitchYaw, RotationMatrix, VectorToSkewSymmetric

from atlas_drake.control.gains import ContactModel
from atlas_drake.frozen import read_only
from atlas_drake.robot import ContactEntry

WRENCH = 6
"""Size of a wrench [moment; force]."""


@dataclass(frozen=True)
class ContactPatch:
    """A flat part of the robot on which its surroundings can push.

    The patch lies in the xy plane of a contact frame C, whose z axis points from the
    surroundings into the robot. C is fixed in a frame F of the robot; wrenches are
    at the origin of F.

    Attributes:
        corners: Convex polygon that contains the center of pressure: vertices in C,
            counterclockwise seen from +z [m], shape (m, 2), m ≥ 3.
        friction: Coefficient of friction; the QP uses the inscribed pyramid of the
            cone.
        yaw_moment_arm: Greatest moment about the z axis of C, as a lever of the
            friction force [m]; friction at the corners bounds it, too.
        R_FC: Orientation of the contact frame in F.
        p_FC: Origin of the contact frame in F [m].

    Raises:
        ValueError: If the corners are no convex polygon in counterclockwise order.
    """

    corners: np.ndarray
    friction: float
    yaw_moment_arm: float
    R_FC: np.ndarray = field(default_factory=lambda: np.eye(3))
    p_FC: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        edges = np.roll(self.corners, -1, axis=0) - self.corners
        following = np.roll(edges, -1, axis=0)
        turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
        if len(edges) < 3 or not (turns > 0.0).all():
            raise ValueError(
                "corners: a contact patch is a convex polygon, its corners"
                f" counterclockwise; got {self.corners.tolist()}"
            )

    @classmethod
    def rectangle(
        cls,
        x: tuple[float, float],
        y: tuple[float, float],
        friction: float,
        yaw_moment_arm: float,
    ) -> ContactPatch:
        """Makes a rectangle along the axes of the frame F itself.

        Args:
            x: Rear and front edge [m].
            y: Right and left edge [m].
            friction: See ``ContactPatch``.
            yaw_moment_arm: See ``ContactPatch`` [m].
        """
        (rear, front), (right, left) = x, y
        corners = [[front, left], [rear, left], [rear, right], [front, right]]
        return cls(np.array(corners), friction, yaw_moment_arm)

    @classmethod
    def of_entry(cls, entry: ContactEntry, contact: ContactModel) -> ContactPatch:
        """Makes the patch of a contact that the robot's file describes.

        Args:
            entry: The contact, as ``robot.contact(name)`` gives it.
            contact: Friction that the controller assumes.
        """
        x, y = 0.5 * entry.length, 0.5 * entry.width
        return cls(
            corners=np.array([[x, y], [-x, y], [-x, -y], [x, -y]]),
            friction=contact.friction,
            yaw_moment_arm=contact.yaw_moment_arm,
            R_FC=RotationMatrix(RollPitchYaw(entry.rpy_FC)).matrix(),
            p_FC=np.array(entry.p_FC),
        )

    @cached_property
    def cone(self) -> np.ndarray:
        """Rows C ∈ R^{r × 6} with C [moment; force] ≤ 0, axes of F.

        They allow what forces at the corners can sum up to, with no larger moment about
        the normal than ``yaw_moment_arm`` gives: exactly so for a rectangle along the
        axes of C, and for another polygon with the moment that the rectangle around it
        has. The last row is the normal force, which has separate bounds.
        """
        m_x, m_y, m_z, f_x, f_y, f_z = np.eye(WRENCH)
        pyramid = self.friction / np.sqrt(2.0) * f_z
        rows = [sign * force - pyramid for force in (f_x, f_y) for sign in (1.0, -1.0)]
        # Center of pressure (-m_y, m_x) / normal force, inside of every edge.
        edges = np.roll(self.corners, -1, axis=0) - self.corners
        for corner, edge in zip(self.corners, edges, strict=True):
            x, y = outward = np.array([edge[1], -edge[0]]) / np.hypot(*edge)
            rows.append(y * m_x - x * m_y - float(outward @ corner) * f_z)

        def greatest(axis: int, moment: np.ndarray, force: np.ndarray) -> np.ndarray:
            """Bounds Σ p f, with |f| within friction and Σ p f_z the moment, (2, 6)."""
            # At each corner (most - p) (μ f_z + f) ≥ 0, (p - least) (μ f_z - f) ≥ 0.
            least, most = self.corners[:, axis].min(), self.corners[:, axis].max()
            leaning = pyramid[-1] * moment
            above = most * (pyramid + force) - leaning
            return np.array([above, leaning - least * (pyramid - force)])

        # The moment about the normal is Σ x f_y - Σ y f_x.
        turning = self.friction * self.yaw_moment_arm * f_z
        for sign in (1.0, -1.0):
            rows.append(sign * m_z - turning)
            along, across = greatest(0, -m_y, sign * f_y), greatest(1, m_x, -sign * f_x)
            rows += [sign * m_z - one - other for one in along for other in across]
        rows.append(f_z)
        to_patch = np.zeros((WRENCH, WRENCH))
        to_patch[:3, :3] = to_patch[3:, 3:] = self.R_FC.T
        to_patch[:3, 3:] = -self.R_FC.T @ VectorToSkewSymmetric(self.p_FC)
        return read_only(np.array(rows) @ to_patch)

    @property
    def num_rows(self) -> int:
        """Number of rows r of the cone."""
        return len(self.cone)


@dataclass(frozen=True)
class Contact:
    """One contact in one tick: the QP finds its wrench within these bounds.

    The contact does not hold its frame still; a task on the frame does, with its
    weight.

    Attributes:
        frame: Name of the frame F in the robot's URDF.
        patch: Where and with which friction forces act on F.
        max_normal_force: Greatest normal force [N].
        min_normal_force: Smallest normal force [N].
        force_weight: Cost of the force: spreads the load over the contacts
            [cost]/[N]².
        moment_weight: Cost of the moment about the origin of F: keeps the pressure
            near it [cost]/[N·m]².
        support_share: Share of the weight, relative to the other contacts, that the
            contact takes in the gravity compensation that replaces an unsolved QP;
            0 for a hand that only leans [-].
    """

    frame: str
    patch: ContactPatch
    max_normal_force: float
    min_normal_force: float = 0.0
    force_weight: float = 1e-6
    moment_weight: float = 1e-4
    support_share: float = 1.0
