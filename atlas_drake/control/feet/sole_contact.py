"""Contact patches of a sole, for the contacts of the QP."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.control.feet.toe_off import TOES
from atlas_drake.control.gains import ContactModel
from atlas_drake.control.whole_body.contact import ContactPatch
from atlas_drake.robot import SoleSize

MIDDLE = 0.01
"""Half the side of the square that counts as the middle of a sole [m]."""


@dataclass(frozen=True)
class SolePatches:
    """Regions in which the QP keeps the center of pressure of one sole.

    Attributes:
        whole: The sole less its margins.
        middle: The middle of the sole, which turns a foot that stands on an edge flat.
        toes: The strip at the front of the sole, while the heel is up.
    """

    whole: ContactPatch
    middle: ContactPatch
    toes: ContactPatch


def sole_patches(sole: SoleSize, contact: ContactModel) -> SolePatches:
    """Makes the patches of a sole.

    Args:
        sole: Size of the sole.
        contact: Friction, and the margins that are closed to the center of pressure.
    """

    def patch(x: tuple[float, float], half_width: float) -> ContactPatch:
        return ContactPatch.rectangle(
            x, (-half_width, half_width), contact.friction, contact.yaw_moment_arm
        )

    tip = sole.length / 2
    half_length = tip - contact.length_margin
    half_width = sole.width / 2 - contact.width_margin
    return SolePatches(
        whole=patch((-half_length, half_length), half_width),
        middle=patch((-MIDDLE, MIDDLE), MIDDLE),
        toes=patch((tip - TOES, tip), half_width),
    )
