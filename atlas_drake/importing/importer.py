"""Imports a robot: from its URDF to a folder with which it stands and walks."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from pathlib import Path

from atlas_drake.errors import RobotDescriptionError
from atlas_drake.importing.anatomy import Anatomy, find_anatomy
from atlas_drake.importing.files import (
    SOLES,
    UPRIGHT,
    URDF,
    add_rotors,
    write_urdf,
    write_yaml,
)
from atlas_drake.importing.findings import GUESSED, REPAIRED, Findings, ImportRefused
from atlas_drake.importing.meshes import MeshLibrary
from atlas_drake.importing.options import ImportOptions
from atlas_drake.importing.overlaps import clear_arms, overlapping
from atlas_drake.importing.repairs import (
    drop_virtual_root,
    fix_joints,
    repair_inertias,
    repair_limits,
)
from atlas_drake.importing.soles import Soles, find_soles
from atlas_drake.importing.source import resolve
from atlas_drake.importing.stand_prep import find_stand_prep, parsed
from atlas_drake.importing.tree import Tree
from atlas_drake.robot import (
    FootEntry,
    JointEntry,
    Robot,
    RobotFile,
    SoleSize,
    load_robot,
)


def import_robot(
    source: Path, folder: Path, options: ImportOptions, findings: Findings
) -> Robot:
    """Writes the robot of a URDF into a folder, and loads it from there.

    Args:
        source: The URDF file.
        folder: Where to; it is made.
        options: What need not be found.
        findings: Gets what is found, guessed and repaired.

    Raises:
        ImportRefused: If the file cannot become a robot; it names link or joint.
    """
    if folder.resolve() in source.resolve().parents:
        raise ImportRefused(
            f"{folder} holds {source.name} itself, and the import writes over what is "
            "there; say another folder: --out FOLDER"
        )
    tree = Tree(source)
    meshes = MeshLibrary(partial(resolve, urdf=source, packages=options.packages))
    drop_virtual_root(tree, findings)
    fix_joints(tree, options.fixed, findings)
    anatomy = find_anatomy(tree, options, findings)
    repair_limits(tree, findings)
    repair_inertias(tree, meshes, findings)
    soles = find_soles(tree, anatomy, meshes, options, findings)
    urdf = write_urdf(tree, anatomy, soles, meshes, folder, findings)
    unposed = _robot_file(tree, anatomy, soles)
    file, rotors = find_stand_prep(unposed, parsed(urdf), findings)
    add_rotors(urdf, rotors)
    file = clear_arms(urdf, file, findings)
    file = replace(file, no_collisions=overlapping(urdf, file, findings))
    notes = [text for kind in (REPAIRED, GUESSED) for text in findings.of(kind)]
    path = write_yaml(file, folder, source.name, notes)
    try:
        return load_robot(path)
    except RobotDescriptionError as error:
        raise ImportRefused(f"{error.field}: {error.problem}") from None


def folder_name(source: Path, options: ImportOptions) -> str:
    """Returns the name of the robot, which its folder has."""
    name = options.name or source.stem
    return re.sub(r"[^A-Za-z0-9_-]+", "_", name)


def _robot_file(tree: Tree, anatomy: Anatomy, soles: Soles) -> RobotFile:
    return RobotFile(
        urdf=URDF,
        pelvis=anatomy.pelvis,
        chest=UPRIGHT,
        hands=list(anatomy.hands),
        feet=[
            FootEntry(body=foot, sole_frame=sole)
            for foot, sole in zip(anatomy.feet, SOLES, strict=True)
        ],
        sole=SoleSize(length=soles.length, width=soles.width),
        pushed=list(dict.fromkeys([*anatomy.hands, anatomy.pelvis, anatomy.chest])),
        joints=[
            JointEntry(name=name, limb=limb)  # type: ignore[arg-type]
            for name, limb in anatomy.limbs.items()
        ],
    )
