"""The description of a leg of six joints, read from the URDF.

A leg has, from the pelvis down, three hip joints in any order, the knee and two ankle
joints in either order; hips may be offset or tilted, and the knee may bend in either
direction. A leg of the layout in ``planar_leg`` has inverse kinematics in closed form;
kinematics with these lengths is in ``control.feet``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from atlas_drake.errors import RobotDescriptionError
from atlas_drake.frozen import read_only
from atlas_drake.robot.file import LEGS, RobotFile
from atlas_drake.robot.planar_leg import PlanarLeg, planar_leg

NUM_JOINTS = 6
HIP, KNEE, ANKLE = slice(0, 3), 3, slice(4, 6)
"""Places among a leg's joints, from the pelvis down."""
_SIDEWAYS = 0.8
"""Least share of the lateral axis in that of a pitch joint [-]."""
_SPANNED = 0.2
"""Least singular value of the axes of hip and ankle [-]: 0 if one adds nothing."""


@dataclass(frozen=True)
class Leg:
    """One leg; joints from the pelvis down, poses with all joints at zero.

    Attributes:
        joints: Indices of the six joints in message order, shape (6,).
        axes: The joints' axes in the pelvis frame, shape (6, 3).
        points: A point on each axis in the pelvis frame [m], shape (6, 3).
        sole: Pose of the sole in the pelvis frame, shape (4, 4).
        p_PT: Point on the hip's pitch axis, in the plane in which the knee bends, in
            the pelvis frame [m].
        thigh: Knee from that point, in this plane, ahead and up [m].
        shank: Ankle from the knee, likewise [m].
        p_FA: Ankle, where its axes meet or pass each other, in the sole frame [m].
        knee_sign: 1 if positive angles bend the knee, else -1.
        hip_pitch: Index of the joint in message order.
        ankle_pitch: Index of the joint in message order.
        ankle_roll: Index of the joint in message order.
        seed: Stand-prep pose, from which numeric kinematics begins [rad], shape (6,).
        distal_mass: Mass of all bodies beyond each joint [kg], shape (6,).
        least_flexion: Least flexion of the knee, from the straight leg [rad].
        most_flexion: Greatest flexion of the knee, from the straight leg [rad].
        planar: Lengths of the closed form; None for a leg of another layout.
    """

    joints: np.ndarray
    axes: np.ndarray
    points: np.ndarray
    sole: np.ndarray
    p_PT: np.ndarray
    thigh: tuple[float, float]
    shank: tuple[float, float]
    p_FA: np.ndarray
    knee_sign: float
    hip_pitch: int
    ankle_pitch: int
    ankle_roll: int
    seed: np.ndarray
    distal_mass: np.ndarray
    least_flexion: float
    most_flexion: float
    planar: PlanarLeg | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only, because all parts of a simulation share them."""
        read_only(self)

    @cached_property
    def thigh_length(self) -> float:
        """Distance from hip pitch to the knee [m]."""
        return math.hypot(*self.thigh)

    @cached_property
    def shank_length(self) -> float:
        """Distance from the knee to the ankle [m]."""
        return math.hypot(*self.shank)

    @cached_property
    def straight(self) -> float:
        """Knee position at which hip pitch, knee and ankle are in line [rad]."""
        # Angles of vectors in the plane grow with rotations about y.
        bent = math.atan2(*self.thigh) - math.atan2(*self.shank)
        return self.knee_sign * math.remainder(bent, math.tau)

    @property
    def hip_roll(self) -> int:
        """Index of the hip joint that turns the leg aside, in message order."""
        return int(self.joints[HIP][np.argmax(np.abs(self.axes[HIP, 0]))])

    @property
    def knee(self) -> int:
        """Index of the knee in message order."""
        return int(self.joints[KNEE])

    def flexion(self, position: float) -> float:
        """Computes how far a knee at this position is bent, from the straight leg.

        Args:
            position: Of the knee joint [rad].
        """
        return self.knee_sign * (position - self.straight)

    def knee_at(self, flexion: float) -> float:
        """Computes the position of the knee joint that is bent so far [rad].

        Args:
            flexion: From the straight leg [rad].
        """
        return self.straight + self.knee_sign * flexion


def read_legs(plant: Any, pelvis: Any, file: RobotFile) -> tuple[Leg, Leg]:
    """Reads both legs from a finalized plant of the robot alone, and checks them."""
    left, right = (_read_leg(plant, pelvis, file, foot) for foot in (0, 1))
    return left, right


def _read_leg(plant: Any, pelvis: Any, file: RobotFile, foot: int) -> Leg:
    limb = LEGS[foot]
    indices = [i for i, joint in enumerate(file.joints) if joint.limb == limb]
    names = [file.joints[i].name for i in indices]
    if len(names) != NUM_JOINTS:
        raise _unlike(limb, names, f"the leg has {len(names)} joints")
    joints = [plant.GetJointByName(name) for name in names]
    _check_chain(plant, pelvis, joints, file, foot)

    context = plant.CreateDefaultContext()
    frames = [joint.frame_on_child() for joint in joints]
    frames.append(plant.GetFrameByName(file.feet[foot].sole_frame))
    *poses, sole = [frame.CalcPose(context, pelvis.body_frame()) for frame in frames]
    axes = np.array(
        [
            pose.rotation().matrix() @ joint.revolute_axis()
            for pose, joint in zip(poses, joints, strict=True)
        ]
    )
    points = np.array([pose.translation() for pose in poses])
    hip_pitch, ankle_pitch = _pitch_joints(limb, names, axes)
    planar = planar_leg(axes, points, [*poses, sole])
    p_PT, thigh, shank, ankle = _side_view(axes, points, hip_pitch, ankle_pitch)
    p_FA = sole.inverse().multiply(ankle)
    if planar:
        # The layout gives the same places without rounding.
        p_PT, p_FA = planar.p_PT, points[5] - sole.translation()
    beyond = [plant.GetBodiesKinematicallyAffectedBy([j.index()]) for j in joints]
    masses = [
        sum(plant.get_body(body).get_mass(context) for body in bodies)
        for bodies in beyond
    ]
    return Leg(
        joints=np.array(indices),
        axes=axes,
        points=points,
        sole=np.array(sole.GetAsMatrix4()),
        p_PT=p_PT,
        thigh=thigh,
        shank=shank,
        p_FA=p_FA,
        knee_sign=math.copysign(1.0, axes[KNEE, 1]),
        hip_pitch=indices[hip_pitch],
        ankle_pitch=indices[ankle_pitch],
        ankle_roll=indices[_other_ankle(ankle_pitch)],
        seed=np.array([file.joints[i].stand_prep for i in indices]),
        distal_mass=np.array(masses),
        least_flexion=file.least_knee_flexion,
        most_flexion=file.most_knee_flexion,
        planar=planar,
    )


def _pitch_joints(limb: str, names: Sequence[str], axes: np.ndarray) -> tuple[int, int]:
    """Finds the pitch joints of hip and ankle, and checks what the axes span."""
    for part, kind, fault in (
        (HIP, "hip", "are parallel or in one plane"),
        (ANKLE, "ankle", "are parallel"),
    ):
        _, spanned, _ = np.linalg.svd(axes[part])
        if spanned[-1] < _SPANNED:
            joints = ", ".join(names[part])
            raise _unlike(limb, names, f"the {kind}'s axes, of {joints}, {fault}")
    sideways = np.abs(axes[:, 1])
    hip = int(np.argmax(sideways[HIP]))
    ankle = ANKLE.start + int(np.argmax(sideways[ANKLE]))
    for place, role in ((hip, "hip"), (KNEE, "knee"), (ankle, "ankle")):
        if sideways[place] < _SIDEWAYS:
            found = np.array2string(axes[place], precision=3)
            what = f"{names[place]}, the {role}'s pitch, turns about {found}"
            raise _unlike(limb, names, what)
    return hip, ankle


def _other_ankle(pitch: int) -> int:
    """Returns the place of the ankle's other joint."""
    return 2 * ANKLE.start + 1 - pitch


