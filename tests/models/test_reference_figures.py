"""The figures of the models are those of the original URDF files.

The original files are not part of this repository. ATLAS_DRAKE_REFERENCE names a
folder with ``drcsim/`` in it; without it the tests are skipped.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Box
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from pydrake.systems.framework import DiagramBuilder

REFERENCE = Path(os.environ.get("ATLAS_DRAKE_REFERENCE", "no such folder")) / "drcsim"
FILES = {"atlas": "atlas_v3_with_v1_inertia.urdf", "atlas_v3": "atlas_v3.urdf"}
LIMITS = (
    "position_lower_limit",
    "position_upper_limit",
    "velocity_lower_limit",
    "velocity_upper_limit",
    "default_damping",
)

pytestmark = pytest.mark.skipif(
    not REFERENCE.is_dir(),
    reason="ATLAS_DRAKE_REFERENCE names no folder with the original URDF files",
)

MOMENTS = [0.0039688, 0.0041178, 0.0035243, -1.5797e-06, -0.00089293, -6.8415e-07]
HEAD = SpatialInertia(
    1.41984, np.zeros(3), UnitInertia(*(np.array(MOMENTS) / 1.41984))
).Shift(-np.array([-0.075493, 3.3383e-05, 0.02774]))
"""The sensor head about its joint; no reference URDF holds it."""


def _original(name: str) -> str:
    """The text of an original, with the head that it lacks and without meshes."""
    text = (
        (REFERENCE / name)
        .read_text()
        .replace("</robot>", '<link name="head"/></robot>')
    )
    return re.sub(
        r"<(visual|collision)\b(?:(?!</\1>).)*\.dae.*?</\1>", "", text, flags=re.S
    )


@pytest.fixture
def reference(robot) -> MultibodyPlant:
    """The original of a robot."""
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModelsFromString(_original(FILES[robot.name]), "urdf")
    plant.Finalize()
    return plant


def test_spatial_inertias(robot, reference):
    plant, context = robot.plant, robot.plant.CreateDefaultContext()
    theirs = reference.CreateDefaultContext()
    for index in plant.GetBodyIndices(robot.instance):
        body = plant.get_body(index)
        expected = HEAD
        if body.name() != "head":
            # A camera is a link of its own there, fixed to its carrier.
            link = reference.GetBodyByName(body.name())
            parts = [part.index() for part in reference.GetBodiesWeldedTo(link)]
            expected = reference.CalcSpatialInertia(theirs, link.body_frame(), parts)
        found = body.CalcSpatialInertiaInBodyFrame(context)
        np.testing.assert_allclose(
            found.CopyToFullMatrix6(),
            expected.CopyToFullMatrix6(),
            rtol=1e-9,
            atol=1e-10,
            err_msg=body.name(),
        )


def test_joints(robot, reference):
    plant, context = robot.plant, robot.plant.CreateDefaultContext()
    theirs = reference.CreateDefaultContext()
    text = (REFERENCE / FILES[robot.name]).read_text()
    for actuator in robot.actuators:
        joint = actuator.joint()
        expected = reference.GetJointByName(joint.name())
        assert joint.child_body().name() == expected.child_body().name()
        for name in LIMITS:
            assert getattr(joint, name)() == getattr(expected, name)(), joint.name()
        np.testing.assert_allclose(joint.revolute_axis(), expected.revolute_axis())
        carrier = reference.GetBodyByName(joint.parent_body().name())
        assert (
            joint.frame_on_child()
            .CalcPose(context, plant.GetBodyByName(carrier.name()).body_frame())
            .IsNearlyEqualTo(
                expected.frame_on_child().CalcPose(theirs, carrier.body_frame()), 1e-12
            )
        )
        found = re.search(
            rf'<joint name="{joint.name()}".*?effort="([^"]*)"', text, re.S
        )
        assert actuator.effort_limit() == float(found[1])


def test_camera_frames(robot, reference):
    context, theirs = (one.CreateDefaultContext() for one in (robot.plant, reference))
    joints = map(reference.get_joint, reference.GetJointIndices())
    cameras = [joint for joint in joints if joint.name().endswith("camera_joint")]
    assert len(cameras) == 3
    for camera in cameras:
        names = camera.child_body().name(), camera.parent_body().name()
        frame, parent = map(robot.plant.GetFrameByName, names)
        expected = camera.frame_on_child().CalcPose(
            theirs, camera.parent_body().body_frame()
        )
        assert frame.CalcPose(context, parent).IsNearlyEqualTo(expected, 1e-9)


@pytest.mark.parametrize("side", ["l", "r"])
def test_sole_is_the_bottom_of_the_reference_foot(robot, side):
    simple, scene_graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
    text = _original("atlas_v3_simple_shapes.urdf")
    Parser(simple).AddModelsFromString(text, "urdf")
    inspector = scene_graph.model_inspector()
    foot = simple.GetBodyByName(f"{side}_foot")
    (geometry,) = simple.GetCollisionGeometriesForBody(foot)
    box = inspector.GetShape(geometry)
    assert isinstance(box, Box)
    center = inspector.GetPoseInFrame(geometry).translation()
    corners = [center + 0.5 * box.size() * [i, j, -1] for i in (-1, 1) for j in (-1, 1)]

    body = robot.plant.GetBodyByName(f"{side}_foot")
    inspector = robot.scene_graph.model_inspector()
    lowest = [
        inspector.GetPoseInFrame(geometry).translation()
        - [0.0, 0.0, inspector.GetShape(geometry).radius()]
        for geometry in robot.plant.GetCollisionGeometriesForBody(body)
    ]
    assert {tuple(p.round(9)) for p in lowest} == {tuple(p.round(9)) for p in corners}
    X_FS = robot.plant.GetFrameByName(f"{side}_sole").CalcPose(
        robot.plant.CreateDefaultContext(), body.body_frame()
    )
    np.testing.assert_allclose(X_FS.translation(), np.mean(corners, axis=0))
    assert X_FS.rotation().IsExactlyIdentity()
