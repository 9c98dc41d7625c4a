"""Reads a robot: by name if it comes with the package, otherwise by path.

Every error about a robot's files carries the file's name. The checks are in ``file``,
``fit`` and ``leg``.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.config import checked, read_yaml
from atlas_drake.errors import RobotDescriptionError, ScenarioError
from atlas_drake.robot.data_file import file_beside, find_data_file
from atlas_drake.robot.file import RobotFile
from atlas_drake.robot.fit import (
    check_base,
    check_joints,
    check_limits,
    check_names,
    check_overlaps,
    check_pose,
    check_stance,
)
from atlas_drake.robot.leg import read_legs
from atlas_drake.robot.packages import find_urdf
from atlas_drake.robot.robot import Robot, add_urdf, leave_out_collisions

MODELS_FOLDER = Path(__file__).parent.parent / "models"
DEFAULT_ROBOT = "atlas"


def available_robots() -> list[str]:
    """Lists the names of the robots in the package, the default first."""
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
    return find_data_file(
        model,
        MODELS_FOLDER,
        available_robots(),
        "robot",
        lambda problem: RobotDescriptionError("model", str(model), problem),
    )


def model_beside(model: str, folder: Path) -> str:
    """Returns a robot's name unchanged, or its path made absolute from ``folder``."""
    return file_beside(model, folder, available_robots())


def load_robot(model: str | Path = DEFAULT_ROBOT) -> Robot:
    """Reads one robot.

    Args:
        model: As for ``find_robot``.

    Raises:
        RobotDescriptionError: If there is no such robot, its description or its URDF is
            faulty, they do not match, or the controller cannot use it.
    """
    path = find_robot(model)
    file = read_robot_file(model)
    name = str(model) if str(model) in available_robots() else None
    try:
        return _load(path, name, file)
    except (RobotDescriptionError, ScenarioError) as error:
        raise RobotDescriptionError(
            error.field, error.value, f"{error.problem} (in {path})"
        ) from None


def _load(path: Path, name: str | None, file: RobotFile) -> Robot:
    robot_name = name or path.stem
    builder = DiagramBuilder()
    plant: Any = AddMultibodyPlantSceneGraph(builder, time_step=0.0)[0]
    urdf = find_urdf(path.parent, file.urdf)
    try:
        # With geometry, so that meshes are read, too.
        instance = add_urdf(plant, urdf, robot_name)
    except RuntimeError as error:
        problem = f"Drake cannot read it: {error}"
        raise RobotDescriptionError("urdf", str(urdf), problem) from error
    check_names(plant, instance, file)
    leave_out_collisions(plant, instance, file.no_collisions)
    plant.Finalize()
    diagram = builder.Build()
    pelvis = check_base(plant, instance, file)
    names = tuple(joint.name for joint in file.joints)
    actuators = check_joints(plant, names, file.urdf)
    joints = [plant.GetJointByName(joint) for joint in names]
    lower = np.array([joint.position_lower_limits()[0] for joint in joints])
    upper = np.array([joint.position_upper_limits()[0] for joint in joints])
    velocity = np.array([joint.velocity_upper_limits()[0] for joint in joints])
    effort = np.array([actuators[joint].effort_limit() for joint in names])
    check_limits(names, lower, upper, velocity, effort)
    check_pose(file, lower, upper)
    legs = read_legs(plant, pelvis, file)
    com_height = check_stance(plant, instance, file)
    root = diagram.CreateDefaultContext()
    check_overlaps(plant, plant.GetMyMutableContextFromRoot(root), file)
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
        com_height=com_height,
        body_names=tuple(
            plant.get_body(index).name() for index in plant.GetBodyIndices(instance)
        ),
        moved_links=tuple(
            tuple(str(body.name()) for body in plant.GetBodiesWeldedTo(link))
            for link in (joint.child_body() for joint in joints)
        ),
        legs=legs,
    )


def read_robot_file(model: str | Path = DEFAULT_ROBOT) -> RobotFile:
    """Reads a robot's YAML file, and not its URDF.

    Args:
        model: As for ``find_robot``.

    Raises:
        RobotDescriptionError: If there is no such robot, or the file is faulty.
    """
    path = find_robot(model)
    try:
        return _parsed(path.read_text())
    except (OSError, UnicodeDecodeError) as error:
        problem = f"{path} cannot be read: {error}"
        raise RobotDescriptionError("file", str(path), problem) from error
    except (RobotDescriptionError, ScenarioError) as error:
        raise RobotDescriptionError(
            error.field, error.value, f"{error.problem} (in {path})"
        ) from None


@functools.lru_cache(maxsize=8)
def _parsed(text: str) -> RobotFile:
    """Reads a robot's YAML text; cached, because each scenario needs its robot's."""
    try:
        raw = read_yaml(text) if text.strip() else None
    except Exception as error:  # The parser raises many kinds of exception.
        problem = f"cannot be read: {error}"
        raise RobotDescriptionError("file", text, problem) from error
    if not isinstance(raw, Mapping):
        raise RobotDescriptionError(
            "file", raw, "must have fields of a robot, such as urdf: robot.urdf"
        )
    file: RobotFile = checked(RobotFile, raw)
    pushed = list(dict.fromkeys([file.pelvis, file.chest, *file.hands]))
    return replace(
        file,
        imu_frame=file.imu_frame or file.pelvis,
        pushed=file.pushed or pushed,
    )
