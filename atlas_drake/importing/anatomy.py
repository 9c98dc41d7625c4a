"""Which links are pelvis, chest, feet and hands, and which joints belong to which limb.

Found from the tree, the masses and the shape of the robot with all joints at zero.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake.importing.findings import (
    FOUND,
    GUESSED,
    REPAIRED,
    Findings,
    ImportRefused,
)
from atlas_drake.importing.options import HEADINGS, ImportOptions
from atlas_drake.importing.repairs import fix, listed, turn_root
from atlas_drake.importing.tree import Tree
from atlas_drake.robot import LEGS, LIMBS
from atlas_drake.robot.leg import KNEE, NUM_JOINTS
from atlas_drake.rotations import rotation_z

MOST_ARM_JOINTS = 7
"""Joints of an arm; what is beyond them is the hand."""
LEAST_LEG = 3
"""Joints from which a limb is taken for a leg, to say what it lacks."""
EVEN = 0.3
"""Sum of a knee's limits, in their distance, up to which its range does not tell how it
bends [-]."""
STRAIGHT = math.radians(1.0)
"""Angle from an axis up to which the robot faces along it [rad]."""
BENT = 0.5
"""Bend of the knee that shows where the robot faces [rad]."""
ASIDE = 0.08
"""Least distance of an arm from the middle, in heights of the chest above the feet
[-]; what is nearer is a neck."""
TRUNK_SHARE = 0.6
"""Share of the joints above the pelvis from which a branch is the trunk [-]."""


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
    anatomy = Anatomy(tree.root, tree.root, (feet[0], feet[1]), (), limbs)
    _find_upper_body(tree, anatomy, options, findings)
    loose = [
        joint
        for joint in tree.joints.values()
        if tree.moves(joint) and joint.name not in limbs
    ]
    for joint in loose:
        fix(tree, joint)
    if loose:
        names = listed([joint.name for joint in loose])
        findings.add(REPAIRED, f"fixed as part of a hand, or of no limb: {names}")
    anatomy.limbs = {
        name: limb for one in LIMBS for name, limb in limbs.items() if limb == one
    }
    return anatomy


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
    fixed = []
    while legs[0] and legs[1] and legs[0][0] is legs[1][0]:
        joint = legs[0].pop(0)
        legs[1].pop(0)
        fix(tree, joint)
        fixed.append(joint.name)
    if fixed:
        between = f"fixed, between the root and the legs: {listed(fixed)}"
        findings.add(REPAIRED, between)


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


def _find_upper_body(
    tree: Tree, anatomy: Anatomy, options: ImportOptions, findings: Findings
) -> None:
    """Finds back, chest, neck, arms and hands."""
    limbs, poses = anatomy.limbs, tree.poses()
    chest, branches = tree.root, _branches(tree, tree.root, limbs)
    while branches:
        sizes = [_size(tree, joint) for joint in branches]
        largest = int(np.argmax(sizes))
        trunk = branches[largest]
        if sizes[largest] < TRUNK_SHARE * sum(sizes) or _is_limb(tree, trunk, poses):
            break
        limbs[trunk.name] = "back"
        chest = trunk.child
        beside = [joint for joint in branches if joint is not trunk]
        branches = [*_branches(tree, chest, limbs), *beside]
    if options.chest is not None:
        trunk = [tree.root, *(tree.joints[name].child for name in limbs
                              if limbs[name] == "back")]  # fmt: skip
        chest = tree.body_named("chest", options.chest)
        if chest not in trunk:
            raise ImportRefused(
                f"--chest {options.chest}: is no link of the trunk, {listed(trunk)}"
            )
    anatomy.chest = chest
    height = abs(poses[chest][2, 3] - poses[anatomy.feet[0]][2, 3])
    ends: dict[str, str] = {}
    # A lamp or a camera beside an arm is smaller than the arm.
    for joint in sorted(branches, key=lambda joint: _extent(tree, joint), reverse=True):
        places = [poses[link][1, 3] for link in tree.all_below(joint.child)]
        farthest = max(places, key=abs)
        limb = "neck"
        if abs(farthest) > ASIDE * height:
            limb = "l_arm" if farthest > 0.0 else "r_arm"
        if limb in ends:
            continue
        ends[limb] = _name_chain(tree, joint, limb, limbs, options.fingers)
    arms = [limb for limb in ("l_arm", "r_arm") if limb in ends]
    if options.hands is not None:
        anatomy.hands = _hands(tree, limbs, options.hands)
    elif len(arms) == 2:
        anatomy.hands = tuple(ends[limb] for limb in arms)
    else:
        findings.add(FOUND, "no pair of arms")
    counts = {
        limb: sum(one == limb for one in limbs.values())
        for limb in dict.fromkeys(limbs.values())
        if not limb.endswith("leg")
    }
    others = ", ".join(f"{limb} of {count}" for limb, count in counts.items())
    findings.add(FOUND, f"chest {chest}, {others or 'no other joints'}")


def _hands(
    tree: Tree, limbs: dict[str, str], named: tuple[str, str]
) -> tuple[str, ...]:
    """Returns the links of the left and the right hand, named in any order."""
    bodies = {}
    for name in named:
        body = tree.body_named("hands", name)
        for joint in tree.chain(body):
            bodies[limbs.get(joint.name)] = body
    if not {"l_arm", "r_arm"} <= set(bodies):
        raise ImportRefused(f"--hands {' '.join(named)}: are not on both arms")
    return bodies["l_arm"], bodies["r_arm"]


def _branches(tree: Tree, link: str, limbs: dict[str, str]) -> list[Any]:
    return [joint for joint in tree.moving_below(link) if joint.name not in limbs]


def _size(tree: Tree, joint: Any) -> int:
    return 1 + len(_all_moving(tree, joint.child))


def _extent(tree: Tree, joint: Any) -> tuple[int, float]:
    """Returns the number of joints and the mass of a branch [kg]."""
    return _size(tree, joint), tree.mass_of(list(tree.all_below(joint.child)))


def _is_limb(tree: Tree, joint: Any, poses: dict[str, np.ndarray]) -> bool:
    """Returns True for a chain without branches to both sides: a neck or an arm."""
    places = [poses[link][1, 3] for link in tree.all_below(joint.child)]
    both_sides = min(places) < 0.0 < max(places)
    return _size(tree, joint) <= MOST_ARM_JOINTS and not (
        both_sides and len(_forks(tree, joint)) > 1
    )


def _forks(tree: Tree, joint: Any) -> list[Any]:
    """Returns the joints at which a chain first branches."""
    below = tree.moving_below(joint.child)
    return _forks(tree, below[0]) if len(below) == 1 else below


def _name_chain(
    tree: Tree, joint: Any, limb: str, limbs: dict[str, str], fingers: bool
) -> str:
    """Gives the joints of a chain their limb; returns the link at its end."""
    limbs[joint.name] = limb
    for _ in range(MOST_ARM_JOINTS - 1):
        below = tree.moving_below(joint.child)
        if len(below) != 1:
            break
        joint = below[0]
        limbs[joint.name] = limb
    if fingers and limb.endswith("arm"):
        hand = limb.replace("arm", "hand")
        for name in (j.name for j in _all_moving(tree, joint.child)):
            limbs[name] = hand
    return str(joint.child)


def _all_moving(tree: Tree, link: str) -> list[Any]:
    found = []
    for joint in tree.moving_below(link):
        found += [joint, *_all_moving(tree, joint.child)]
    return found
