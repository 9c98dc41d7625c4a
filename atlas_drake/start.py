"""How a run begins: the robot on its feet, with the scenario's random changes.

Used once, before time starts; nothing here moves the robot afterwards.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.framework import Context

from atlas_drake.robot import Robot
from atlas_drake.scenario import Scenario
from atlas_drake.terrain import Block, surface_height


@dataclass(frozen=True)
class Variation:
    """Where the robot begins, and one draw of everything that a scenario jitters.

    Attributes:
        position: Of the pelvis, horizontal in W [m], shape (2,).
        rpy: Roll, pitch and yaw of the pelvis [rad], shape (3,).
        joints: Joint positions [rad], shape (n,).
        mass_factor: For each body by name.
        ground_friction: Coefficient.
    """

    position: np.ndarray
    rpy: np.ndarray
    joints: np.ndarray
    mass_factor: dict[str, float]
    ground_friction: float


def draw_variation(scenario: Scenario, robot: Robot) -> Variation:
    """Draws from the scenario's seed."""
    random = np.random.default_rng(scenario.seed)
    jitter = scenario.jitter
    position = random.uniform(-jitter.position, jitter.position, size=2)
    rpy = random.uniform(-jitter.orientation, jitter.orientation, size=3)
    joints = robot.stand_prep + random.uniform(
        -jitter.joints, jitter.joints, size=robot.num_joints
    )
    friction = scenario.ground_friction + random.uniform(
        -scenario.friction_jitter, scenario.friction_jitter
    )
    start = scenario.start
    return Variation(
        position=np.array(start.position) + position,
        rpy=rpy + np.array([0.0, 0.0, start.yaw]),
        joints=np.clip(joints, robot.position_lower, robot.position_upper),
        mass_factor={
            name: 1.0 + random.uniform(-jitter.mass, jitter.mass)
            for name in robot.body_names
        },
        ground_friction=friction,
    )


def place_robot(
    plant: MultibodyPlant,
    context: Context,
    robot: Robot,
    variation: Variation,
    terrain: Sequence[Block] = (),
) -> None:
    """Puts the robot into its starting pose, let down until a sole meets the ground.

    Where boxes of the ``terrain`` lie above each other the highest surface counts.
    """
    for name, factor in variation.mass_factor.items():
        if factor == 1.0:
            continue
        body = plant.GetBodyByName(name)
        inertia = body.CalcSpatialInertiaInBodyFrame(context)
        body.SetSpatialInertiaInBodyFrame(
            context,
            SpatialInertia(
                inertia.get_mass() * factor,
                inertia.get_com(),
                inertia.get_unit_inertia(),
            ),
        )
    q = plant.GetPositions(context)
    q[robot.indices(plant).q] = variation.joints
    plant.SetPositions(context, q)
    pelvis = plant.GetBodyByName(robot.file.pelvis)
    R_WP = RollPitchYaw(variation.rpy).ToRotationMatrix()
    plant.SetFloatingBaseBodyPoseInWorldFrame(
        context, pelvis, RigidTransform(R_WP, np.append(variation.position, 0.0))
    )
    lowest = min(
        z - surface_height(terrain, x, y) for x, y, z in _corners(plant, context, robot)
    )
    plant.SetFloatingBaseBodyPoseInWorldFrame(
        context,
        pelvis,
        RigidTransform(R_WP, np.append(variation.position, -lowest)),
    )


def _corners(
    plant: MultibodyPlant, context: Context, robot: Robot
) -> Iterator[tuple[float, float, float]]:
    """Where the corners of both soles are in W [m]."""
    half_length, half_width = robot.file.sole.length / 2, robot.file.sole.width / 2
    for foot in robot.file.feet:
        X_WF = plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context)
        for x in (-half_length, half_length):
            for y in (-half_width, half_width):
                corner = X_WF @ np.array([x, y, 0.0])
                yield float(corner[0]), float(corner[1]), float(corner[2])
