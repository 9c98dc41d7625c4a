"""Robots: all properties of a robot, read from its YAML file and its URDF.

Nothing here is specific to one robot. The schema of the file is in ``file``, the
required layout of the legs in ``leg``. Control laws and state are elsewhere.
"""

from atlas_drake.robot.file import (
    LEGS,
    LIMBS,
    ContactEntry,
    FootEntry,
    JointEntry,
    RobotFile,
    SoleSize,
)
from atlas_drake.robot.leg import ANKLE_PITCH, HIP_PITCH, KNEE, Leg
from atlas_drake.robot.load import (
    DEFAULT_ROBOT,
    MODELS_FOLDER,
    available_robots,
    find_robot,
    load_robot,
    model_beside,
    read_robot_file,
)
from atlas_drake.robot.parsing import LOCAL_MODELS
from atlas_drake.robot.robot import PelvisParts, PlantIndices, Robot

__all__ = [
    "ANKLE_PITCH",
    "DEFAULT_ROBOT",
    "HIP_PITCH",
    "KNEE",
    "LEGS",
    "LIMBS",
    "LOCAL_MODELS",
    "MODELS_FOLDER",
    "ContactEntry",
    "FootEntry",
    "JointEntry",
    "Leg",
    "PelvisParts",
    "PlantIndices",
    "Robot",
    "RobotFile",
    "SoleSize",
    "available_robots",
    "find_robot",
    "load_robot",
    "model_beside",
    "read_robot_file",
]