def _side_view(
    axes: np.ndarray, points: np.ndarray, hip_pitch: int, ankle_pitch: int
) -> tuple[np.ndarray, tuple[float, float], tuple[float, float], np.ndarray]:
    """Computes hip, thigh, shank and ankle in the plane in which the knee bends.

    The plane passes through the ankle, perpendicular to the knee's axis.
    """
    left = math.copysign(1.0, axes[KNEE, 1]) * axes[KNEE]
    up = np.array([0.0, 0.0, 1.0]) - left[2] * left
    up /= np.linalg.norm(up)
    ahead = np.cross(left, up)
    roll = _other_ankle(ankle_pitch)
    ankle = _nearest_to_line(
        points[roll], axes[roll], points[ankle_pitch], axes[ankle_pitch]
    )

    def in_plane(joint: int) -> np.ndarray:
        beside = left @ (ankle - points[joint]) / (left @ axes[joint])
        return points[joint] + beside * axes[joint]

    hip, knee = in_plane(hip_pitch), in_plane(KNEE)
    thigh, shank = knee - hip, ankle - knee
    return (
        hip,
        (float(thigh @ ahead), float(thigh @ up)),
        (float(shank @ ahead), float(shank @ up)),
        ankle,
    )


def _nearest_to_line(
    point: np.ndarray, axis: np.ndarray, other: np.ndarray, along: np.ndarray
) -> np.ndarray:
    """Computes the point of a line that is nearest to another line."""
    across = np.cross(along, np.cross(axis, along))
    return point + axis * (across @ (other - point)) / (across @ axis)


def _check_chain(
    plant: Any, pelvis: Any, joints: Sequence[Any], file: RobotFile, foot: int
) -> None:
    """Checks that each joint's parent is the joint before, or first the pelvis."""
    limb, names = LEGS[foot], [joint.name() for joint in joints]
    above = pelvis

    def is_part_of(body: Any, whole: Any) -> bool:
        welded = [other.index() for other in plant.GetBodiesWeldedTo(whole)]
        return body.index() in welded

    for joint in joints:
        if not is_part_of(joint.parent_body(), above):
            parent = joint.parent_body().name()
            wanted = f"joint {joint.name()} hangs on {parent}, not on {above.name()}"
            raise _unlike(limb, names, wanted)
        above = joint.child_body()
    entry = file.feet[foot]
    sole = plant.GetFrameByName(entry.sole_frame).body()
    for body in (plant.GetBodyByName(entry.body), sole):
        if not is_part_of(body, above):
            wanted = f"feet[{foot}] names {body.name()}, which is not below {names[-1]}"
            raise _unlike(limb, names, wanted)


def _unlike(limb: str, names: Sequence[str], problem: str) -> RobotDescriptionError:
    return RobotDescriptionError(
        "joints",
        list(names),
        f"{problem}. The joints with limb {limb} are {', '.join(names) or 'none'}; must"
        " be, from the pelvis down, three of the hip, the knee and two of the ankle, "
        "with one pitch joint in each",
    )
