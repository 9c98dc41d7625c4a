"""Reads a robot: by name if it comes with the package, otherwise by path.

Every error about a robot's files carries the file's name. The checks are in ``file``,
``fit`` and ``leg``.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.config import checked, read_fields, read_file
from atlas_drake.errors import (
    RobotDescriptionError,
    ScenarioError,
    did_you_mean,
    shown,
)
from atlas_drake.robot import fit
from atlas_drake.robot.file import TRUNK, RobotFile
from atlas_drake.robot.leg import read_legs
from atlas_drake.robot.parsing import find_urdf
from atlas_drake.robot.robot import Robot, add_urdf, shape_contacts

MODELS_FOLDER = Path(__file__).parent.parent / "models"
DEFAULT_ROBOT = "atlas"
IMPORTED = "robot"
"""Name of an import's YAML file without its ending; its folder has the robot's name."""
_ENDINGS = (".yaml", ".yml")
"""Endings of paths; names have none."""


def available_robots() -> list[str]:
    """Lists the names of the robots in the package, the default first."""
    return names_in(MODELS_FOLDER, DEFAULT_ROBOT)


def imported_robots(*folders: Path) -> dict[str, Path]:
    """Returns the YAML files that imports wrote into folders, by the robots' names."""
    return {
        path.parent.name: path.absolute()
        for folder in folders
        for path in sorted(folder.glob(f"*/{IMPORTED}.yaml"))
    }


def names_in(folder: Path, first: str) -> list[str]:
    """Lists the names of the YAML files in a folder, one of them first."""
    names = sorted(path.stem for path in folder.glob("*.yaml"))
    return sorted(names, key=lambda name: name != first)


def find_data_file(
    given: str | Path,
    folder: Path,
    names: Sequence[str],
    field: str,
    fault: type[RobotDescriptionError | ScenarioError],
) -> Path:
    """Returns the YAML file of a name in a folder, or of a path; raises a ``fault``."""
    if str(given) in names:
        return folder / f"{given}.yaml"
    path = Path(os.path.expanduser(given)).absolute()
    if path.suffix in _ENDINGS and why_not_readable(path) is None:
        return path
    kind = "robot" if field == "model" else field
    what = f"file {path}" if path.suffix in _ENDINGS else f"{kind} {shown(str(given))}"
    hint = did_you_mean(str(given), names)
    problem = f"must be one of {', '.join(names)}, or the path of a file (*.yaml)"
    raise fault(field, str(given), f"there is no {what}; {problem}.{hint}")


def file_beside(given: str, folder: Path, names: Sequence[str]) -> str:
    """Returns a name unchanged, or a path made absolute from ``folder``."""
    if given in names or Path(given).suffix not in _ENDINGS:
        return given
    return str((folder / os.path.expanduser(given)).absolute())


def find_robot(model: str | Path) -> Path:
    """Returns the YAML file of a robot, absolute."""
    names = available_robots()
    return find_data_file(model, MODELS_FOLDER, names, "model", RobotDescriptionError)


def model_beside(model: str, folder: Path) -> str:
    """Returns a robot's name unchanged, or its path made absolute from ``folder``."""
    return file_beside(model, folder, available_robots())


def load_robot(model: str | Path = DEFAULT_ROBOT) -> Robot:
    """Reads one robot.

    Args:
        model: A name from ``available_robots``, or the path of a YAML file, relative
            to the working folder.

    Raises:
        RobotDescriptionError: If there is no such robot, its description or its URDF is
            faulty, they do not match, or the controller cannot use it.
    """
    path = find_robot(model)
    file = read_robot_file(model)
    name = str(model) if str(model) in available_robots() else None
    with _naming(path):
        return _load(path, name, file)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Adds the file's name to an error."""
    try:
        yield
    except (RobotDescriptionError, ScenarioError) as error:
        problem = f"{error.problem} (in {path})"
        raise RobotDescriptionError(error.field, error.value, problem) from None


def _name_of(path: Path) -> str:
    """Returns the name of a robot's file; an import calls all files robot.yaml."""
    return path.parent.name if path.stem == IMPORTED else path.stem


def _load(path: Path, name: str | None, file: RobotFile) -> Robot:
    robot_name = name or _name_of(path)
    builder = DiagramBuilder()
    plant: Any = AddMultibodyPlantSceneGraph(builder, time_step=0.0)[0]
    urdf = find_urdf(path.parent, file.urdf)
    try:
        # With geometry, so that meshes are read, too.
        instance = add_urdf(plant, urdf, robot_name)
    except RuntimeError as error:
        raise RobotDescriptionError("urdf", str(urdf), str(error)) from None
    fit.check_names(plant, instance, file)
    shape_contacts(plant, instance, file)
    plant.Finalize()
    root = builder.Build().CreateDefaultContext()
    pelvis = fit.check_base(plant, file)
    actuators = fit.check_joints(plant, file)
    joints = [plant.GetJointByName(joint.name) for joint in file.joints]
    limits = {
        "lower position": [joint.position_lower_limit() for joint in joints],
        "upper position": [joint.position_upper_limit() for joint in joints],
        "velocity": [joint.velocity_upper_limit() for joint in joints],
        "effort": [actuators[joint.name()].effort_limit() for joint in joints],
    }
    fit.check_limits(file, limits)
    legs = read_legs(plant, pelvis, file)
    context = plant.GetMyMutableContextFromRoot(root)
    pose = fit.check_stand_prep(plant, instance, context, file)
    lower, upper, velocity, effort = map(np.array, limits.values())
    return Robot(
        name=robot_name,
        path=path,
        model=name or str(path),
        file=file,
        joint_names=tuple(joint.name for joint in file.joints),
        position_lower=lower,
        position_upper=upper,
        velocity_limit=velocity,
        effort_limit=effort,
        mass=plant.CalcTotalMass(context),
        com_height=pose.com_height,
        stance_width=pose.stance_width,
        pelvis_height=pose.pelvis_height,
        body_names=tuple(
            plant.get_body(index).name() for index in plant.GetBodyIndices(instance)
        ),
        moved_links=tuple(
            tuple(str(body.name()) for body in plant.GetBodiesWeldedTo(link))
            for link in (joint.child_body() for joint in joints)
        ),
        trunk=plant.GetFrameByName(file.chest, instance).body().name(),
        legs=legs,
    )


def read_robot_file(model: str | Path = DEFAULT_ROBOT) -> RobotFile:
    """Reads a robot's YAML file, and not its URDF."""
    path = find_robot(model)
    with _naming(path):
        return _parsed(read_file(path))


def robot_to_scale_by(model: str | Path) -> Robot | None:
    """Returns the robot; None if the controller's defaults do not scale to it."""
    file = read_robot_file(model)
    if not file.scaled:
        return None
    path = find_robot(model)
    with _naming(path):
        changed = find_urdf(path.parent, file.urdf).stat().st_mtime_ns
    return _scaled_robot(path, path.read_text(), changed)


@functools.lru_cache(maxsize=8)
def _scaled_robot(path: Path, text: str, changed: int) -> Robot:
    """Loads a robot; cached until its files change."""
    return load_robot(path)


@functools.lru_cache(maxsize=8)
def _parsed(text: str) -> RobotFile:
    """Reads a robot's YAML text; cached, because each scenario needs its robot's."""
    file: RobotFile = checked(RobotFile, read_fields(text, "urdf: robot.urdf"))
    return replace(
        file,
        imu_frame=file.imu_frame or file.pelvis,
        pushed=file.pushed or [file.pelvis, TRUNK, *file.hands],
    )
