"""Writes an imported robot: URDF, meshes, and the YAML file that people edit."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import lxml.etree as etree
import numpy as np
import yaml
from pydrake.math import RotationMatrix

from atlas_drake.atomic_write import atomic_write
from atlas_drake.clients.importing.anatomy import Anatomy
from atlas_drake.clients.importing.elements import DRAKE, GEAR_RATIO, ROTOR_INERTIA
from atlas_drake.clients.importing.findings import LOST, Findings, ImportRefused
from atlas_drake.clients.importing.geometry import Geometry
from atlas_drake.clients.importing.meshes import (
    MeshLibrary,
    vertices_of,
    write_hull,
    write_visible,
)
from atlas_drake.clients.importing.soles import Soles
from atlas_drake.clients.importing.tree import Tree
from atlas_drake.errors import printable
from atlas_drake.robot import RobotFile
from atlas_drake.robot.load import IMPORTED

URDF, YAML, MESHES = "robot.urdf", f"{IMPORTED}.yaml", "meshes"
PAGE, PICTURE = "report.md", "report.png"
KEPT = f"{YAML}.old"
"""A robot's file that an import found in its folder, and that somebody may have
edited."""
SOLES = ("l_sole_frame", "r_sole_frame")
UPRIGHT = "chest_upright_frame"
"""Frame of the chest, parallel to the pelvis with all joints at zero."""
EXAMPLE = "# controller: {walk: {limits: {forward: 0.3}}}"
"""Line of a robot's file below which values of its controller stand."""
CONTACT_RADIUS = 0.005
"""Radius of the balls at the corners of each sole [m]."""


def write_urdf(
    tree: Tree,
    anatomy: Anatomy,
    soles: Soles,
    meshes: MeshLibrary,
    folder: Path,
    findings: Findings,
) -> Path:
    """Writes the URDF and the meshes of the tree into a folder.

    Raises:
        ImportRefused: If a link has the name of a frame that is added.
    """
    for name in (*SOLES, UPRIGHT):
        if name in tree.links:
            raise ImportRefused(
                f"link {name}: that is the name of a frame that the import adds"
            )
    (folder / MESHES).mkdir(parents=True, exist_ok=True)
    root = etree.Element("robot", name=folder.name, nsmap={"drake": DRAKE})
    flat: list[str] = []
    for name, link in tree.links.items():
        element = etree.SubElement(root, "link", name=name)
        _add_inertial(element, link.inertial)
        _add_visuals(element, link, tree, meshes, folder)
        body = tree.body_of(name)
        if body not in anatomy.feet:
            flat += _add_hulls(element, name, link, meshes, folder)
        elif name == body:
            _add_corners(element, link, soles, anatomy.feet.index(body))
    for joint in tree.joints.values():
        _add_joint(root, joint, tree.rotors.get(joint.name, {}))
    for name, foot, X_FS in zip(SOLES, anatomy.feet, soles.poses, strict=True):
        _add_frame(root, name, foot, X_FS)
    X = tree.poses()
    upright = np.eye(4)
    upright[:3, :3] = X[anatomy.chest][:3, :3].T
    _add_frame(root, UPRIGHT, anatomy.chest, upright)
    findings.add_about(flat, LOST, "collision shapes without a volume")
    if meshes.lost:
        first, reason = next(iter(meshes.lost.items()))
        findings.add(
            LOST,
            f"{len(meshes.lost)} meshes, neither seen nor felt, such as {first}: "
            f"{reason}",
        )
    path = folder / URDF
    etree.ElementTree(root).write(
        str(path), pretty_print=True, xml_declaration=True, encoding="utf-8"
    )
    return path


def _add_inertial(element: Any, inertial: Any) -> None:
    if inertial is None:
        return
    inside = etree.SubElement(element, "inertial")
    _add_origin(inside, inertial.origin)
    etree.SubElement(inside, "mass", value=_text(inertial.mass))
    inertia = np.asarray(inertial.inertia, dtype=float)
    values = {
        f"i{'xyz'[a]}{'xyz'[b]}": _text(inertia[a, b])
        for a in range(3)
        for b in range(a, 3)
    }
    etree.SubElement(inside, "inertia", **values)


