"""Robots: all properties of a robot, read from its YAML file and its URDF.

Nothing here is specific to one robot. The schema of the file is in ``file``, the
legs in ``leg``. Control laws and state are elsewhere.
"""

from atlas_drake.robot.file import (
    LEGS,
    LIMBS,
    TRUNK,
    ContactEntry,
    FootEntry,
    JointEntry,
    RobotFile,
    SoleSize,
)
from atlas_drake.robot.leg import KNEE, Leg
from atlas_drake.robot.load import (
    DEFAULT_ROBOT,
    MODELS_FOLDER,
    available_robots,
    find_robot,
    load_robot,
    model_beside,
    read_robot_file,
    robot_to_scale_by,
)
from atlas_drake.robot.parsing import LOCAL_MODELS
from atlas_drake.robot.robot import ATLAS, PelvisParts, PlantIndices, Robot, Size

__all__ = [
    "ATLAS",
    "DEFAULT_ROBOT",
    "KNEE",
    "LEGS",
    "LIMBS",
    "LOCAL_MODELS",
    "MODELS_FOLDER",
    "TRUNK",
    "ContactEntry",
    "FootEntry",
    "JointEntry",
    "Leg",
    "PelvisParts",
    "PlantIndices",
    "Robot",
    "RobotFile",
    "Size",
    "SoleSize",
    "available_robots",
    "find_robot",
    "load_robot",
    "model_beside",
    "read_robot_file",
    "robot_to_scale_by",
]
