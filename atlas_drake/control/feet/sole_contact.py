"""Parts of a sole that the ground may push on, as contact patches of the QP."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.control.feet.toe_off import TOES
from atlas_drake.control.gains import ContactModel
from atlas_drake.control.whole_body.contact import ContactPatch
from atlas_drake.robot import SoleSize

MIDDLE = 0.01
"""Half the size of what counts as the middle of a sole [m]."""


@dataclass(frozen=True)
class SolePatches:
    """Where the center of pressure of one sole is kept.

    Attributes:
        whole: The sole less its margins.
        middle: The middle of the sole: a foot that stands on an edge is turned flat.
        toes: The strip at the front of the sole, while the heel is up.
    """

    whole: ContactPatch
    middle: ContactPatch
    toes: ContactPatch


def sole_patches(sole: SoleSize, contact: ContactModel) -> SolePatches:
    """Makes the patches of a sole.

    Args:
        sole: Size of the sole.
        contact: Friction, and the margins that the center of pressure stays out of.
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
