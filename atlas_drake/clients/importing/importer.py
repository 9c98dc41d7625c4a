"""Imports a robot: from its URDF to a folder with which it stands and walks."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from atlas_drake.clients.importing.anatomy import Anatomy, find_anatomy
from atlas_drake.clients.importing.files import (
    KEPT,
    MESHES,
    PAGE,
    PICTURE,
    SOLES,
    UPRIGHT,
    URDF,
    YAML,
    add_rotors,
    write_urdf,
    write_yaml,
)
from atlas_drake.clients.importing.findings import (
    FOUND,
    GUESSED,
    REPAIRED,
    Findings,
    ImportRefused,
)
from atlas_drake.clients.importing.inertias import repair_inertias
from atlas_drake.clients.importing.meshes import MeshLibrary
from atlas_drake.clients.importing.options import ImportOptions
from atlas_drake.clients.importing.overlaps import Shapes, clear_arms, overlapping
from atlas_drake.clients.importing.repairs import (
    drop_shapes,
    drop_virtual_root,
    fix_joints,
    repair_limits,
)
from atlas_drake.clients.importing.soles import Soles, find_soles
from atlas_drake.clients.importing.source import resolve
from atlas_drake.clients.importing.stand_prep import find_stand_prep
from atlas_drake.clients.importing.tree import Tree
from atlas_drake.errors import RobotDescriptionError
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
        ImportRefused: If the file cannot become a robot; it names link or joint. What
            is in the folder stays as it was.
    """
    if folder.resolve() in source.resolve().parents or folder in source.parents:
        raise ImportRefused(
            f"{folder} holds {source.name} itself, and the import writes over what is "
            "there; say another folder: --out FOLDER"
        )
    folder.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=".import-", dir=folder.parent) as temporary:
        made = Path(temporary) / folder.name
        _make(source, made, options, findings)
        _move(made, folder, findings)
    return load_robot(folder / YAML)


def _move(made: Path, folder: Path, findings: Findings) -> None:
    """Puts what was made in the place of an earlier import; keeps its edited file."""
    folder.mkdir(exist_ok=True)
    before, new = folder / YAML, made / YAML
    if before.exists() and before.read_bytes() != new.read_bytes():
        before.replace(folder / KEPT)
        findings.add(FOUND, f"another {YAML} in the folder, now {KEPT}")
    shutil.rmtree(folder / MESHES, ignore_errors=True)
    for name in (PAGE, PICTURE):
        (folder / name).unlink(missing_ok=True)
    for path in made.iterdir():
        path.replace(folder / path.name)


def _make(
    source: Path, folder: Path, options: ImportOptions, findings: Findings
) -> None:
    """Writes the robot, and loads it for a check."""
    tree = Tree(source)
    meshes = MeshLibrary(partial(resolve, urdf=source, packages=options.packages))
    drop_virtual_root(tree, findings)
    drop_shapes(tree, findings)
    fix_joints(tree, options.fixed, findings)
    anatomy = find_anatomy(tree, options, findings)
    repair_limits(tree, findings)
    repair_inertias(tree, meshes, findings)
    soles = find_soles(tree, anatomy, meshes, options, findings)
    urdf = write_urdf(tree, anatomy, soles, meshes, folder, findings)
    unposed = _robot_file(tree, anatomy, soles)
    try:
        file, rotors = find_stand_prep(unposed, urdf, findings)
        add_rotors(urdf, rotors)
        shapes = Shapes(urdf, file)
        file = clear_arms(shapes, file, findings)
        file = replace(file, no_collisions=overlapping(shapes, file, findings))
        notes = [text for kind in (REPAIRED, GUESSED) for text in findings.of(kind)]
        load_robot(write_yaml(file, folder, source.name, notes))
    except RobotDescriptionError as error:
        raise ImportRefused(f"{error.field}: {error.problem}") from None
    except RuntimeError as error:
        raise ImportRefused(f"Drake does not read the robot: {error}") from None


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
        joints=[
            JointEntry(name=name, limb=limb)  # type: ignore[arg-type]
            for name, limb in anatomy.limbs.items()
        ],
    )
