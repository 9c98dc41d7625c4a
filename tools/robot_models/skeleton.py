"""Kinematics of Atlas v3, which both robots share: joints, frames and the sole.

Masses are in `inertias`, shapes in `collisions` and `appearance`. The figures are
those of the DARPA Robotics Challenge simulator's Atlas v3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from robot_models.parts import (
    ZERO,
    Joint,
    Vector,
    mirror_joint,
)

VELOCITY_LIMIT = 12.0
"""Velocity limit of every joint [rad/s]."""

JOINT_DAMPING = 0.1
"""Viscous damping of every joint [N·m·s/rad]."""

SOLE_LENGTH = 0.26
"""Length of the sole along the foot's x axis [m]."""

SOLE_WIDTH = 0.124887
"""Width of the sole along the foot's y axis [m]."""

SOLE_CENTER: Vector = (0.048, 0.0, -0.081119)
"""Center of the sole's bottom plane, from the ankle, in the foot frame [m]."""

IMU_POSITION: Vector = (0.0599, 0.0, -0.01415)
"""Origin of the inertial measurement unit in the pelvis frame [m]."""

_TRUNK = (
    Joint(
        "back_bkz", "pelvis", "ltorso", (-0.0125, 0.0, 0.0), (0.0, 0.0, 1.0),
        -0.663225, 0.663225, 124.016,
    ),
    Joint(
        "back_bky", "ltorso", "mtorso", (0.0, 0.0, 0.16197), (0.0, 1.0, 0.0),
        -0.610691, 0.438427, 206.843,
    ),
    Joint(
        "back_bkx", "mtorso", "utorso", (0.0, 0.0, 0.05), (1.0, 0.0, 0.0),
        -0.698132, 0.698132, 200.0,
    ),
    Joint(
        "neck_ry", "utorso", "head", (0.21672, 0.0, 0.53796), (0.0, 1.0, 0.0),
        -0.602139, 1.14494, 5.0,
    ),
)  # fmt: skip

_LEFT_LEG = (
    Joint(
        "leg_hpz", "pelvis", "uglut", (0.0, 0.089, 0.0), (0.0, 0.0, 1.0),
        -0.174533, 1.22173, 110.0,
    ),
    Joint(
        "leg_hpx", "uglut", "lglut", ZERO, (1.0, 0.0, 0.0),
        -0.523599, 0.523599, 180.0,
    ),
    Joint(
        "leg_hpy", "lglut", "uleg", (0.05, 0.0, -0.05), (0.0, 1.0, 0.0),
        -1.72072, 0.524821, 260.0,
    ),
    Joint(
        "leg_kny", "uleg", "lleg", (-0.05, 0.0, -0.374), (0.0, 1.0, 0.0),
        0.0, 2.38569, 220.0,
    ),
    Joint(
        "leg_aky", "lleg", "talus", (0.0, 0.0, -0.422), (0.0, 1.0, 0.0),
        -1.0, 0.7, 700.0,
    ),
    Joint(
        "leg_akx", "talus", "foot", ZERO, (1.0, 0.0, 0.0),
        -0.8, 0.8, 90.0,
    ),
)  # fmt: skip

_LEFT_ARM = (
    Joint(
        "arm_shy", "utorso", "clav", (0.06441, 0.13866, 0.10718),
        (0.0, 0.5, 0.866025), -1.5708, 0.785398, 212.0,
    ),
    Joint(
        "arm_shx", "clav", "scap", (0.0, 0.14035, 0.19609), (1.0, 0.0, 0.0),
        -1.5708, 1.5708, 170.0,
    ),
    Joint(
        "arm_ely", "scap", "uarm", (0.0, 0.187, 0.016), (0.0, 1.0, 0.0),
        0.0, 3.14159, 114.0,
    ),
    Joint(
        "arm_elx", "uarm", "larm", (0.0, 0.119, 0.00921), (1.0, 0.0, 0.0),
        0.0, 2.35619, 114.0,
    ),
    Joint(
        "arm_wry", "larm", "farm", (0.0, 0.187, -0.00921), (0.0, 1.0, 0.0),
        0.0, 3.14159, 114.0,
    ),
    Joint(
        "arm_wrx", "farm", "hand", (0.0, 0.119, 0.00921), (1.0, 0.0, 0.0),
        -1.1781, 1.1781, 60.0,
    ),
)  # fmt: skip

LIMB_LINKS = tuple(joint.child for joint in _LEFT_LEG + _LEFT_ARM)
"""Names of the links that exist on both sides, without the `l_` or `r_`."""


def _limb(side: str, joints: tuple[Joint, ...]) -> tuple[Joint, ...]:
    def on_side(link: str) -> str:
        return f"{side}_{link}" if link in LIMB_LINKS else link

    sided = (mirror_joint(joint) for joint in joints) if side == "r" else iter(joints)
    return tuple(
        replace(
            joint,
            name=f"{side}_{joint.name}",
            parent=on_side(joint.parent),
            child=on_side(joint.child),
        )
        for joint in sided
    )


JOINTS = (
    *_TRUNK,
    *_limb("l", _LEFT_LEG),
    *_limb("r", _LEFT_LEG),
    *_limb("l", _LEFT_ARM),
    *_limb("r", _LEFT_ARM),
)
"""All 28 joints, in the order in which Atlas messages count them."""

LINKS = ("pelvis", *(joint.child for joint in JOINTS))
"""All 29 links, the floating base first."""


@dataclass(frozen=True)
class Frame:
    """Frame fixed to a link, at `xyz` [m] turned by `rpy` [rad]."""

    name: str
    link: str
    xyz: Vector
    rpy: Vector = ZERO


_QUARTER_TURN = 1.57079633
_CAMERA_SPLAY = 1.30899694

CAMERAS = (
    Frame(
        "r_situational_awareness_camera_link", "utorso",
        (0.216409, -0.121799, 0.406759), (_QUARTER_TURN, 0.0, -_CAMERA_SPLAY),
    ),
    Frame(
        "l_situational_awareness_camera_link", "utorso",
        (0.216409, 0.121799, 0.406759), (-_QUARTER_TURN, 0.0, _CAMERA_SPLAY),
    ),
    Frame(
        "rear_situational_awareness_camera_link", "utorso",
        (-0.0026, 0.0264, 0.6649), (0.0, 0.0, 3.14159),
    ),
)  # fmt: skip
"""Cameras on the chest. They are frames only: their mass is part of the chest's."""

FRAMES = (
    Frame("imu", "pelvis", IMU_POSITION),
    Frame("l_sole", "l_foot", SOLE_CENTER),
    Frame("r_sole", "r_foot", SOLE_CENTER),
    *CAMERAS,
)
"""Frames that the URDF files name beside those of the links."""
