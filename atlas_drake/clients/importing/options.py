"""What the user of an import says instead of leaving it to be found."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

HEADINGS = {"x": 0.0, "y": 90.0, "-x": 180.0, "-y": -90.0}
"""Direction of the root's frame in which the robot faces, and its angle [degree]."""


@dataclass(frozen=True)
class ImportOptions:
    """Values that go before what is found; None and empty leave it to be found.

    Attributes:
        packages: Folders of ``package://`` names.
        faces: Axis of the root's frame along which the robot faces.
        feet: Links of the left and the right foot.
        chest: Link that balance keeps upright.
        hands: Links of the left and the right hand.
        sole: Length and width of each sole, height of the ankle above it, and distance
            of its middle ahead of the ankle [m].
        fixed: Joints that become fixed.
        fingers: Whether moving fingers stay joints, of the limbs ``l_hand`` and
            ``r_hand``.
    """

    packages: dict[str, Path] = field(default_factory=dict)
    faces: str | None = None
    feet: tuple[str, str] | None = None
    chest: str | None = None
    hands: tuple[str, str] | None = None
    sole: tuple[float, float, float, float] | None = None
    fixed: tuple[str, ...] = ()
    fingers: bool = False