def _add_visuals(
    element: Any, link: Any, tree: Tree, meshes: MeshLibrary, folder: Path
) -> None:
    name = link.name
    for number, shape in enumerate(link.visuals):
        seen = meshes.shape(shape.geometry)
        if not seen:
            continue
        inside = etree.SubElement(element, "visual")
        _add_origin(inside, shape.origin)
        color = tree.color(shape.material)
        if shape.geometry.is_mesh:
            file = f"{MESHES}/{_file_name(name)}_{number}.gltf"
            is_plain = shape.geometry.file.lower().endswith(".stl")
            write_visible(seen, folder / file, color if is_plain else None)
            _add_mesh(inside, file)
            continue
        _add_primitive(inside, shape.geometry)
        if color is not None:
            material = etree.SubElement(inside, "material", name=f"{name}_{number}")
            etree.SubElement(material, "color", rgba=_text(*color))


def _add_hulls(
    element: Any, name: str, link: Any, meshes: MeshLibrary, folder: Path
) -> list[str]:
    """Adds the collision shapes, meshes as their hulls; returns names of flat ones."""
    flat = []
    for number, shape in enumerate(link.collisions):
        felt = meshes.shape(shape.geometry)
        if not felt:
            continue
        file = f"{MESHES}/{_file_name(name)}_{number}.obj"
        is_mesh = shape.geometry.is_mesh
        if is_mesh and not write_hull(vertices_of(felt, np.eye(4)), folder / file):
            flat.append(name)
            continue
        inside = etree.SubElement(element, "collision")
        _add_origin(inside, shape.origin)
        if is_mesh:
            mesh = _add_mesh(inside, file)
            etree.SubElement(mesh, f"{{{DRAKE}}}declare_convex")
        else:
            _add_primitive(inside, shape.geometry)
        _add_properties(inside, shape.geometry)
    return flat


def _add_corners(element: Any, link: Any, soles: Soles, foot: int) -> None:
    """Adds a ball to each corner of a sole, with properties of the foot's shapes."""
    shapes = [shape.geometry for shape in link.collisions if shape.geometry.properties]
    for x in (-0.5, 0.5):
        for y in (-0.5, 0.5):
            corner = np.eye(4)
            corner[:3, 3] = x * soles.length, y * soles.width, CONTACT_RADIUS
            inside = etree.SubElement(element, "collision")
            _add_origin(inside, soles.poses[foot] @ corner)
            geometry = etree.SubElement(inside, "geometry")
            etree.SubElement(geometry, "sphere", radius=_text(CONTACT_RADIUS))
            for shape in shapes[:1]:
                _add_properties(inside, shape)


def _add_properties(inside: Any, shape: Geometry) -> None:
    for properties in shape.properties:
        inside.append(copy.deepcopy(properties))


def _add_mesh(inside: Any, file: str) -> Any:
    geometry = etree.SubElement(inside, "geometry")
    return etree.SubElement(geometry, "mesh", filename=file)


def _add_primitive(inside: Any, shape: Geometry) -> None:
    sizes = {name: _text(*values) for name, values in shape.numbers.items()}
    etree.SubElement(etree.SubElement(inside, "geometry"), shape.tag, **sizes)


def _add_joint(root: Any, joint: Any, rotor: Mapping[str, float]) -> None:
    element = etree.SubElement(root, "joint", name=joint.name, type=joint.type)
    etree.SubElement(element, "parent", link=joint.parent)
    etree.SubElement(element, "child", link=joint.child)
    _add_origin(element, joint.origin)
    if joint.type == "fixed":
        return
    etree.SubElement(element, "axis", xyz=_text(*joint.axis))
    limit = joint.limit
    etree.SubElement(
        element,
        "limit",
        lower=_text(limit.lower),
        upper=_text(limit.upper),
        effort=_text(limit.effort),
        velocity=_text(limit.velocity),
    )
    damping = getattr(joint.dynamics, "damping", None)
    if damping:
        etree.SubElement(element, "dynamics", damping=_text(damping))
    transmission = etree.SubElement(root, "transmission", name=f"{joint.name}_motor")
    kind = etree.SubElement(transmission, "type")
    kind.text = "transmission_interface/SimpleTransmission"
    etree.SubElement(transmission, "joint", name=joint.name)
    actuator = etree.SubElement(transmission, "actuator", name=joint.name)
    for tag, value in rotor.items():
        etree.SubElement(actuator, tag, value=_text(value))


