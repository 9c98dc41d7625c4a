"""Every figure of the robots against its source, the original URDF files.

These files are not part of this repository. ATLAS_DRAKE_REFERENCE names a folder with
``drcsim/`` in it; without it the tests are skipped.
"""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.tree import RevoluteJoint, SpatialInertia, UnitInertia

REFERENCE = Path(os.environ.get("ATLAS_DRAKE_REFERENCE", "no such folder")) / "drcsim"
FILES = {"atlas": "atlas_v3_with_v1_inertia.urdf", "atlas_v3": "atlas_v3.urdf"}

pytestmark = pytest.mark.skipif(
    not REFERENCE.is_dir(),
    reason="ATLAS_DRAKE_REFERENCE names no folder with the original URDF files",
)


def _vector(element: ET.Element | None, attribute: str) -> np.ndarray:
    if element is None:
        return np.zeros(3)
    return np.array(element.get(attribute, "0 0 0").split(), dtype=float)


def _pose(element: ET.Element | None) -> RigidTransform:
    rpy = RollPitchYaw(_vector(element, "rpy"))
    return RigidTransform(rpy, _vector(element, "xyz"))


def _spatial_inertia(link: ET.Element) -> SpatialInertia:
    """Returns M_LLo_L, read without the help of a parser."""
    inertial = link.find("inertial")
    assert inertial is not None
    mass = float(inertial.find("mass").get("value"))  # type: ignore[union-attr, arg-type]
    origin = inertial.find("origin")
    assert not np.any(_vector(origin, "rpy"))
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    inertia = inertial.find("inertia")
    assert inertia is not None
    figures = [float(inertia.get(name, "nan")) / mass for name in names]
    about_center = SpatialInertia(mass, np.zeros(3), UnitInertia(*figures))
    return about_center.Shift(-_vector(origin, "xyz"))


HEAD = SpatialInertia(
    1.41984,
    np.zeros(3),
    UnitInertia(
        *(
            np.array(
                [0.0039688, 0.0041178, 0.0035243, -1.5797e-06, -0.00089293, -6.8415e-07]
            )
            / 1.41984
        )
    ),
).Shift(-np.array([-0.075493, 3.3383e-05, 0.02774]))
"""The sensor head about its joint; no reference URDF holds it."""


@pytest.fixture
def reference(robot) -> ET.Element:
    return ET.parse(REFERENCE / FILES[robot.name]).getroot()


def test_spatial_inertias(robot, reference):
    expected = {
        link.get("name"): _spatial_inertia(link)
        for link in reference.iter("link")
        if link.find("inertial") is not None
    }
    expected["head"] = HEAD
    for joint in reference.iter("joint"):
        child = joint.find("child").get("link")
        if joint.get("type") != "fixed" or child not in expected:
            continue
        # A camera: its inertia becomes part of the link that it is fixed to.
        X_PC = _pose(joint.find("origin"))
        camera = expected.pop(child).ReExpress(X_PC.rotation())
        expected[joint.find("parent").get("link")] += camera.Shift(-X_PC.translation())
    assert len(expected) == 29

    context = robot.plant.CreateDefaultContext()
    for name, inertia in expected.items():
        body = robot.plant.GetBodyByName(name)
        actual = body.CalcSpatialInertiaInBodyFrame(context)
        assert actual.get_mass() == pytest.approx(inertia.get_mass(), rel=1e-10)
        np.testing.assert_allclose(
            actual.get_com(), inertia.get_com(), atol=1e-10, err_msg=name
        )
        np.testing.assert_allclose(
            actual.CopyToFullMatrix6(),
            inertia.CopyToFullMatrix6(),
            rtol=1e-9,
            atol=1e-10,
            err_msg=name,
        )


def test_joints(robot, reference):
    revolute = [j for j in reference.iter("joint") if j.get("type") == "revolute"]
    assert len(revolute) == 28
    efforts = {a.joint().name(): a.effort_limit() for a in robot.actuators}
    context = robot.plant.CreateDefaultContext()
    for expected in revolute:
        name = expected.get("name")
        joint = robot.plant.GetJointByName(name)
        assert isinstance(joint, RevoluteJoint)
        assert joint.parent_body().name() == expected.find("parent").get("link")
        assert joint.child_body().name() == expected.find("child").get("link")

        X_PF = joint.frame_on_parent().CalcPose(
            context, joint.parent_body().body_frame()
        )
        X_CM = joint.frame_on_child().CalcPose(context, joint.child_body().body_frame())
        assert X_PF.IsNearlyEqualTo(_pose(expected.find("origin")), 1e-12), name
        assert X_CM.IsNearlyEqualTo(RigidTransform(), 1e-12), name
        axis = _vector(expected.find("axis"), "xyz")
        np.testing.assert_allclose(
            joint.revolute_axis(), axis / np.linalg.norm(axis), atol=1e-9, err_msg=name
        )

        limit = expected.find("limit")
        assert joint.position_lower_limit() == float(limit.get("lower")), name
        assert joint.position_upper_limit() == float(limit.get("upper")), name
        assert joint.velocity_upper_limit() == float(limit.get("velocity")), name
        assert joint.velocity_lower_limit() == -float(limit.get("velocity")), name
        assert efforts[name] == float(limit.get("effort")), name
        damping = float(expected.find("dynamics").get("damping"))
        assert joint.default_damping() == damping, name


def test_camera_frames(robot, reference):
    context = robot.plant.CreateDefaultContext()
    cameras = [
        joint
        for joint in reference.iter("joint")
        if joint.get("name").endswith("camera_joint")
    ]
    assert len(cameras) == 3
    for camera in cameras:
        frame = robot.plant.GetFrameByName(camera.find("child").get("link"))
        parent = robot.plant.GetFrameByName(camera.find("parent").get("link"))
        expected = _pose(camera.find("origin"))
        assert frame.CalcPose(context, parent).IsNearlyEqualTo(expected, 1e-9)


@pytest.mark.parametrize("side", ["l", "r"])
def test_sole_is_the_bottom_of_the_reference_foot(robot, side):
    shapes = ET.parse(REFERENCE / "atlas_v3_simple_shapes.urdf").getroot()
    (foot,) = [x for x in shapes.iter("link") if x.get("name") == f"{side}_foot"]
    (collision,) = foot.findall("collision")
    center = _vector(collision.find("origin"), "xyz")
    size = _vector(collision.find("geometry/box"), "size")
    corners = {
        (
            round(center[0] + i * size[0] / 2, 9),
            round(center[1] + j * size[1] / 2, 9),
            round(center[2] - size[2] / 2, 9),
        )
        for i in (-1, 1)
        for j in (-1, 1)
    }

    body = robot.plant.GetBodyByName(f"{side}_foot")
    inspector = robot.scene_graph.model_inspector()
    lowest = set()
    for geometry in robot.plant.GetCollisionGeometriesForBody(body):
        p_FG = inspector.GetPoseInFrame(geometry).translation()
        p_FL = p_FG - [0.0, 0.0, inspector.GetShape(geometry).radius()]
        lowest.add(tuple(round(float(value), 9) for value in p_FL))
    assert lowest == corners

    X_FS = robot.plant.GetFrameByName(f"{side}_sole").CalcPose(
        robot.plant.CreateDefaultContext(), body.body_frame()
    )
    np.testing.assert_allclose(X_FS.translation(), np.mean(list(corners), axis=0))
    assert X_FS.rotation().IsExactlyIdentity()
