"""Reads a robot: one that comes with the package by name, any other by its path.

Checks that file and URDF belong together and that the controller can use the robot;
everything wrong is refused here, with the file's name and what to do.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.common.yaml import yaml_load, yaml_load_typed
from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RevoluteJoint

from atlas_drake.errors import (
    RobotDescriptionError,
    ScenarioError,
    did_you_mean,
    shown,
)
from atlas_drake.kinds import check_kinds, make_plain
from atlas_drake.robot.file import RobotFile, check_file
from atlas_drake.robot.leg import read_legs
from atlas_drake.robot.robot import Robot, add_urdf

MODELS_FOLDER = Path(__file__).parent.parent / "models"
DEFAULT_ROBOT = "atlas"
_ENDINGS = (".yaml", ".yml")


def available_robots() -> list[str]:
    """Names of the robots that come with the package, the default first."""
    names = sorted(path.stem for path in MODELS_FOLDER.glob("*.yaml"))
    return sorted(names, key=lambda name: name != DEFAULT_ROBOT)


def find_robot(model: str | Path) -> Path:
    """Returns the YAML file of a robot, absolute.

    Args:
        model: A name from ``available_robots``, or the path of a YAML file, relative
            to the working folder.

    Raises:
        RobotDescriptionError: If there is no such robot.
    """
    if str(model) in available_robots():
        return MODELS_FOLDER / f"{model}.yaml"
    path = Path(model).expanduser()
    names = available_robots()
    if path.suffix not in _ENDINGS:
        raise RobotDescriptionError(
            "model",
            str(model),
            f"there is no robot {shown(str(model))};{did_you_mean(str(model), names)} "
            f"must be one of {', '.join(names)}, or the path of a robot's file "
            f"({' or '.join('*' + ending for ending in _ENDINGS)})",
        )
    path = path.absolute()
    if not path.is_file():
        raise RobotDescriptionError(
            "model",
            str(model),
            f"there is no file {path}; give the path of a robot's YAML file, or one of "
            f"{', '.join(names)}",
        )
    return path


def model_beside(model: str, folder: Path) -> str:
    """Returns a robot's name as it is, and its path made absolute from ``folder``."""
    if model in available_robots() or Path(model).suffix not in _ENDINGS:
        return model
    return str((folder / Path(model).expanduser()).absolute())


def load_robot(model: str | Path = DEFAULT_ROBOT) -> Robot:
    """Reads one robot.

    Args:
        model: As for ``find_robot``.

    Raises:
        RobotDescriptionError: If there is no such robot, its description or its URDF
            is faulty, they do not belong together, or the controller cannot use it.
    """
    path = find_robot(model)
    try:
        return _load(path, str(model) if str(model) in available_robots() else None)
    except (RobotDescriptionError, ScenarioError) as error:
        raise RobotDescriptionError(
            error.field, error.value, f"{error.problem} (in {path})"
        ) from None


def _load(path: Path, name: str | None) -> Robot:
    file = _read_file(path)
    robot_name = name or path.stem
    plant = _parse(path.parent / file.urdf, robot_name)
    instance = plant.GetModelInstanceByName(robot_name)
    _check_names(plant, instance, file)
    pelvis = _check_base(plant, instance, file)
    names = tuple(joint.name for joint in file.joints)
    actuators = _check_joints(plant, names, file.urdf)
    joints = [plant.GetJointByName(joint) for joint in names]
    lower = np.array([joint.position_lower_limits()[0] for joint in joints])
    upper = np.array([joint.position_upper_limits()[0] for joint in joints])
    velocity = np.array([joint.velocity_upper_limits()[0] for joint in joints])
    effort = np.array([actuators[joint].effort_limit() for joint in names])
    _check_limits(names, lower, upper, velocity, effort)
    _check_pose(file, lower, upper)
    return Robot(
        name=robot_name,
        path=path,
        model=name or str(path),
        file=file,
        joint_names=names,
        position_lower=lower,
        position_upper=upper,
        velocity_limit=velocity,
        effort_limit=effort,
        mass=plant.CalcTotalMass(plant.CreateDefaultContext()),
        body_names=tuple(
            plant.get_body(index).name() for index in plant.GetBodyIndices(instance)
        ),
        moved_links=tuple(str(joint.child_body().name()) for joint in joints),
        legs=read_legs(plant, pelvis, file),
    )


