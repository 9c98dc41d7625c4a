"""A hand that is told where to be: standing, and on a walk, as a trial."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from atlas_drake import AtlasSimulation, HandGoal, HandWork, reach

PLACES = ((0.38, 0.8), (0.2, 0.9), (-0.5, 0.5))
"""Least and greatest place of a goal: ahead, outward and up of the pelvis, in heights
of the pelvis: clear of the body, some beyond the robot's reach."""
GIVES_WAY = 0.08
"""How far the pelvis may go back as an arm stretches, in heights of the pelvis."""
DURATION, WAY = 2.5, 0.6
"""Of a motion [s]; of the walk [m]."""


def reached(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Sends a hand to a random place, and takes it there on a walk.

    Args:
        sim: A robot that stands.
        parameters: ``seed`` of the place, which is drawn until one can be reached.

    Returns:
        Whether the robot ``stands``; how far the palm is ``off`` at the end of the
        motion [m]; how far at most on a ``walking`` robot from its place at the pelvis
        [m].
    """
    sim.advance(1.0)
    rng = np.random.default_rng(int(parameters["seed"]))
    which = int(rng.integers(2))
    hand, side = sim.robot.file.hands[which], (1.0, -1.0)[which]
    palm, pelvis = np.array(sim.robot.palms[hand]), sim.robot.file.pelvis
    while True:
        x, y, z = (rng.uniform(*ends) for ends in PLACES)
        goal, farther = (
            HandGoal(hand, sim.pelvis_pose @ (sim.robot.pelvis_height * p))
            for p in np.array([[x, side * y, z], [x + GIVES_WAY, side * y, z]])
        )
        if all(
            reach(sim.robot, sim.output("state"), [one]).distances[0] < 1e-3
            for one in (goal, farther)
        ):
            break
    place = np.array(goal.position)
    work = HandWork(sim)
    work.move([goal], DURATION)
    position = sim.frame_pose(hand) @ palm
    at_pelvis = sim.pelvis_pose.inverse() @ position
    walking = [0.0]
    work.move([HandGoal(hand, at_pelvis, frame=pelvis)], 0.5)

    def look(sim: AtlasSimulation) -> None:
        X_PH = sim.pelvis_pose.inverse() @ sim.frame_pose(hand)
        walking.append(float(np.linalg.norm(X_PH @ palm - at_pelvis)))

    sim.hooks.append(look)
    work.walk_to(WAY, 0.0, 0.0)
    return {
        "stands": not sim.has_fallen,
        "off": float(np.linalg.norm(position - place)),
        "walking": max(walking),
    }
