"""The robot on its feet: where its pelvis is when its soles meet the ground.

Used for the default context of a station, before time starts, and when the user asks
for a reset; nothing here moves a robot that is at work.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.messages.checks import check_number, check_vector
from atlas_drake.robot import Robot
from atlas_drake.scenario.terrain import Block, surface_height


def place_robot(
    plant: MultibodyPlant,
    context: Context,
    robot: Robot,
    *,
    position: Sequence[float] | np.ndarray = (0.0, 0.0),
    rpy: Sequence[float] | np.ndarray = (0.0, 0.0, 0.0),
    joints: np.ndarray | None = None,
    terrain: Sequence[Block] = (),
    clearance: float = 0.0,
) -> None:
    """Puts the robot at rest into a pose, let down until a sole meets the ground.

    Where boxes of the ``terrain`` lie above each other the highest surface counts.

    Args:
        plant: With the robot.
        context: Of the plant. Positions and velocities of the robot are overwritten,
            those of other models stay.
        robot: In the plant.
        position: Of the pelvis, horizontal in W [m], shape (2,).
        rpy: Roll, pitch and yaw of the pelvis in W [rad], shape (3,).
        joints: Joint positions in message order [rad], shape (n,); None is the
            stand-prep pose.
        terrain: Beside the level ground.
        clearance: How far above that its lowest sole shall hang [m].

    Raises:
        InvalidMessageError: If ``position``, ``rpy`` or ``joints`` is not made of as
            many finite numbers, or ``clearance`` is none; nothing has then changed.
    """
    x, y = check_vector(position, "position", 2)
    roll_pitch_yaw = check_vector(rpy, "rpy", 3)
    pose = robot.stand_prep if joints is None else joints
    pose = check_vector(pose, "joints", robot.num_joints)
    clearance = check_number(clearance, "clearance")
    own = robot.instance(plant)
    plant.SetVelocities(context, own, np.zeros(plant.num_velocities(own)))
    q = plant.GetPositions(context, own).copy()
    q[robot.indices(plant).q] = pose
    plant.SetPositions(context, own, q)
    pelvis = plant.GetBodyByName(robot.file.pelvis, own)
    R_WP = RollPitchYaw(roll_pitch_yaw).ToRotationMatrix()

    def lift_to(z: float) -> None:
        X_WP = RigidTransform(R_WP, np.array([x, y, z]))
        plant.SetFloatingBaseBodyPoseInWorldFrame(context, pelvis, X_WP)

    lift_to(0.0)
    lowest = min(
        z - surface_height(terrain, x, y) for x, y, z in _corners(plant, context, robot)
    )
    lift_to(clearance - lowest)


def stand_by_default(
    plant: MultibodyPlant, robot: Robot, terrain: Sequence[Block] = ()
) -> None:
    """Lets every default context of a finished plant have the robot on its feet.

    It stands in the stand-prep pose over the origin of W, facing along x.
    """
    context = plant.CreateDefaultContext()
    place_robot(plant, context, robot, terrain=terrain)
    plant.SetDefaultPositions(plant.GetPositions(context))


def _corners(
    plant: MultibodyPlant, context: Context, robot: Robot
) -> Iterator[tuple[float, float, float]]:
    """Where the corners of both soles are in W [m]."""
    half_length, half_width = robot.file.sole.length / 2, robot.file.sole.width / 2
    for foot in robot.file.feet:
        frame = plant.GetFrameByName(foot.sole_frame, robot.instance(plant))
        X_WF = frame.CalcPoseInWorld(context)
        for x in (-half_length, half_length):
            for y in (-half_width, half_width):
                corner = X_WF @ np.array([x, y, 0.0])
                yield float(corner[0]), float(corner[1]), float(corner[2])