def _read_file(path: Path) -> RobotFile:
    """The YAML file, checked by itself."""
    try:
        text = path.read_text()
        raw = yaml_load(data=text) if text.strip() else None
    except Exception as error:
        # The parser raises many kinds of exception for what is always a faulty file.
        raise RobotDescriptionError(
            "file", str(path), f"cannot be read: {error}"
        ) from error
    if not isinstance(raw, Mapping):
        raise RobotDescriptionError(
            "file", raw, "must have fields of a robot, such as urdf: robot.urdf"
        )
    check_kinds(raw, RobotFile, from_text=True)
    file: RobotFile = yaml_load_typed(schema=RobotFile, data=text, defaults=RobotFile())
    make_plain(file)
    check_file(file)
    file.imu_frame = file.imu_frame or file.pelvis
    file.pushed = file.pushed or list(
        dict.fromkeys([file.pelvis, file.chest, *file.hands])
    )
    return file


def _parse(urdf: Path, name: str) -> Any:
    """A finalized plant of the robot alone; meshes are looked for, too."""
    if not urdf.is_file():
        raise RobotDescriptionError(
            "urdf", str(urdf), f"there is no file {urdf}; give its path from this file"
        )
    plant = MultibodyPlant(time_step=0.0)
    scene_graph = SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    try:
        add_urdf(plant, urdf, name)
    except RuntimeError as error:
        raise RobotDescriptionError(
            "urdf", str(urdf), f"Drake cannot read it: {error}"
        ) from error
    plant.Finalize()
    return plant


def _check_names(plant: Any, instance: Any, file: RobotFile) -> None:
    """Checks that the URDF has every body and frame that the file names."""
    named: list[tuple[str, str]] = [("pelvis", file.pelvis)]
    for index, foot in enumerate(file.feet):
        named.append((f"feet[{index}].body", foot.body))
    named += [(f"hands[{index}]", hand) for index, hand in enumerate(file.hands)]
    named += [(f"pushed[{index}]", body) for index, body in enumerate(file.pushed)]
    for field, name in named:
        if not plant.HasBodyNamed(name):
            known = [
                plant.get_body(index).name() for index in plant.GetBodyIndices(instance)
            ]
            raise _missing(field, name, "body", known)
    frames = [("chest", file.chest), ("imu_frame", file.imu_frame)]
    for index, foot in enumerate(file.feet):
        frames.append((f"feet[{index}].sole_frame", foot.sole_frame))
    for index, contact in enumerate(file.contacts):
        frames.append((f"contacts[{index}].frame", contact.frame))
    for field, name in frames:
        if not plant.HasFrameNamed(name):
            known = [
                plant.get_frame(index).name()
                for index in plant.GetFrameIndices(instance)
            ]
            raise _missing(field, name, "frame", known)


def _missing(
    field: str, name: str, kind: str, known: Iterable[str]
) -> RobotDescriptionError:
    known = [word for word in known if word]
    hint = did_you_mean(name, known) or f" It has {', '.join(known)}."
    return RobotDescriptionError(
        field, name, f"the URDF has no {kind} {shown(name)}.{hint}"
    )


def _check_base(plant: Any, instance: Any, file: RobotFile) -> Any:
    """Checks that the pelvis, and nothing else, is free in the world; returns it."""
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


def _check_joints(plant: Any, names: tuple[str, ...], urdf: str) -> dict[str, Any]:
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


def _check_limits(
    names: tuple[str, ...],
    lower: np.ndarray,
    upper: np.ndarray,
    velocity: np.ndarray,
    effort: np.ndarray,
) -> None:
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


def _check_pose(file: RobotFile, lower: np.ndarray, upper: np.ndarray) -> None:
    for index, joint in enumerate(file.joints):
        if not lower[index] <= joint.stand_prep <= upper[index]:
            raise RobotDescriptionError(
                f"joints[{index}].stand_prep",
                joint.stand_prep,
                f"is {joint.stand_prep:g}; joint {joint.name} goes from "
                f"{lower[index]:g} to {upper[index]:g} rad",
            )
