"""Shapes of a robot that overlap: arms are moved away, other pairs do not touch."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.clients.importing.findings import GUESSED, REPAIRED, Findings
from atlas_drake.robot import RobotFile
from atlas_drake.robot.parsing import parse

OVERLAP = 1e-5
"""Depth from which shapes overlap [m]."""
NEAR_JOINTS, SAMPLES, SPREAD = 4, 30, 0.3
"""Links that are at most ``NEAR_JOINTS`` joints apart are also compared in ``SAMPLES``
random poses, whose joints differ from the stand-prep pose by at most ``SPREAD`` [rad]:
hulls of hips and thighs overlap when they turn."""
SPREADS = (0.15, 0.3, 0.45, 0.6)
"""Turns of a shoulder's joints that are tried to clear the arms [rad]."""
APART = 0.6
"""Distance of forearms and hands from the body in the stand-prep pose, in sizes of the
sole: some 10 cm for a robot of Atlas' size [-]. With half of it hands touched the
thighs in catches: iCub bore 8 of 20 pushes from the side, and then 17."""
SHOULDER = 3
"""Joints of a shoulder; what is beyond them is elbow, forearm and hand."""


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
        self._moved = [
            set(self.plant.GetBodiesKinematicallyAffectedBy([joint.index()]))
            for joint in self.joints
        ]
        self.apart = APART * math.sqrt(file.sole.length * file.sole.width)

    def _put(self, pose: np.ndarray) -> None:
        for joint, angle in zip(self.joints, pose, strict=True):
            joint.set_angle(self._context, angle)

    def _bodies(self, query: Any, pair: Any) -> list[Any]:
        """Returns the bodies of the two shapes of a pair."""
        frames = map(query.inspector().GetFrameId, (pair.id_A, pair.id_B))
        return [self.plant.GetBodyFromFrameId(frame) for frame in frames]

    def inside(self, pose: np.ndarray) -> Iterable[tuple[Any, Any, float]]:
        """Yields pairs of bodies that overlap, by name, with their depth [m]."""
        self._put(pose)
        query = self.plant.get_geometry_query_input_port().Eval(self._context)
        for pair in query.ComputePointPairPenetration():
            bodies = self._bodies(query, pair)
            one, other = sorted(bodies, key=lambda body: str(body.name()))
            if pair.depth > OVERLAP:
                yield one, other, pair.depth

    def clearance(self, pose: np.ndarray, arm: list[int]) -> float:
        """Returns the least distance of forearm and hand from the rest of the body [m].

        ``arm`` are the places of its joints; distances above ``apart`` count as that.
        """
        self._put(pose)
        own = set().union(*(self._moved[place] for place in arm))
        far = set().union(*(self._moved[place] for place in arm[SHOULDER:]))
        query = self.plant.get_geometry_query_input_port().Eval(self._context)
        least = self.apart
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(self.apart):
            one, other = (body.index() for body in self._bodies(query, pair))
            if (one in far and other not in own) or (other in far and one not in own):
                least = min(least, float(pair.distance))
        return least

    def joints_between(self, one: Any, other: Any) -> int:
        """Returns the number of joints that move one body and not the other."""
        return sum(
            (one.index() in bodies) != (other.index() in bodies)
            for bodies in self._moved
        )


def clear_arms(shapes: Shapes, file: RobotFile, findings: Findings) -> RobotFile:
    """Returns the file with shoulders turned so that the arms swing free.

    Forearms and hands keep a distance from legs and trunk, if one joint of the shoulder
    can do it: the one with the least turn, or that which comes nearest to it.
    """
    pose = np.array([joint.stand_prep for joint in file.joints])
    for arm in ("l_arm", "r_arm"):
        places = [k for k, joint in enumerate(file.joints) if joint.limb == arm]
        clearance = shapes.clearance(pose, places)
        best, name = pose, ""
        for turn, place, sign in itertools.product(
            SPREADS, places[:SHOULDER], (1.0, -1.0)
        ):
            if clearance >= shapes.apart:
                break
            tried = pose.copy()
            tried[place] += sign * turn
            if shapes.lower[place] <= tried[place] <= shapes.upper[place]:
                wider = shapes.clearance(tried, places)
                if wider > clearance + 1e-3 * shapes.apart:
                    clearance, best = wider, tried
                    name = f"{file.joints[place].name} at {tried[place]:.2f} rad"
        if name:
            findings.add(GUESSED, f"{name} keeps the arm clear of the body")
        pose = best
    joints = [
        replace(joint, stand_prep=round(float(angle), 5))
        for joint, angle in zip(file.joints, pose, strict=True)
    ]
    return replace(file, joints=joints)


def overlapping(shapes: Shapes, file: RobotFile, findings: Findings) -> list[list[str]]:
    """Returns pairs of links whose shapes overlap, in or near the stand-prep pose."""
    pose = np.array([joint.stand_prep for joint in file.joints])
    random = np.random.default_rng(0)
    found: dict[tuple[str, str], float] = {}
    for sample in range(SAMPLES):
        spread = SPREAD * (sample > 0)
        turned = pose + random.uniform(-spread, spread, len(pose))
        for one, other, depth in shapes.inside(
            np.clip(turned, shapes.lower, shapes.upper)
        ):
            if sample == 0 or shapes.joints_between(one, other) <= NEAR_JOINTS:
                pair = (str(one.name()), str(other.name()))
                found[pair] = max(depth, found.get(pair, 0.0))
    pairs = [f"{a}/{b} {1e3 * d:.0f} mm" for (a, b), d in found.items()]
    text = f"{len(found)} pairs of shapes overlap, and do not touch"
    findings.add_about(pairs, REPAIRED, text)
    return [list(pair) for pair in sorted(found)]
