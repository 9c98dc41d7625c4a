"""Checks of a robot's file against its URDF, and of its stand-prep pose.

Each check raises a RobotDescriptionError that names the first invalid field. The file
alone is checked in ``file``, masses in ``parsing``, the layout of the legs in ``leg``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from pydrake.multibody.tree import RevoluteJoint

from atlas_drake.errors import RobotDescriptionError, did_you_mean, shown
from atlas_drake.robot.file import TRUNK, RobotFile

LEAST_COM_HEIGHT = 0.12
"""Least height of the center of mass above the soles of a standing robot [m]: the
balance feedback would treat a shorter pendulum as a longer one."""
_LEVEL, _TILT = 0.01, 0.1
"""Tolerances for level [m] and flat [rad] soles in the stand-prep pose."""
_TOUCH = 1e-4
"""Depth up to which shapes may overlap in the stand-prep pose [m]: they then push each
other apart with some 50 N."""


def check_names(plant: Any, instance: Any, file: RobotFile) -> None:
    """Checks that the URDF has every body and frame that the file names."""
    bodies = {
        "pelvis": file.pelvis,
        **{f"feet[{i}].body": foot.body for i, foot in enumerate(file.feet)},
        **{f"hands[{i}]": hand for i, hand in enumerate(file.hands)},
        **{f"pushed[{i}]": body for i, body in enumerate(file.pushed) if body != TRUNK},
        **{
            f"no_collisions[{i}][{k}]": body
            for i, pair in enumerate(file.no_collisions)
            for k, body in enumerate(pair)
        },
    }
    frames = {
        "chest": file.chest,
        "imu_frame": file.imu_frame,
        **{
            f"feet[{i}].sole_frame": foot.sole_frame for i, foot in enumerate(file.feet)
        },
        **{f"contacts[{i}].frame": one.frame for i, one in enumerate(file.contacts)},
    }
    known_bodies = [plant.get_body(k).name() for k in plant.GetBodyIndices(instance)]
    known_frames = [plant.get_frame(k).name() for k in plant.GetFrameIndices(instance)]
    for kind, given, known in (
        ("body", bodies, known_bodies),
        ("frame", frames, known_frames),
    ):
        for field, name in given.items():
            if name not in known:
                hint = did_you_mean(name, known) or f" It has {', '.join(known)}."
                problem = f"the URDF has no {kind} {shown(name)}.{hint}"
                raise RobotDescriptionError(field, name, problem)


def check_base(plant: Any, file: RobotFile) -> Any:
    """Checks that the pelvis is the only free body; returns the pelvis."""
    free = [plant.get_body(index).name() for index in plant.GetFloatingBaseBodies()]
    if free != [file.pelvis]:
        problem = f"must be the only body that is free in the world; free are {free}"
        raise RobotDescriptionError("pelvis", file.pelvis, problem)
    return plant.GetBodyByName(file.pelvis)


def check_joints(plant: Any, file: RobotFile) -> dict[str, Any]:
    """Checks that file and URDF have the same joints; returns their actuators."""
    indices = plant.GetJointActuatorIndices()
    all_actuators = map(plant.get_joint_actuator, indices)
    actuators = {actuator.joint().name(): actuator for actuator in all_actuators}
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        if joint.num_velocities() in range(1, 6):
            name, problem = joint.name(), ""
            if not isinstance(joint, RevoluteJoint):
                problem = f"is {joint.type_name()}; must be revolute"
            elif name not in actuators:
                problem = (
                    "has no <transmission> in the URDF; give it one, or make it fixed"
                )
            if problem:
                raise RobotDescriptionError("joints", name, f"joint {name} {problem}")
    odd = sorted({joint.name for joint in file.joints} ^ set(actuators))
    if odd:
        problem = f"must be the URDF's joints with a <transmission>; differing: {odd}"
        raise RobotDescriptionError("joints", odd, problem)
    return actuators


def check_limits(file: RobotFile, limits: Mapping[str, Sequence[float]]) -> None:
    """Checks that every joint has finite limits, and the stand-prep pose is within."""
    for kind, values in limits.items():
        for joint, value in zip(file.joints, values, strict=True):
            if not np.isfinite(value) or (
                kind in ("velocity", "effort") and value <= 0
            ):
                problem = f"joint {joint.name} has the {kind} limit {value} in the URDF"
                raise RobotDescriptionError("joints", value, problem)
    for index, joint in enumerate(file.joints):
        lower, upper = limits["lower position"][index], limits["upper position"][index]
        if not lower <= joint.stand_prep <= upper:
            field = f"joints[{index}].stand_prep"
            problem = f"{joint.name} goes from {lower:g} to {upper:g} rad"
            raise RobotDescriptionError.about(field, joint.stand_prep, problem)


class StandPrep(NamedTuple):
    """What is measured in the stand-prep pose."""

    com_height: float  # Center of mass above the soles [m]
    stance_width: float  # Distance between the soles' middles [m]
    pelvis_height: float  # Pelvis' origin above the soles [m]


def check_stand_prep(
    plant: Any, instance: Any, context: Any, file: RobotFile
) -> StandPrep:
    """Checks that the robot can stand on both feet in its stand-prep pose.

    The context, part of that of a diagram with scene graph, gets the pose.
    """
    for joint in file.joints:
        plant.GetJointByName(joint.name).set_angle(context, joint.stand_prep)
    soles = [
        plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context)
        for foot in file.feet
    ]
    left, right = (np.array(sole.translation()) for sole in soles)
    com = np.array(plant.CalcCenterOfMassPositionInWorld(context, [instance]))
    middle = 0.5 * (left + right)
    if left[1] <= right[1]:
        problem = "the first foot is not to the left of the second one; exchange them"
        raise RobotDescriptionError("feet", file.feet[0].body, problem)

    # Rounding may bring the cosine of a level sole above 1.
    lean = min(float(sole.rotation().matrix()[2, 2]) for sole in soles)
    tilt = float(np.arccos(min(lean, 1.0)))
    apart = float(abs(left[2] - right[2]))
    ahead, height = float(com[0] - middle[0]), float(com[2] - middle[2])
    problem = ""
    if apart > _LEVEL or tilt > _TILT:
        problem = (
            f"the soles differ by {apart:.3f} m in height, tilted by {tilt:.2f} rad"
        )
    elif abs(ahead) > 0.5 * file.sole.length:
        problem = (
            f"the center of mass is {ahead:.3f} m ahead of the middle of the soles"
        )
    elif height < LEAST_COM_HEIGHT:
        problem = (
            f"the center of mass is {height:.2f} m above the soles; the controller "
            f"needs {LEAST_COM_HEIGHT} m"
        )
    if problem:
        problem = f"in this pose, with the pelvis upright, {problem}"
        raise RobotDescriptionError("joints[].stand_prep", height, problem)
    _check_overlaps(plant, context, file)
    return StandPrep(height, float(left[1] - right[1]), float(-middle[2]))


def _check_overlaps(plant: Any, context: Any, file: RobotFile) -> None:
    """Checks that no shapes of the robot are inside each other."""
    query = plant.get_geometry_query_input_port().Eval(context)
    inside: dict[tuple[str, ...], float] = {}
    for pair in query.ComputePointPairPenetration():
        frames = map(query.inspector().GetFrameId, (pair.id_A, pair.id_B))
        bodies = tuple(sorted(plant.GetBodyFromFrameId(f).name() for f in frames))
        if pair.depth > _TOUCH:
            inside[bodies] = max(pair.depth, inside.get(bodies, 0.0))
    if inside:
        found = ", ".join(f"{a} and {b} by {d:.4f} m" for (a, b), d in inside.items())
        pairs = ", ".join(f"[{one}, {other}]" for one, other in inside)
        raise RobotDescriptionError(
            "no_collisions",
            file.no_collisions,
            f"in the stand-prep pose shapes are inside each other: {found}; correct "
            f"the shapes, or let them pass: no_collisions: [{pairs}]",
        )