def add_rotors(urdf: Path, inertias: Mapping[str, float]) -> None:
    """Adds rotor inertias to those of the motors of a URDF, at the joints [kg·m²]."""
    tree = etree.parse(str(urdf), etree.XMLParser(remove_blank_text=True))
    for actuator in tree.iterfind("transmission/actuator"):
        inertia = inertias.get(actuator.get("name"))
        if inertia is not None:
            given = {one.tag: float(one.get("value")) for one in actuator}
            ratio = given.get(GEAR_RATIO) or 1.0
            rotor = given.get(ROTOR_INERTIA, 0.0) + inertia / ratio**2
            del actuator[:]
            for tag, value in ((ROTOR_INERTIA, rotor), (GEAR_RATIO, ratio)):
                etree.SubElement(actuator, tag, value=_text(value))
    tree.write(str(urdf), pretty_print=True, xml_declaration=True, encoding="utf-8")


def _add_frame(root: Any, name: str, link: str, X_LF: np.ndarray) -> None:
    etree.SubElement(root, "frame", name=name, link=link, **_pose(X_LF))


def _add_origin(element: Any, X: np.ndarray) -> None:
    etree.SubElement(element, "origin", **_pose(X))


def _pose(X: np.ndarray) -> dict[str, str]:
    """Returns place and angles of a pose as attributes."""
    rotation = RotationMatrix.ProjectToRotationMatrix(X[:3, :3])
    angles = rotation.ToRollPitchYaw().vector()
    return {"xyz": _text(*X[:3, 3]), "rpy": _text(*angles)}


def _text(*numbers: float) -> str:
    return " ".join(f"{float(number) + 0.0:.9g}" for number in numbers)


def write_yaml(
    file: RobotFile, folder: Path, source: str, notes: Sequence[str]
) -> Path:
    """Writes the robot's YAML file, one line per joint, for people to edit."""
    length, width = file.sole.length, file.sole.width
    hands = [f"hands: [{', '.join(map(_name, file.hands))}]"] if file.hands else []
    pairs = [f"- [{_name(a)}, {_name(b)}]" for a, b in file.no_collisions]
    if pairs:
        pairs.insert(0, "no_collisions: # Their shapes overlap.")
    lines = [
        f"# Imported from {printable(source)}. Edit it freely: another import keeps it "
        f"as {KEPT}.",
        *(f"# {note}" for note in notes),
        f"urdf: {file.urdf}",
        f"pelvis: {_name(file.pelvis)}",
        f"chest: {file.chest} # The chest, parallel to the pelvis.",
        *hands,
        "feet:",
        *(
            f"- {{body: {_name(foot.body)}, sole_frame: {foot.sole_frame}}}"
            for foot in file.feet
        ),
        f"sole: {{length: {length:.4f}, width: {width:.4f}}}",
        *pairs,
        "# The controller's values scale with the robot; others go here, as in",
        EXAMPLE,
        "# kp [N·m/rad] and kd [N·m·s/rad] are in force before any command;",
        "# stand_prep [rad] is the pose from which STAND can begin.",
        "joints:",
        *(
            f"- {{name: {_name(joint.name)}, limb: {joint.limb}, kp: {joint.kp:.3g}, "
            f"kd: {joint.kd:.3g}, stand_prep: {_text(joint.stand_prep)}}}"
            for joint in file.joints
        ),
    ]
    path = folder / YAML
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def write_controller(path: Path, values: Mapping[str, Any], why: str) -> None:
    """Adds values of the controller to a file of ``write_yaml``."""
    added = yaml.safe_dump({"controller": values}, default_flow_style=None)
    text = path.read_text(encoding="utf-8")
    text = text.replace(EXAMPLE, f"{EXAMPLE}\n# {why}\n{added.rstrip()}", 1)
    with atomic_write(path) as new:
        new.write_text(text, encoding="utf-8")


def _name(text: str) -> str:
    """Returns a name as YAML reads it back."""
    plain = re.fullmatch(r"[A-Za-z_][\w./-]*", text) and yaml.safe_load(text) == text
    return text if plain else json.dumps(text, ensure_ascii=not text.isprintable())


def _file_name(link: str) -> str:
    """Returns a name for files, another one for each link."""
    return re.sub(r"[^\w.]", lambda found: f"-{ord(found[0]):x}-", link)
