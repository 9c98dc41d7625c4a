"""Where the palms of hands are wanted, and goals on the way there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RotationMatrix

from atlas_drake.control.feet.curves import quintic_progress
from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages.checks import check_number, check_vector

SOFTEST, STIFFEST = 1.0, 1e5
"""Range of the stiffness of a palm's hold [N/m]."""
_UNIT = 1e-3
"""Largest difference of a quaternion's length from 1."""


@dataclass(frozen=True)
class HandGoal:
    """Where the palm of a hand has to be, and how the hand has to be turned there.

    Attributes:
        hand: Body of the hand, of those in the robot's file.
        position: Goal of the palm [m], shape (3,).
        direction: Where the hand has to point, shape (3,); None leaves it open.
        force: What the hand exerts there, for a load its weight upward [N], shape (3,).
        frame: Body of the robot in whose frame position, direction, force and
            orientation are given, and with which they move; ``trunk`` is the chest's
            link on every robot, ``world`` stands for W.
        orientation: How the body's frame has to be turned, a unit quaternion
            [w, x, y, z], in place of a direction; None leaves it open.
        palm: Another point than the robot's palm, in the body's frame [m], shape (3,).
            The hand points from the body's origin there.
        stiffness: Of the palm's hold in its softest direction, at least 1 [N/m]; None,
            or more than the arm can give, for as stiff as it can.
    """

    hand: str
    position: Sequence[float]
    direction: Sequence[float] | None = None
    force: Sequence[float] = (0.0, 0.0, 0.0)
    frame: str = "world"
    orientation: Sequence[float] | None = None
    palm: Sequence[float] | None = None
    stiffness: float | None = None

    def __post_init__(self) -> None:
        """Checks the numbers: Drake would end the process at NaN."""
        if self.stiffness is not None:
            check_number(self.stiffness, "stiffness", SOFTEST, STIFFEST)
        for name in ("position", "direction", "force", "orientation", "palm"):
            value = getattr(self, name)
            if value is None:
                continue
            numbers = check_vector(value, name, 4 if name == "orientation" else 3)
            if name in ("direction", "palm") and not numbers.any():
                problem = "must not be zero: the hand points nowhere"
                raise InvalidMessageError(name, value, problem)
            if name == "orientation" and abs(np.linalg.norm(numbers) - 1.0) > _UNIT:
                raise InvalidMessageError(name, value, "must be of length 1")
        if self.direction is not None and self.orientation is not None:
            problem = "a direction is given as well: the hand is turned by one of them"
            raise InvalidMessageError("orientation", self.orientation, problem)

    @property
    def rotation(self) -> RotationMatrix:
        """The orientation as a matrix."""
        wxyz = np.array(self.orientation)
        return RotationMatrix(Quaternion(wxyz / np.linalg.norm(wxyz)))

    def in_world(self, X_WF: RigidTransform) -> HandGoal:
        """Returns the same goal in W, where its frame is now.

        Args:
            X_WF: Pose of its frame.
        """
        R_WF, direction, orientation = X_WF.rotation(), self.direction, self.orientation
        if direction is not None:
            direction = R_WF @ np.array(direction)
        if orientation is not None:
            orientation = (R_WF @ self.rotation).ToQuaternion().wxyz()
        return replace(
            self,
            position=X_WF @ np.array(self.position),
            direction=direction,
            force=R_WF @ np.array(self.force),
            frame="world",
            orientation=orientation,
        )


def goal_between(start: HandGoal, end: HandGoal, share: float) -> HandGoal:
    """Returns the goal on a straight way, with the least jerk from rest to rest.

    T. Flash and N. Hogan, "The coordination of arm movements", J. Neurosci. 1985.

    Args:
        start: Where the way begins, in the frame of its end.
        end: Where it ends.
        share: Share of the time that has passed, 0 to 1.
    """
    progress, _, _ = quintic_progress(share)

    def between(start: Sequence[float], end: Sequence[float]) -> list[float]:
        way: list[float] = (
            np.array(start) + progress * (np.array(end) - np.array(start))
        ).tolist()
        return way

    direction = end.direction
    if start.direction is not None and direction is not None:
        direction = between(start.direction, direction)
    return replace(
        end,
        position=between(start.position, end.position),
        direction=direction,
        force=between(start.force, end.force),
        orientation=_turned(start, end, progress),
    )


def _turned(start: HandGoal, end: HandGoal, progress: float) -> list[float] | None:
    if end.orientation is None:
        return None
    first = start.rotation.ToQuaternion()
    between = first.slerp(progress, end.rotation.ToQuaternion())
    wxyz: list[float] = between.wxyz().tolist()
    return wxyz
