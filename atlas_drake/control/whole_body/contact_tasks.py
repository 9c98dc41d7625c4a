"""Tasks of the whole-body QP on the contact wrenches: centroidal motion and load.

Their rows are G λ + g; no Jacobian enters. The floating-base dynamics hold exactly, so
the sum of the contact forces is the motion of the center of mass. The eCMP and the VRP
are those of Englsberger, Ott, Albu-Schäffer, "Three-dimensional bipedal walking control
based on divergent component of motion", T-RO 2015.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from atlas_drake.control.whole_body.contact import WRENCH, Contact
from atlas_drake.control.whole_body.tasks import Task, TaskRows
from atlas_drake.control.whole_body.terms import WholeBodyTerms
from atlas_drake.units import GRAVITY

_ZERO = np.zeros(3)
_FREE_FALL = np.array([0.0, 0.0, -GRAVITY])


@dataclass(frozen=True)
class ComTask(Task):
    """Acceleration of the center of mass: m c̈ = Σ f + m g, and what pulls at the hands.

    Attributes:
        target: Acceleration in W [m/s²], shape (3,).
        weight: [cost]/[m/s²]².
    """

    target: np.ndarray
    weight: np.ndarray | float

    def rows(self, terms: WholeBodyTerms, contacts: Sequence[Contact]) -> TaskRows:
        """Returns G ∈ R^{3 × 6 c} and the acceleration without contacts."""
        per_mass = 1.0 / terms.mass
        G = np.zeros((3, WRENCH * len(contacts)))
        for axis in range(3):
            G[axis, 3 + axis :: WRENCH] = per_mass
        return TaskRows(None, _FREE_FALL + per_mass * terms.pull[3:], G)


@dataclass(frozen=True)
class MomentTask(Task):
    """Horizontal moment of all contact wrenches about a point.

    The moment M about y and x is divided by m·h, h the height of the center of mass
    above the point: a moment m·h·a about the point below a point mass accelerates it
    by a, toward +x and toward -y.

    Zero moment makes the sum of the contact forces pass through the point. The
    shipped behaviors take the enhanced centroidal moment pivot (eCMP), g/ω² below
    the virtual repellent point (VRP); about the VRP itself, which lies at the height
    of the center of mass, the moment would not vanish.

    Attributes:
        p_WE: The point, below the center of mass, in W [m], shape (3,).
        weight: [cost]/[m/s²]².
        target: [M_y, M_x] / (m·h) [m/s²], shape (2,).
    """

    p_WE: np.ndarray
    weight: np.ndarray | float
    target: np.ndarray = field(default_factory=lambda: np.zeros(2))

    def rows(self, terms: WholeBodyTerms, contacts: Sequence[Contact]) -> TaskRows:
        """Returns G ∈ R^{2 × 6 c}."""
        x_E, y_E, z_E = self.p_WE.tolist()
        scale = 1.0 / (terms.mass * (float(terms.com[2]) - z_E))
        about_y: list[float] = []
        about_x: list[float] = []
        for contact in contacts:
            x, y, z = terms.frame(contact.frame).p_WF.tolist()
            lift = scale * (z - z_E)
            about_y += (0.0, scale, 0.0, lift, 0.0, scale * (x_E - x))
            about_x += (scale, 0.0, 0.0, 0.0, -lift, scale * (y - y_E))
        return TaskRows(None, _ZERO[:2], np.array([about_y, about_x]))


@dataclass(frozen=True)
class InternalContactTask(Task):
    """Internal contact force and moment of two contacts: horizontal push, yaw moment.

    The rows are the differences of the yaw moments and of the horizontal forces of
    the two contacts in W. They are zero where one of the contacts is missing.

    Internal forces and moments of two feet move nothing, and without this task they
    would cost almost nothing. The QP would use them: across a sole rolled by 0.002 rad,
    160 N count as 0.3 N more on the sole, and so as 0.04 N·m more at its toe: whenever
    the center of pressure is at the edge, the feet would push apart or together,
    depending on the tilt of the soles, and slide on the ground. The task also penalizes
    an uneven split of a force that both feet have to give, which shifts the split by
    less than a hundredth.

    Attributes:
        frames: Frames of the two contacts.
        weight: [cost]/[N·m]² for the yaw moment, [cost]/[N]² for both forces, shape
            (3,).
        target: [Δm_z, Δf_x, Δf_y] [N·m; N; N], shape (3,).
    """

    frames: tuple[str, str]
    weight: np.ndarray
    target: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def rows(self, terms: WholeBodyTerms, contacts: Sequence[Contact]) -> TaskRows:
        """Returns G ∈ R^{3 × 6 c}, entries 1 and -1."""
        found = [contact.frame for contact in contacts]
        G = np.zeros((3, WRENCH * len(found)))
        if all(frame in found for frame in self.frames):
            for frame, sign in zip(self.frames, (1.0, -1.0), strict=True):
                start = WRENCH * found.index(frame)
                G[0, start + 2] = G[1, start + 3] = G[2, start + 4] = sign
        return TaskRows(None, _ZERO, G)
