"""Mends what no robot can have: virtual roots, joints without motors, no limits.

Each repair is a finding. What decides whether the robot can stand is not repaired here
but refused where it is found.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import yourdfpy.urdf as urdf

from atlas_drake.clients.importing.findings import (
    GUESSED,
    LOST,
    REPAIRED,
    Findings,
    ImportRefused,
    listed,
)
from atlas_drake.clients.importing.tree import MOTIONS, MOVING, Tree
from atlas_drake.units import GRAVITY

LARGEST_EFFORT, LARGEST_SPEED = 1e5, 1e3
"""Limits that no motor has [N·m], [rad/s]: files say so for "not known"."""
USUAL_SPEED = 10.0
"""Velocity limit where a file has none [rad/s]."""
USUAL_EFFORT = 0.3
"""Effort limit where a file has none, per weight: Atlas' knee has 0.25 [m]."""
USUAL_DAMPING = 1e-3
"""Damping where a file has none, per effort limit [s/rad]: Atlas' joints have 0.1
N·m·s/rad. Without any, soles of JVRC-1 that landed tilted chattered."""


def drop_virtual_root(tree: Tree, findings: Findings) -> None:
    """Makes the first link below ``world`` or a floating joint the root.

    It is turned as it was in the dropped link. Of several links on ``world`` that with
    the most moving joints is the robot.
    """
    while True:
        root = tree.root
        joints = tree.below(root)
        floats = len(joints) == 1 and joints[0].type == "floating"
        if not joints or not (root == "world" or floats):
            return
        kept, *others = sorted(
            joints, key=lambda joint: -len(tree.all_moving_below(joint.child))
        )
        gone = [root, *(link for one in others for link in tree.all_below(one.child))]
        for link in gone:
            for joint in tree.below(link):
                del tree.joints[joint.name]
            del tree.links[link]
        tree.index()
        turn_root(tree, kept.origin[:3, :3])
        findings.add(
            REPAIRED, f"no parts of the robot, dropped: {kept.name}, {listed(gone)}"
        )


def drop_shapes(tree: Tree, findings: Findings) -> None:
    """Takes away shapes of which one size is 0: Drake has none of them."""
    dropped = []
    for link in tree.links.values():
        before = len(link.visuals) + len(link.collisions)
        for shapes in (link.visuals, link.collisions):
            shapes[:] = [shape for shape in shapes if shape.geometry.has_size]
        if len(link.visuals) + len(link.collisions) < before:
            dropped.append(link.name)
    findings.add_about(dropped, LOST, "shapes with a size of 0")


def fix_joints(tree: Tree, named: Iterable[str], findings: Findings) -> None:
    """Makes joints fixed that have no motor of their own, and those of the user."""
    reasons: dict[str, list[str]] = {}
    for name in named:
        if name not in tree.joints:
            raise ImportRefused(f"--fix {name}: there is no such joint")
        reasons.setdefault("as asked", []).append(name)
        fix(tree, tree.joints[name])
    for joint in tree.joints.values():
        reason = ""
        if joint.type not in (*MOVING, "fixed"):
            reason = f"as {joint.type} is not simulated"
        elif joint.type != "fixed" and joint.mimic is not None:
            reason = "as they mimic another joint"
        elif joint.type == "revolute":
            lower, upper = tree.limits(joint)
            if joint.limit is None or lower == upper:
                reason = "as they have no range"
        if reason:
            reasons.setdefault(reason, []).append(joint.name)
            fix(tree, joint)
    for reason, names in reasons.items():
        findings.add_about(names, REPAIRED, f"fixed {reason}")


def fix(tree: Tree, joint: Any) -> None:
    """Makes a joint fixed, at the position within its limits that is nearest to zero.

    A joint that mimics another one is fixed where it is with the other one at zero.
    """
    if joint.type in MOTIONS:
        lower, upper = tree.limits(joint)
        at = 0.0 if joint.mimic is None else float(joint.mimic.offset or 0.0)
        at = min(max(at, lower), upper)
        if at:
            poses = tree.poses({joint.name: at})
            joint.origin = np.linalg.inv(poses[joint.parent]) @ poses[joint.child]
    joint.type, joint.mimic, joint.limit, joint.dynamics = "fixed", None, None, None


def turn_root(tree: Tree, R_NR: np.ndarray) -> None:
    """Gives the root a new frame N, in which the old frame R has the rotation R_NR."""
    X = np.eye(4)
    X[:3, :3] = R_NR
    root = tree.links[tree.root]
    shapes = [*root.visuals, *root.collisions]
    if root.inertial is not None:
        shapes.append(root.inertial)
    for part in (*shapes, *tree.below(root.name)):
        part.origin = X @ part.origin


def repair_limits(tree: Tree, findings: Findings) -> None:
    """Gives moving joints limits of range, speed and effort where they have none."""
    effort = USUAL_EFFORT * GRAVITY * tree.mass_of(list(tree.links))
    guessed: dict[str, list[str]] = {}
    rubs = []
    for joint in tree.joints.values():
        if not tree.moves(joint):
            continue
        lower, upper = tree.limits(joint)
        if lower > upper:
            raise ImportRefused(
                f"joint {joint.name}: goes from {lower:g} to {upper:g} rad, backward"
            )
        limit = joint.limit or urdf.Limit()
        limit.lower, limit.upper = lower, upper
        if not 0.0 < float(limit.effort or 0.0) < LARGEST_EFFORT:
            limit.effort = round(effort, 1)
            guessed.setdefault(f"effort limit {effort:.0f} N·m", []).append(joint.name)
        if not 0.0 < float(limit.velocity or 0.0) < LARGEST_SPEED:
            limit.velocity = USUAL_SPEED
            text = f"velocity limit {USUAL_SPEED:g} rad/s"
            guessed.setdefault(text, []).append(joint.name)
        joint.limit, joint.type = limit, "revolute"
        if float(getattr(joint.dynamics, "friction", None) or 0.0):
            rubs.append(joint.name)
        if not float(getattr(joint.dynamics, "damping", None) or 0.0):
            joint.dynamics = urdf.Dynamics(damping=USUAL_DAMPING * limit.effort)
            text = f"damping of {USUAL_DAMPING:g} s/rad of the effort limit"
            guessed.setdefault(text, []).append(joint.name)
    for text, names in guessed.items():
        text = f"{text}, where the file has none or 0"
        findings.add_about(names, GUESSED, text)
    findings.add_about(rubs, LOST, "friction of joints, not simulated")
