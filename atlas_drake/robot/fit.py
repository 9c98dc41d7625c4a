"""Checks of a robot's file against its URDF, and of its stand-prep pose.

Each check raises a RobotDescriptionError that names the first invalid field. The file
alone is checked in ``file``, the layout of the legs in ``leg``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pydrake.multibody.tree import RevoluteJoint

from atlas_drake.errors import RobotDescriptionError, did_you_mean, shown
from atlas_drake.robot.file import RobotFile

LEAST_COM_HEIGHT = 0.35
"""Least height of the center of mass above the soles of a standing robot [m]: the
balance feedback would treat a shorter pendulum as a longer one."""
_LEVEL, _TILT = 0.01, 0.1
"""Tolerances for level [m] and flat [rad] soles in the stand-prep pose."""
_TOUCH = 1e-4
"""Depth up to which shapes may overlap in the stand-prep pose [m]: they then push each
other apart with some 50 N."""


def check_names(plant: Any, instance: Any, file: RobotFile) -> None:
    """Checks that the URDF has every body and frame that the file names."""
    known = {
        "body": [plant.get_body(k).name() for k in plant.GetBodyIndices(instance)],
        "frame": [plant.get_frame(k).name() for k in plant.GetFrameIndices(instance)],
    }
    for kind, field, name in (
        ("body", "pelvis", file.pelvis),
        *(("body", f"feet[{i}].body", foot.body) for i, foot in enumerate(file.feet)),
        *(("body", f"hands[{i}]", hand) for i, hand in enumerate(file.hands)),
        *(("body", f"pushed[{i}]", body) for i, body in enumerate(file.pushed)),
        *(
            ("body", f"no_collisions[{i}]", body)
            for i, pair in enumerate(file.no_collisions)
            for body in pair
        ),
        ("frame", "chest", file.chest),
        ("frame", "imu_frame", file.imu_frame),
        *(
            ("frame", f"feet[{i}].sole_frame", foot.sole_frame)
            for i, foot in enumerate(file.feet)
        ),
        *(
            ("frame", f"contacts[{i}].frame", contact.frame)
            for i, contact in enumerate(file.contacts)
        ),
    ):
        if name not in known[kind]:
            words = [word for word in known[kind] if word]
            hint = did_you_mean(name, words) or f" It has {', '.join(words)}."
            problem = f"the URDF has no {kind} {shown(name)}.{hint}"
            raise RobotDescriptionError(field, name, problem)


def check_base(plant: Any, instance: Any, file: RobotFile) -> Any:
    """Checks that the pelvis is the only free body; returns the pelvis."""
    pelvis = plant.GetBodyByName(file.pelvis)
    free = sorted(
        plant.get_body(index).name() for index in plant.GetFloatingBaseBodies()
    )
    if free != [file.pelvis]:
        raise RobotDescriptionError(
            "pelvis",
            file.pelvis,
            f"the URDF's bodies that are free in the world are {', '.join(free)}; the "
            f"pelvis, {file.pelvis}, must be the root, and the only one",
        )
    return pelvis


def check_joints(plant: Any, names: tuple[str, ...], urdf: str) -> dict[str, Any]:
    """Checks that file and URDF have the same joints; returns their actuators."""
    actuators = {
        plant.get_joint_actuator(index).joint().name(): plant.get_joint_actuator(index)
        for index in plant.GetJointActuatorIndices()
    }
    if sorted(names) != sorted(actuators):
        odd = sorted(set(names) ^ set(actuators))
        raise RobotDescriptionError(
            "joints",
            odd,
            f"the file and {urdf} name different actuated joints: {', '.join(odd)}; "
            "list each joint that has a <transmission>, and no other",
        )
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        moves = joint.num_velocities() in range(1, 6)
        if moves and joint.name() not in actuators:
            raise RobotDescriptionError(
                "joints",
                joint.name(),
                f"joint {joint.name()} of {urdf} moves without an actuator; give it a "
                "<transmission>, or make it fixed",
            )
        if moves and not isinstance(joint, RevoluteJoint):
            raise RobotDescriptionError(
                "joints",
                joint.name(),
                f"joint {joint.name()} of {urdf} is {joint.type_name()}; must be "
                "revolute: everything is commanded as an angle",
            )
    return actuators


def check_limits(
    names: tuple[str, ...],
    lower: np.ndarray,
    upper: np.ndarray,
    velocity: np.ndarray,
    effort: np.ndarray,
) -> None:
    """Checks that every joint has finite limits, given with shape (n,) each."""
    for what, values, low in (
        ("lower position limit", lower, -np.inf),
        ("upper position limit", upper, -np.inf),
        ("velocity limit", velocity, 0.0),
        ("effort limit", effort, 0.0),
    ):
        for name, value in zip(names, values.tolist(), strict=True):
            if not (np.isfinite(value) and value > low):
                raise RobotDescriptionError(
                    "joints",
                    value,
                    f"joint {name} has the {what} {value}; the URDF must give a finite "
                    f"one{'' if low < 0.0 else ' above 0'}",
                )


def check_pose(file: RobotFile, lower: np.ndarray, upper: np.ndarray) -> None:
    """Checks that the stand-prep pose is within the position limits."""
    for index, joint in enumerate(file.joints):
        if not lower[index] <= joint.stand_prep <= upper[index]:
            raise RobotDescriptionError(
                f"joints[{index}].stand_prep",
                joint.stand_prep,
                f"is {joint.stand_prep:g}; joint {joint.name} goes from "
                f"{lower[index]:g} to {upper[index]:g} rad",
            )


def check_overlaps(plant: Any, context: Any, file: RobotFile) -> None:
    """Checks that no shapes of the robot are inside each other in its stand-prep pose.

    Args:
        plant: Plant of the robot alone.
        context: Context of the plant in a diagram with its scene graph.
        file: File of the robot.
    """
    _take_stand_prep(plant, context, file)
    query = plant.get_geometry_query_input_port().Eval(context)
    depths: dict[tuple[str, ...], float] = {}
    for pair in query.ComputePointPairPenetration():
        frames = map(query.inspector().GetFrameId, (pair.id_A, pair.id_B))
        bodies = tuple(sorted(plant.GetBodyFromFrameId(f).name() for f in frames))
        depths[bodies] = max(pair.depth, depths.get(bodies, _TOUCH))
    inside = {pair: depth for pair, depth in depths.items() if depth > _TOUCH}
    if inside:
        found = ", ".join(
            f"{one} and {other} by {depth:.4f} m"
            for (one, other), depth in inside.items()
        )
        pairs = ", ".join(f"[{one}, {other}]" for one, other in inside)
        raise RobotDescriptionError(
            "no_collisions",
            file.no_collisions,
            f"in the stand-prep pose shapes are inside each other: {found}; correct "
            f"the shapes, or let them pass: no_collisions: [{pairs}]",
        )


def _take_stand_prep(plant: Any, context: Any, file: RobotFile) -> None:
    for joint in file.joints:
        plant.GetJointByName(joint.name).set_angle(context, joint.stand_prep)


def check_stance(plant: Any, instance: Any, file: RobotFile) -> float:
    """Checks that the robot can stand on both feet in its stand-prep pose.

    Returns:
        Height of the center of mass above the soles in this pose [m].
    """
    context = plant.CreateDefaultContext()
    _take_stand_prep(plant, context, file)
    soles = [
        plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context)
        for foot in file.feet
    ]
    left, right = (np.array(sole.translation()) for sole in soles)
    com = np.array(plant.CalcCenterOfMassPositionInWorld(context, [instance]))
    middle = 0.5 * (left + right)
    if left[1] <= right[1]:
        raise RobotDescriptionError(
            "feet",
            file.feet[0].body,
            "the first foot is not to the left of the second one; exchange them",
        )

    def wrong(found: str, wanted: str, value: float) -> RobotDescriptionError:
        problem = f"in this pose, with the pelvis upright, {found}; {wanted}"
        return RobotDescriptionError("joints[].stand_prep", value, problem)

    # Of a level sole the cosine may be a little more than 1.
    lean = min(float(sole.rotation().matrix()[2, 2]) for sole in soles)
    tilt = float(np.arccos(min(lean, 1.0)))
    apart = float(abs(left[2] - right[2]))
    if apart > _LEVEL or tilt > _TILT:
        found = f"the soles differ by {apart:.3f} m in height, tilted by {tilt:.2f} rad"
        raise wrong(found, "they must be flat and on one level", tilt)
    ahead = float(com[0] - middle[0])
    if abs(ahead) > 0.5 * file.sole.length:
        found = f"the center of mass is {ahead:.3f} m ahead of the middle of the soles"
        raise wrong(found, "it must be above them", ahead)
    height = float(com[2] - middle[2])
    if height < LEAST_COM_HEIGHT:
        found = f"the center of mass is {height:.2f} m above the soles"
        raise wrong(found, f"the controller needs {LEAST_COM_HEIGHT} m", height)
    return height
