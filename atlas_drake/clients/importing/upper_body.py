"""Which joints belong to back, neck and arms, and which links are chest and hands."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from atlas_drake.clients.importing.findings import (
    FOUND,
    Findings,
    ImportRefused,
    listed,
)
from atlas_drake.clients.importing.options import ImportOptions
from atlas_drake.clients.importing.tree import Tree
from atlas_drake.robot import LEGS

MOST_ARM_JOINTS = 7
"""Joints of an arm; what is beyond them is the hand."""
ASIDE = 0.08
"""Least distance of an arm from the middle, in heights of the chest above the feet
[-]; what is nearer is a neck."""
TRUNK_SHARE = 0.6
"""A branch with this share of the joints above the pelvis or more is the trunk [-]."""


def find_upper_body(
    tree: Tree,
    limbs: dict[str, str],
    foot: str,
    options: ImportOptions,
    findings: Findings,
) -> tuple[str, tuple[str, ...]]:
    """Finds back, chest, neck, arms and hands; returns the links of chest and hands.

    ``limbs`` has the joints of the legs, and gets the others; ``foot`` is one of the
    feet's links.
    """
    poses = tree.poses()
    chest, branches = tree.root, _branches(tree, tree.root, limbs)
    while branches:
        sizes = [_size(tree, joint) for joint in branches]
        largest = branches[sizes.index(max(sizes))]
        if max(sizes) < TRUNK_SHARE * sum(sizes) or _is_limb(tree, largest, poses):
            break
        limbs[largest.name] = "back"
        chest = largest.child
        beside = [joint for joint in branches if joint is not largest]
        branches = [*_branches(tree, chest, limbs), *beside]
    if options.chest is not None:
        trunk = [tree.root, *(tree.joints[name].child for name in limbs
                              if limbs[name] == "back")]  # fmt: skip
        chest = tree.body_named("chest", options.chest)
        if chest not in trunk:
            raise ImportRefused(
                f"--chest {options.chest}: is no link of the trunk, {listed(trunk)}"
            )
    height = abs(poses[chest][2, 3] - poses[foot][2, 3])
    ends: dict[str, str] = {}
    # A lamp or a camera beside an arm is smaller than the arm.
    for joint in sorted(branches, key=lambda joint: _extent(tree, joint), reverse=True):
        farthest = max(_sides(tree, joint, poses), key=abs)
        limb = "neck"
        if abs(farthest) > ASIDE * height:
            limb = "l_arm" if farthest > 0.0 else "r_arm"
        if limb in ends:
            continue
        ends[limb] = _name_chain(tree, joint, limb, limbs, options.fingers)
    hands: tuple[str, ...] = ()
    if options.hands is not None:
        hands = _hands(tree, limbs, options.hands)
    elif {"l_arm", "r_arm"} <= ends.keys():
        hands = ends["l_arm"], ends["r_arm"]
    else:
        findings.add(FOUND, "no pair of arms")
    counts = Counter(limb for limb in limbs.values() if limb not in LEGS)
    others = ", ".join(f"{limb} of {count}" for limb, count in counts.items())
    findings.add(FOUND, f"chest {chest}, {others or 'no other joints'}")
    return chest, hands


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
    return 1 + len(tree.all_moving_below(joint.child))


def _extent(tree: Tree, joint: Any) -> tuple[int, float]:
    """Returns the number of joints and the mass of a branch [kg]."""
    return _size(tree, joint), tree.mass_of(list(tree.all_below(joint.child)))


def _sides(tree: Tree, joint: Any, poses: dict[str, np.ndarray]) -> list[float]:
    """Returns how far to the left the links of a branch are [m]."""
    return [float(poses[link][1, 3]) for link in tree.all_below(joint.child)]


def _is_limb(tree: Tree, joint: Any, poses: dict[str, np.ndarray]) -> bool:
    """Returns True for a chain without branches to both sides: a neck or an arm."""
    sides = _sides(tree, joint, poses)
    both_sides = min(sides) < 0.0 < max(sides)
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
    below = [joint]
    for _ in range(MOST_ARM_JOINTS):
        if len(below) != 1:
            break
        (joint,) = below
        limbs[joint.name] = limb
        below = tree.moving_below(joint.child)
    if fingers and limb.endswith("arm"):
        hand = limb.replace("arm", "hand")
        beyond = tree.all_moving_below(joint.child)
        limbs |= dict.fromkeys((finger.name for finger in beyond), hand)
    return str(joint.child)
