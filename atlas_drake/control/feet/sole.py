"""Geometry of a sole: its corners and its contact patches.

Regions for the CoP are in ``support_polygon``; the pitch of a sole is in
``sole_motion``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.gains import ContactModel
from atlas_drake.control.whole_body.contact import ContactPatch
from atlas_drake.messages.footstep import FootPose
from atlas_drake.robot import SoleSize
from atlas_drake.robot.soles import sole_corners


def toe_corners(
    flat: FootPose, half_length: float, half_width: float, toes: float
) -> np.ndarray:
    """Computes the corners of the strip that carries the toes, in W [m], (4, 3).

    ``toes`` is the length of the strip [m].
    """
    middle = flat.p_WF + (half_length - 0.5 * toes) * flat.R_WF[:, 0]
    return sole_corners(middle, flat.R_WF, 0.5 * toes, half_width)


@dataclass(frozen=True)
class SolePatches:
    """Regions in which the QP keeps the center of pressure of one sole."""

    whole: ContactPatch  # The sole less its margins
    middle: ContactPatch  # Turns a foot that stands on an edge flat
    toes: ContactPatch  # The strip at the front of the sole, while the heel is up
    heel: ContactPatch  # The strip at the back, while the toes are up


def sole_patches(sole: SoleSize, contact: ContactModel) -> SolePatches:
    """Makes the patches of a sole, within the margins that are closed to the CoP."""

    def patch(x: tuple[float, float], half_width: float) -> ContactPatch:
        return ContactPatch.rectangle(
            x, (-half_width, half_width), contact.friction, contact.yaw_moment_arm
        )

    tip = sole.length / 2
    half_length = tip - contact.length_margin
    half_width = sole.width / 2 - contact.width_margin
    toes, middle = contact.toes, contact.middle
    return SolePatches(
        whole=patch((-half_length, half_length), half_width),
        middle=patch((-middle, middle), middle),
        toes=patch((tip - toes, tip), half_width),
        heel=patch((-tip, toes - tip), half_width),
    )
