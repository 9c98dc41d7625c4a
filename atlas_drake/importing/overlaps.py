"""Shapes of a robot that overlap: arms are moved away, other pairs do not touch."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.importing.findings import GUESSED, REPAIRED, Findings
from atlas_drake.importing.repairs import listed
from atlas_drake.robot import RobotFile
from atlas_drake.robot.parsing import parse

OVERLAP = 1e-5
"""Depth from which shapes overlap [m]."""
NEAR_JOINTS, SAMPLES, SPREAD = 3, 30, 0.3
"""Links this many joints apart at most are also compared in random poses about the
stand-prep pose, so many and so far [rad]: hulls of hips and thighs overlap when they
turn."""
SPREADS = (0.15, 0.3, 0.45, 0.6)
"""Turns of a shoulder's joints that are tried to clear the arm of the legs [rad]."""
SHOULDER = 3


class Shapes:
    """A robot's collision shapes in any pose."""

    def __init__(self, urdf: Path, file: RobotFile) -> None:
        """Parses the robot."""
        builder = DiagramBuilder()
        self.plant: Any = AddMultibodyPlantSceneGraph(builder, time_step=0.0)[0]
        parse(self.plant, urdf)
        self.plant.Finalize()
        self._root = builder.Build().CreateDefaultContext()
        self._context = self.plant.GetMyMutableContextFromRoot(self._root)
        self.joints = [self.plant.GetJointByName(joint.name) for joint in file.joints]
        self.lower = np.array([j.position_lower_limit() for j in self.joints])
        self.upper = np.array([j.position_upper_limit() for j in self.joints])

    def inside(self, pose: np.ndarray) -> Iterable[tuple[Any, Any, float]]:
        """Yields pairs of bodies that overlap, by name, with their depth [m]."""
        for joint, angle in zip(self.joints, pose, strict=True):
            joint.set_angle(self._context, angle)
        query = self.plant.get_geometry_query_input_port().Eval(self._context)
        for pair in query.ComputePointPairPenetration():
            frames = map(query.inspector().GetFrameId, (pair.id_A, pair.id_B))
            bodies = map(self.plant.GetBodyFromFrameId, frames)
            one, other = sorted(bodies, key=lambda body: str(body.name()))
            if pair.depth > OVERLAP:
                yield one, other, pair.depth

    def moved_by(self, body: Any) -> set[int]:
        """Returns the joints that move a body, by their places in message order."""
        return {
            place
            for place, joint in enumerate(self.joints)
            if body.index()
            in self.plant.GetBodiesKinematicallyAffectedBy([joint.index()])
        }


def clear_arms(urdf: Path, file: RobotFile, findings: Findings) -> RobotFile:
    """Returns the file with shoulders turned so that no arm is inside a leg."""
    shapes = Shapes(urdf, file)
    pose = np.array([joint.stand_prep for joint in file.joints])
    limbs = [joint.limb for joint in file.joints]
    legs = {place for place, limb in enumerate(limbs) if limb.endswith("leg")}
    for arm in ("l_arm", "r_arm"):
        places = [place for place, limb in enumerate(limbs) if limb == arm]

        def depth(tried: np.ndarray, own: frozenset[int] = frozenset(places)) -> float:
            found = 0.0
            for one, other, deep in shapes.inside(tried):
                a, b = shapes.moved_by(one), shapes.moved_by(other)
                if (a & own and b & legs) or (b & own and a & legs):
                    found += deep
            return found

        if not places or depth(pose) == 0.0:
            continue
        for turn, place, sign in itertools.product(
            SPREADS, places[:SHOULDER], (1.0, -1.0)
        ):
            tried = pose.copy()
            tried[place] += sign * turn
            within = shapes.lower[place] <= tried[place] <= shapes.upper[place]
            if within and depth(tried) == 0.0:
                name = file.joints[place].name
                findings.add(
                    GUESSED, f"{name} at {tried[place]:.2f} rad clears the arm of a leg"
                )
                pose = tried
                break
    joints = [
        replace(joint, stand_prep=round(float(angle), 5))
        for joint, angle in zip(file.joints, pose, strict=True)
    ]
    return replace(file, joints=joints)


def overlapping(urdf: Path, file: RobotFile, findings: Findings) -> list[list[str]]:
    """Returns pairs of links whose shapes overlap, in or near the stand-prep pose."""
    shapes = Shapes(urdf, file)
    pose = np.array([joint.stand_prep for joint in file.joints])
    random = np.random.default_rng(0)
    found: dict[tuple[str, str], float] = {}
    for sample in range(SAMPLES):
        spread = SPREAD * (sample > 0)
        turned = pose + random.uniform(-spread, spread, len(pose))
        for one, other, depth in shapes.inside(
            np.clip(turned, shapes.lower, shapes.upper)
        ):
            between = len(shapes.moved_by(one) ^ shapes.moved_by(other))
            if sample == 0 or between <= NEAR_JOINTS:
                pair = (str(one.name()), str(other.name()))
                found[pair] = max(depth, found.get(pair, 0.0))
    if found:
        pairs = [f"{a}/{b} {1e3 * d:.0f} mm" for (a, b), d in found.items()]
        findings.add(
            REPAIRED,
            f"{len(found)} pairs of shapes overlap, and do not touch: {listed(pairs)}",
        )
    return [list(pair) for pair in sorted(found)]
