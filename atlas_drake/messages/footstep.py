"""A footstep, from the door to the report: desired, planned, taken or landed.

The pose of a foot is the pose of its sole frame: origin at the center of the sole on
its bottom plane, x to the toes, z along the sole's normal. The limits of a step are in
``control.feet.footstep``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from atlas_drake.config import as_float
from atlas_drake.errors import shown
from atlas_drake.frozen import Frozen, read_only
from atlas_drake.messages.behavior import ToeOff
from atlas_drake.messages.behavior_params import AtlasBehaviorStepData
from atlas_drake.rotations import rotation_matrix, rotation_with_normal, yaw_of

LEFT, RIGHT = 0, 1
UNLOADED, LOADED = 0.01, 0.05
"""Shares of the robot's weight below which a foot is in the air, and above which it is
on the ground; in between its state does not change [-]."""
ELSEWHERE = 0.05
"""A step that lands this far from its command counts as landed elsewhere [m]."""
ELSEWHERE_ANGLE = 0.2
"""A step that lands turned by this angle counts as landed elsewhere [rad]."""
UP: np.ndarray = read_only(np.array([0.0, 0.0, 1.0]))
"""Normal of level ground."""


@dataclass(frozen=True)
class FootPose:
    """Pose of a sole."""

    p_WF: np.ndarray  # Center of the sole in W [m], shape (3,).
    R_WF: np.ndarray  # Orientation of the sole, shape (3, 3).
    part: np.ndarray | None = None  # Corners of the part that carries, in F [m], (k, 2)

    @property
    def yaw(self) -> float:
        """Heading of the toes [rad]."""
        return yaw_of(self.R_WF)


@dataclass(frozen=True)
class StepAction:
    """Timing and motion of a step of STEP; the defaults are safe for the robot.

    Attributes:
        step_duration: Duration of single support [s].
        sway_duration: Duration of the weight shift before single support [s].
        swing_height: Rise above the lift height while the foot moves across [m].
        lift_height: Vertical lift above the higher of the two footholds [m].
        knee_nominal: Flexion of the standing knee [rad].
        max_body_accel: Largest acceleration of the body; a lower bound of the weight
            shift's duration follows from it [m/s²].
        max_foot_vel: Largest speed of the foot; a lower bound of the step's duration
            follows from it [m/s].
        sway_end_dist: Distance from the end of the weight shift to the middle of the
            standing sole [m].
        step_end_dist: Distance by which the body leans into the step as the foot comes
            down [m].
        toe_off: Setting for the heel of the leaving foot in the weight shift.
    """

    step_duration: float = 0.7
    sway_duration: float = 0.6
    swing_height: float = 0.02
    lift_height: float = 0.06
    knee_nominal: float = 0.6
    max_body_accel: float = 0.4
    max_foot_vel: float = 0.5
    sway_end_dist: float = 0.01
    step_end_dist: float = 0.0
    toe_off: ToeOff = ToeOff.ENABLE


@dataclass(frozen=True)
class Footstep(Frozen):
    """One step.

    Attributes:
        index: Number of the step, counted from 1.
        foot: LEFT (0) or RIGHT (1).
        p_WF: Landing point of the sole's center in W [m], shape (3,).
        yaw: Heading of the toes on landing [rad].
        duration: Time from one touchdown to the next [s].
        swing_height: Apex of the swing above the middle of its ends [m].
        normal: Normal of the ground at the landing point, a unit vector in W, shape
            (3,).
        relative: True if the height in ``p_WF`` is relative to the stance foot, not in
            W.
        action: Timing and motion, for STEP.
    """

    index: int
    foot: int
    p_WF: np.ndarray
    yaw: float
    duration: float = 0.0
    swing_height: float = 0.0
    normal: np.ndarray = field(default_factory=lambda: UP)
    relative: bool = False
    action: StepAction = StepAction()

    def __post_init__(self) -> None:
        """Check foot and yaw, and take point and normal as read-only arrays."""
        if self.foot not in (LEFT, RIGHT):
            raise ValueError(f"foot must be 0 or 1, is {shown(self.foot)}")
        if as_float(self.yaw) is None:
            raise ValueError(f"yaw must be a number, is {shown(self.yaw)}")
        p_WF = points(self.p_WF, "p_WF", (3,))
        object.__setattr__(self, "p_WF", p_WF)
        object.__setattr__(self, "normal", points(self.normal, "normal", (3,)))

    @property
    def pose(self) -> FootPose:
        """The landing pose of a step whose height is in W."""
        return FootPose(self.p_WF, rotation_with_normal(self.yaw, self.normal))


def points(given: object, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """Returns a field as an array of a shape, in which -1 stands for any length."""
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.ndim != len(shape) or any(
        size not in (-1, found) for size, found in zip(shape, array.shape, strict=True)
    ):
        raise ValueError(f"{name} must have shape {shape}, is {shown(given)}")
    return read_only(array)


def footstep_from(data: AtlasBehaviorStepData, relative: bool = False) -> Footstep:
    """Converts a message to a step with the pose of the sole frame in W.

    With ``relative`` its height counts from the stance foot.
    """
    p = data.pose.position
    quaternion = data.pose.orientation.to_wxyz()
    R_WF = rotation_matrix(quaternion / np.linalg.norm(quaternion))
    return Footstep(
        index=int(data.step_index),
        foot=int(data.foot_index),
        p_WF=np.array([p.x, p.y, p.z], dtype=float),
        yaw=yaw_of(R_WF),
        duration=float(data.duration),
        swing_height=float(data.swing_height),
        normal=R_WF[:, 2],
        relative=relative,
    )


def is_elsewhere(landing: Mapping[str, Any]) -> bool:
    """True if a foot landed far from the commanded pose, by the data of its event.

    That pose may have been out of reach, or balance may have moved the step.
    """
    return bool(
        landing["error_m"] >= ELSEWHERE or landing["error_rad"] >= ELSEWHERE_ANGLE
    )
