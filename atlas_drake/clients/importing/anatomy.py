"""Which links are pelvis, chest, feet and hands, and which joints belong to which limb.

Found from the tree, the masses and the shape of the robot with all joints at zero.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake.clients.importing.findings import (
    FOUND,
    GUESSED,
    REPAIRED,
    Findings,
    ImportRefused,
    listed,
)
from atlas_drake.clients.importing.options import HEADINGS, ImportOptions
from atlas_drake.clients.importing.repairs import fix, turn_root
from atlas_drake.clients.importing.tree import Tree
from atlas_drake.clients.importing.upper_body import find_upper_body
from atlas_drake.robot import LEGS, LIMBS
from atlas_drake.robot.leg import KNEE, NUM_JOINTS
from atlas_drake.rotations import rotation_z

LEAST_LEG = 3
"""A chain with so many joints is taken for a leg, so that errors say what it lacks."""
EVEN = 0.3
"""A knee's range does not tell how it bends if the sum of its limits is at most this
share of their distance [-]."""
STRAIGHT = math.radians(1.0)
"""Angle from an axis up to which the robot faces along it [rad]."""
BENT = 0.5
"""Bend of the knee that shows where the robot faces [rad]."""


@dataclass
class Anatomy:
    """Links and joints of the limbs; left before right.

    Attributes:
        pelvis: The root link.
        chest: Link that balance keeps upright.
        feet: Links that the soles belong to.
        hands: Links of the hands; empty without arms.
        limbs: Limb by joint.
    """

    pelvis: str
    chest: str
    feet: tuple[str, str]
    hands: tuple[str, ...]
    limbs: dict[str, str]


def find_anatomy(tree: Tree, options: ImportOptions, findings: Findings) -> Anatomy:
    """Finds the limbs; fixes all other joints, and turns the root to face along x."""
    feet = _feet(tree, options)
    legs = [tree.chain(foot) for foot in feet]
    _fix_below_root(tree, legs, findings)
    if not all(legs):
        raise ImportRefused(f"links {feet[0]} and {feet[1]}: are on the same leg")
    _turn(tree, feet, legs, options, findings)
    poses = tree.poses()
    if poses[feet[0]][1, 3] < poses[feet[1]][1, 3]:
        feet, legs = feet[::-1], legs[::-1]
    limbs: dict[str, str] = {}
    for side, limb, leg in zip(("left", "right"), LEGS, legs, strict=True):
        _check_leg(side, leg)
        limbs |= dict.fromkeys((joint.name for joint in leg), limb)
        findings.add(FOUND, f"{side} leg {', '.join(joint.name for joint in leg)}")
    findings.add(FOUND, f"pelvis {tree.root}, feet {feet[0]} and {feet[1]}")
    chest, hands = find_upper_body(tree, limbs, feet[0], options, findings)
    loose = [
        joint
        for joint in tree.joints.values()
        if tree.moves(joint) and joint.name not in limbs
    ]
    for joint in loose:
        fix(tree, joint)
    names = [joint.name for joint in loose]
    findings.add_about(names, REPAIRED, "fixed as part of a hand, or of no limb")
    ordered = {
        name: limb for one in LIMBS for name, limb in limbs.items() if limb == one
    }
    return Anatomy(tree.root, chest, (feet[0], feet[1]), hands, ordered)


def _feet(tree: Tree, options: ImportOptions) -> list[str]:
    """Finds the two lowest ends of chains of moving joints."""
    if options.feet is not None:
        if len(set(options.feet)) == 1:
            raise ImportRefused(f"--feet: both are {options.feet[0]}")
        return _ends_of_legs(
            tree, [tree.body_named("feet", name) for name in options.feet]
        )
    poses = tree.poses()
    ends = []
    for joint in tree.joints.values():
        link = joint.child
        if tree.moves(joint) and not tree.moving_below(link):
            chain = tree.chain(link)
            height = min(float(poses[part][2, 3]) for part in tree.all_below(link))
            if len(chain) >= LEAST_LEG:
                ends.append((height, link, chain))
    ends.sort(key=lambda end: end[0])
    found: list[tuple[str, list[Any]]] = []
    for _, link, chain in ends:
        # Two toes are on the same foot.
        if all(chain[-LEAST_LEG] not in other for _, other in found):
            found.append((link, chain))
        if len(found) == 2:
            break
    lowest = [link for link, _ in found]
    found = [one for one in found if _reaches_down(tree, *one, poses)]
    if len(found) < 2:
        raise ImportRefused(
            "there are no two legs: of the two lowest chains of joints, "
            f"{listed(lowest) or 'none'}, {len(found)} hang down from the pelvis"
        )
    return _ends_of_legs(tree, [link for link, _ in found])


def _reaches_down(
    tree: Tree, link: str, chain: list[Any], poses: dict[str, np.ndarray]
) -> bool:
    """Returns True for a chain that hangs down by half its length or more."""
    places = [poses[joint.child][:3, 3] for joint in chain]
    length = sum(
        float(np.linalg.norm(b - a)) for a, b in itertools.pairwise(places[1:])
    )
    return float(places[0][2] - poses[link][2, 3]) > 0.5 * length


def _ends_of_legs(tree: Tree, ends: list[str]) -> list[str]:
    """Returns the links after the sixth joint from where the two chains part.

    Toes beyond them become parts of the feet.
    """
    chains = [tree.chain(end) for end in ends]
    legs = [[joint for joint in one if joint not in other]
            for one, other in (chains, chains[::-1])]  # fmt: skip
    return [
        str(leg[:NUM_JOINTS][-1].child) if leg else end
        for leg, end in zip(legs, ends, strict=True)
    ]


def _fix_below_root(tree: Tree, legs: list[list[Any]], findings: Findings) -> None:
    """Fixes joints between root and pelvis: the root carries both legs."""
    shared = [joint for joint in legs[0] if joint in legs[1]]
    for joint in shared:
        fix(tree, joint)
    for leg in legs:
        del leg[: len(shared)]
    names = [joint.name for joint in shared]
    findings.add_about(names, REPAIRED, "fixed, between the root and the legs")


def _turn(
    tree: Tree,
    feet: list[str],
    legs: list[list[Any]],
    options: ImportOptions,
    findings: Findings,
) -> None:
    """Turns the root's frame so that the robot faces along x.

    A knee bends toward the larger side of its range, and takes the foot backward.
    """
    if options.faces is not None:
        yaw = math.radians(HEADINGS[options.faces])
    else:
        ahead = np.zeros(2)
        before = tree.poses()
        for foot, leg in zip(feet, legs, strict=True):
            knee = leg[min(KNEE, len(leg) - 1)]
            lower, upper = tree.limits(knee)
            if abs(upper + lower) <= EVEN * (upper - lower):
                continue
            bent = math.copysign(BENT, upper + lower)
            ahead -= (tree.poses({knee.name: bent})[foot] - before[foot])[:2, 3]
        if math.hypot(*ahead) < 1e-3:
            findings.add(GUESSED, "the knees do not tell where it faces: along x")
            return
        yaw, right_angle = math.atan2(ahead[1], ahead[0]), 0.5 * math.pi
        along = right_angle * round(yaw / right_angle)
        if abs(yaw - along) < STRAIGHT:
            yaw = along
    if yaw:
        turn_root(tree, rotation_z(-yaw))
        degrees = f"{math.degrees(yaw):.0f}"
        findings.add(REPAIRED, f"the root faced {degrees}° from x: its frame is turned")


def _check_leg(side: str, leg: list[Any]) -> None:
    if len(leg) != NUM_JOINTS:
        names = ", ".join(joint.name for joint in leg) or "none"
        raise ImportRefused(
            f"the {side} leg has {len(leg)} moving joints ({names}); must have "
            f"{NUM_JOINTS}: three of the hip, the knee, two of the ankle"
        )
