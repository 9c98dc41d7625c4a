"""The description of a leg, read from the URDF, and its required layout.

The closed-form laws of the controller need a leg of six joints, from the pelvis down
hip z, hip x, hip y, knee y, ankle y, ankle x. With all joints at zero every joint's
frame and the sole's are parallel to the pelvis', hip z and hip x meet in the hip's
center, ankle y and ankle x in the ankle, and hip y, knee and ankle lie in one plane
x-z, the leg's, through the hip's center or beside it. Positive angles bend the knee
backward. Kinematics with these lengths is in ``control.feet``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from atlas_drake.errors import RobotDescriptionError
from atlas_drake.robot.file import LEGS, RobotFile

JOINTS = ("hip z", "hip x", "hip y", "knee y", "ankle y", "ankle x")
"""Joints of a leg from the pelvis down, with their axes."""
HIP_PITCH, KNEE, ANKLE_PITCH = 2, 3, 4
"""Indices among a leg's joints."""
_TOLERANCE = 1e-6
"""Tolerance of positions and axes [m], [-]."""


@dataclass(frozen=True)
class Leg:
    """One leg; joints from the pelvis down, hip z to ankle x.

    Attributes:
        joints: Indices of the six joints in message order, shape (6,).
        p_PH: Hip center, where hip z and hip x meet, in the pelvis frame [m].
        aside: Distance of the leg's plane, with hip y, knee and ankle, from the hip
            center to the left [m].
        hip: Hip y axis from the hip center along x and z [m].
        thigh: Knee from the hip y axis at zero angles, in the leg's plane (x, z) [m].
        shank: Ankle from the knee at zero angles, in the leg's plane [m].
        p_FA: Ankle, where its axes meet, in the sole frame [m].
        mass_beyond: Mass of all bodies beyond each joint [kg], shape (6,).
        least_flexion: Least flexion of the knee, from the straight leg [rad].
        most_flexion: Greatest flexion of the knee, from the straight leg [rad].
    """

    joints: np.ndarray
    p_PH: np.ndarray
    aside: float
    hip: tuple[float, float]
    thigh: tuple[float, float]
    shank: tuple[float, float]
    p_FA: np.ndarray
    mass_beyond: np.ndarray
    least_flexion: float
    most_flexion: float

    @cached_property
    def p_HT(self) -> np.ndarray:
        """Hip y from the hip center with all joints at zero [m], shape (3,)."""
        return np.array([self.hip[0], self.aside, self.hip[1]])

    @cached_property
    def p_PT(self) -> np.ndarray:
        """Hip y in the pelvis frame with all joints at zero [m], shape (3,)."""
        return self.p_PH + self.p_HT

    @cached_property
    def thigh_length(self) -> float:
        """Distance from hip y to the knee [m]."""
        return math.hypot(*self.thigh)

    @cached_property
    def shank_length(self) -> float:
        """Distance from the knee to the ankle [m]."""
        return math.hypot(*self.shank)

    @cached_property
    def straight(self) -> float:
        """Knee position at which hip y, knee and ankle are in line [rad]."""
        # Angles of vectors in the plane grow with rotations about y.
        bent = math.atan2(*self.thigh) - math.atan2(*self.shank)
        return math.remainder(bent, math.tau)

    @property
    def knee(self) -> int:
        """Index of the knee in message order."""
        return int(self.joints[KNEE])


def read_legs(plant: Any, pelvis: Any, file: RobotFile) -> tuple[Leg, Leg]:
    """Reads both legs from a finalized plant of the robot alone, and checks them."""
    left, right = (_read_leg(plant, pelvis, file, foot) for foot in (0, 1))
    return left, right


def _read_leg(plant: Any, pelvis: Any, file: RobotFile, foot: int) -> Leg:
    limb = LEGS[foot]
    indices = [i for i, joint in enumerate(file.joints) if joint.limb == limb]
    names = [file.joints[i].name for i in indices]
    if len(names) != len(JOINTS):
        raise _unlike(limb, names, f"the leg has {len(names)} joints")
    joints = [plant.GetJointByName(name) for name in names]
    _check_chain(plant, pelvis, joints, file, foot)

    context = plant.CreateDefaultContext()
    frames = [joint.frame_on_child() for joint in joints]
    frames.append(plant.GetFrameByName(file.feet[foot].sole_frame))
    poses = [frame.CalcPose(context, pelvis.body_frame()) for frame in frames]
    _check_layout(limb, names, joints, poses, file.feet[foot].sole_frame)
    p = [np.array(pose.translation()) for pose in poses]

    def plane(end: int, start: int) -> tuple[float, float]:
        return float(p[end][0] - p[start][0]), float(p[end][2] - p[start][2])

    beyond = [plant.GetBodiesKinematicallyAffectedBy([j.index()]) for j in joints]
    masses = [
        sum(plant.get_body(body).get_mass(context) for body in bodies)
        for bodies in beyond
    ]
    return Leg(
        joints=np.array(indices),
        p_PH=p[0],
        aside=float(p[2][1] - p[0][1]),
        hip=plane(2, 1),
        thigh=plane(3, 2),
        shank=plane(4, 3),
        p_FA=p[5] - p[6],
        mass_beyond=np.array(masses),
        least_flexion=file.least_knee_flexion,
        most_flexion=file.most_knee_flexion,
    )


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


def _check_layout(
    limb: str,
    names: Sequence[str],
    joints: Sequence[Any],
    poses: Sequence[Any],
    sole: str,
) -> None:
    """Checks axes and positions of a leg's joints and sole with joints at zero."""
    for name, joint, known in zip(names, joints, JOINTS, strict=True):
        axis, wanted = joint.revolute_axis(), np.eye(3)["xyz".index(known[-1])]
        if not np.allclose(axis, wanted, atol=_TOLERANCE):
            found = np.array2string(np.array(axis), precision=3)
            raise _unlike(limb, names, f"{name}, the {known}, turns about {found}")
    for name, pose in zip((*names, sole), poses, strict=True):
        if not np.allclose(pose.rotation().matrix(), np.eye(3), atol=_TOLERANCE):
            what = f"with all joints at zero {name} is not parallel to the pelvis"
            raise _unlike(limb, names, what)
    p = [pose.translation() for pose in poses]
    for place, other in ((1, 0), (5, 4)):
        if not np.allclose(p[place], p[other], atol=_TOLERANCE):
            what = f"{names[place]} does not meet {names[other]} in one point"
            raise _unlike(limb, names, what)
    for name, position in zip(names[KNEE:], p[KNEE:], strict=False):
        if abs(position[1] - p[HIP_PITCH][1]) > _TOLERANCE:
            where = f"{name} lies beside the plane of {names[HIP_PITCH]}"
            raise _unlike(limb, names, where)


def _unlike(limb: str, names: Sequence[str], problem: str) -> RobotDescriptionError:
    return RobotDescriptionError(
        "joints",
        list(names),
        f"{problem}. The joints with limb {limb} are {', '.join(names) or 'none'}; must"
        f" be, from the pelvis down, {', '.join(JOINTS)}, the last four in one plane,"
        " the two outer hip joints and the two ankle joints each in one point",
    )
