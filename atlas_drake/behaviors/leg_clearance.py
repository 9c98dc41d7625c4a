"""Distance of the feet at which a robot's legs pass each other."""

from __future__ import annotations

import functools
from itertools import product

import numpy as np

from atlas_drake.behaviors.scaling import CLEARANCE
from atlas_drake.control.feet.leg_kinematics import leg_solver
from atlas_drake.robot import Robot
from atlas_drake.robot.leg import KNEE
from atlas_drake.robot.shapes import shapes_of
from atlas_drake.rotations import rotation_z

RAISED = (0.0, 0.03)
"""Heights of a foot beside the other one, in heights of the center of mass [-]."""


def pelvis_to_feet(robot: Robot) -> np.ndarray:
    """Computes the way from the pelvis to the middle of both soles, in P [m].

    The robot is in its stand-prep pose.
    """
    plant, context = robot.plant, robot.standing_context()
    pelvis = plant.GetFrameByName(robot.file.pelvis)
    soles = [
        plant.GetFrameByName(foot.sole_frame).CalcPose(context, pelvis).translation()
        for foot in robot.file.feet
    ]
    ahead, _, below = np.mean(soles, axis=0)
    return np.array([ahead, 0.0, below])


@functools.lru_cache(maxsize=8)
def leg_clearance(robot: Robot) -> LegClearance:
    """Returns the clearance of a robot's legs; cached, as it looks at all shapes."""
    return LegClearance(robot)


class LegClearance:
    """Whether the shapes of both legs stay apart with one foot beside the other."""

    def __init__(self, robot: Robot):
        shapes = shapes_of(robot)
        plant, inspector = shapes.plant, shapes.scene_graph.model_inspector()
        self._plant, self._context = plant, shapes.context()
        self._robot = robot
        self._p_PM = pelvis_to_feet(robot)
        self._legs = [(leg, leg_solver(leg)) for leg in robot.legs]
        self._places = robot.indices(robot.plant).q
        left, right = (
            [
                shape
                # Of the shank and the foot: thighs are as far apart as the hips.
                for joint in leg.joints[KNEE:]
                for link in robot.moved_links[joint]
                for shape in plant.GetCollisionGeometriesForBody(
                    plant.GetBodyByName(link)
                )
                # Those in the place of which the sole came have no role.
                if inspector.GetProximityProperties(shape) is not None
            ]
            for leg in robot.legs
        )
        self._pairs = [
            pair
            for pair in product(left, right)
            if not inspector.CollisionFiltered(*pair)
        ]

    def __call__(self, apart: float, turn: float = 0.0) -> bool:
        """Returns True if the legs stay apart, with either foot above the other.

        Args:
            apart: Distance between the soles' middles [m].
            turn: Of the raised foot against the other one, outward [rad].
        """
        height = self._robot.com_height
        return all(
            self._distance(foot, apart, raised * height, turn) >= CLEARANCE * height
            for foot in (0, 1)
            for raised in RAISED
        )

    def _distance(self, foot: int, apart: float, raised: float, turn: float) -> float:
        q = self._robot.stand_prep.copy()
        for number, (leg, solve) in enumerate(self._legs):
            side = 1.0 if number == 0 else -1.0
            height = raised if number == foot else 0.0
            p_PF = self._p_PM + np.array([0.0, 0.5 * side * apart, height])
            # The pelvis turns by half of the turn.
            pose = solve(p_PF, rotation_z(0.5 * side * turn), None)
            if pose is None:  # Out of reach, which is not a matter of the shapes.
                return np.inf
            q[leg.joints] = pose.angles
        positions = self._plant.GetPositions(self._context)
        positions[self._places] = q
        self._plant.SetPositions(self._context, positions)
        query = self._plant.get_geometry_query_input_port().Eval(self._context)
        return min(
            (
                query.ComputeSignedDistancePairClosestPoints(*pair).distance
                for pair in self._pairs
            ),
            default=np.inf,
        )
