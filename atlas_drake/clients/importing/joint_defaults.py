"""Default gains and rotor inertias of joints, by mass and height of the robot."""

from __future__ import annotations

import math

from atlas_drake.clients.importing.findings import GUESSED, Findings
from atlas_drake.robot import LEGS, Leg, RobotFile
from atlas_drake.units import GRAVITY

LEG_GAINS = {
    "hip": 1.5,
    "hip pitch": 2.7,
    "knee": 2.7,
    "ankle": 1.5,
    "ankle pitch": 2.0,
}
LIMB_GAINS = {"back": 1.3, "neck": 0.05, "arm": 0.3, "hand": 0.02}
"""Default position gains, in weights times heights of the center of mass [1/rad]."""
DAMPING = 0.02
"""Default derivative gain per position gain and root of the height [s/√m]."""
LEG_INERTIA, OTHER_INERTIA = 1.2e-4, 1e-5
"""Least inertia about a joint of a leg, that of Atlas' ankle roll, and of others, per
mass and squared height of the center of mass [-]. With 1e-4, R1 fell in 2 of 200
disturbed starts, with 1.2e-4 in none."""
SLOWEST_TICK = 0.009
"""Control period with which a derivative gain must be stable [s]."""


def rotor_inertias(
    file: RobotFile, scale: float, inertias: list[float], findings: Findings
) -> dict[str, float]:
    """Returns rotor inertias for joints that turn hardly any inertia [kg·m²].

    URDF files have the links' inertias only. A foot that is light without its motors
    spins by tens of rad/s before the ground that the controller counts on is there.
    """
    found = {}
    for joint, inertia in zip(file.joints, inertias, strict=True):
        share = LEG_INERTIA if joint.limb in LEGS else OTHER_INERTIA
        if inertia < share * scale:
            found[joint.name] = share * scale - inertia
    if found:
        least, most = min(found.values()), max(found.values())
        findings.add_about(
            list(found),
            GUESSED,
            f"rotor inertia of {least:.1g} to {most:.1g} kg·m², as the links alone are "
            "too light",
        )
    return found


def default_gains(
    file: RobotFile,
    legs: tuple[Leg, Leg],
    mass: float,
    height: float,
    inertias: list[float],
) -> list[tuple[float, float]]:
    """Returns default kp and kd of each joint.

    They hold the stand-prep pose; a light link has no more than a slow tick bears.
    """
    scale = GRAVITY * mass * height
    per_kp = DAMPING * math.sqrt(height)
    roles: dict[int, str] = {}
    for leg in legs:
        roles |= dict.fromkeys(leg.joints[:3].tolist(), "hip")
        roles |= dict.fromkeys(leg.joints[4:].tolist(), "ankle")
        roles |= {
            leg.hip_pitch: "hip pitch",
            leg.knee: "knee",
            leg.ankle_pitch: "ankle pitch",
        }
    gains = []
    for place, (entry, inertia) in enumerate(zip(file.joints, inertias, strict=True)):
        if place in roles:
            kp = LEG_GAINS[roles[place]] * scale
        else:
            kind = entry.limb.removeprefix("l_").removeprefix("r_")
            most = 0.5 * inertia / SLOWEST_TICK / per_kp
            kp = min(LIMB_GAINS[kind] * scale, most)
        gains.append((kp, per_kp * kp))
    return gains
