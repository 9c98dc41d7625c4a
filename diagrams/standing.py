"""Places the robot on its feet: the pose of the pelvis with the soles on the ground.

The height of terrain is computed; other models below the soles are found by the scene
graph. Used for the default context of a station, before time starts, and on a reset
that the user requests; never during a run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from atlas_drake.messages.checks import check_number, check_vector
from atlas_drake.robot import Robot
from atlas_drake.worlds.scenery import GROUND, block_name
from atlas_drake.worlds.terrain import Block, surface_height
from atlas_drake.worlds.world import Overlap, WorldError, overlaps_with_world

TOUCHING = 1e-5
"""Overlap of a foot and a model below which the foot stands on the model [m]."""
DEEPEST = 0.01
"""Overlap of the robot and a model that contact still pushes apart gently [m]."""
MOST_LIFTS = 200
"""Number of lifts after which a model under a foot is taken to have no top."""


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
    """Places the robot at rest in a pose, with its lowest sole on the ground.

    Where boxes of the ``terrain`` lie above each other the highest surface counts. Of
    other models in the plant the geometry counts: a foot that would begin inside one
    is lifted onto it, as a foot under a table top would not be. That needs the context
    to be part of one of the whole diagram, with its scene graph.

    Args:
        plant: Plant with the robot.
        context: Context of the plant. Positions and velocities of the robot are
            overwritten, those of other models stay.
        robot: Robot in the plant.
        position: Position of the pelvis, horizontal in W [m], shape (2,).
        rpy: Roll, pitch and yaw of the pelvis in W [rad], shape (3,).
        joints: Joint positions in message order [rad], shape (n,); None is the
            stand-prep pose.
        terrain: Boxes on the level ground.
        clearance: Height of the lowest sole above the ground [m].

    Raises:
        InvalidMessageError: If ``position``, ``rpy`` or ``joints`` is not made of as
            many finite numbers, or ``clearance`` is not a finite number; the context is
            then unchanged.
        WorldError: If the robot would begin deeper than ``DEEPEST`` inside another
            model, which it names; the context is then unchanged.
    """
    x, y = check_vector(position, "position", 2)
    roll_pitch_yaw = check_vector(rpy, "rpy", 3)
    pose = robot.stand_prep if joints is None else joints
    pose = check_vector(pose, "joints", robot.num_joints)
    clearance = check_number(clearance, "clearance")
    own = robot.instance(plant)
    before = plant.GetPositionsAndVelocities(context, own).copy()
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
    known = {GROUND, *map(block_name, range(len(terrain)))}

    def overlaps() -> list[Overlap]:
        return overlaps_with_world(plant, context, robot, known)

    lift_to(-lowest)
    height = _lift_feet(lift_to, -lowest, overlaps, robot)
    if clearance:
        lift_to(height + clearance)
    deepest = max(overlaps(), key=lambda found: found.depth, default=None)
    if deepest is not None and deepest.depth > DEEPEST:
        plant.SetPositionsAndVelocities(context, own, before)
        raise WorldError(
            f"{deepest.body} of {robot.name} would begin {deepest.depth:.3f} m inside "
            f"{deepest.model}: put one of them elsewhere, such as by start.position"
        )


def _lift_feet(
    lift_to: Callable[[float], None],
    height: float,
    overlaps: Callable[[], list[Overlap]],
    robot: Robot,
) -> float:
    """Lifts the robot until no foot is inside a model; returns the pelvis' height [m].

    The depth of an overlap is the shortest way out of it, whatever its direction, and
    so no longer than the way up: no lift leads past the lowest height that is free.
    """
    feet = {foot.body for foot in robot.file.feet}
    for _ in range(MOST_LIFTS):
        depth = max((o.depth for o in overlaps() if o.body in feet), default=0.0)
        if depth < TOUCHING:
            break
        height += depth
        lift_to(height)
    return height


def stand_by_default(
    plant: MultibodyPlant,
    robot: Robot,
    terrain: Sequence[Block] = (),
    context: Context | None = None,
) -> None:
    """Sets a finalized plant's default state so that the robot stands on its feet.

    It stands in the stand-prep pose over the origin of W, facing along x. If that were
    inside a model of the world, the default stays as it is, for a robot that begins
    elsewhere.

    Other models are known only to a ``context`` of the plant in a whole diagram.
    """
    context = plant.CreateDefaultContext() if context is None else context
    with suppress(WorldError):
        place_robot(plant, context, robot, terrain=terrain)
        plant.SetDefaultPositions(plant.GetPositions(context))


def _corners(
    plant: MultibodyPlant, context: Context, robot: Robot
) -> Iterator[tuple[float, float, float]]:
    """Computes the corners of both soles in W [m]."""
    half_length, half_width = robot.file.sole.length / 2, robot.file.sole.width / 2
    for foot in robot.file.feet:
        frame = plant.GetFrameByName(foot.sole_frame, robot.instance(plant))
        X_WF = frame.CalcPoseInWorld(context)
        for x in (-half_length, half_length):
            for y in (-half_width, half_width):
                corner = X_WF @ np.array([x, y, 0.0])
                yield float(corner[0]), float(corner[1]), float(corner[2])
