"""What simulation cannot use is repaired or left out, and said."""

import re
import zipfile

import numpy as np
import pytest
from pydrake.geometry import Role
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.systems.framework import DiagramBuilder

from atlas_drake.clients.importing.geometry import Geometry
from atlas_drake.clients.importing.meshes import MeshLibrary, write_hull

from .replaced import limits


def test_what_cannot_be_is_repaired_and_said(imported):
    robot, findings = imported(
        (r'(<link name="trunk">.*?<inertia )[^/]*/>',
         r'\g<1>ixx="9" ixy="0" ixz="0" iyy="1" iyz="0" izz="1" />'),
        (r'(<joint name="right_shoulder" )type="revolute"', r'\1type="prismatic"'),
        (r'(<joint name="left_shoulder".*?<dynamics damping=")[^"]*"', r'\g<1>0"'),
        limits("waist_yaw", 'lower="-1" upper="1" effort="0" velocity="0"'),
        (r"</robot>", '<link name="world"/><joint name="free" type="floating">'
         '<parent link="world"/><child link="hips"/></joint></robot>'),
    )  # fmt: skip
    said = "\n".join(findings.of("repaired") + findings.of("guessed"))
    shoulder = robot.plant.GetJointByName("left_shoulder")
    assert shoulder.default_damping() == pytest.approx(1e-3 * 60.0)
    for words in (
        "inertia that no body has, that of its shape taken: trunk",
        "fixed as prismatic is not simulated: right_shoulder",
        "effort limit 127 N·m, where the file has none or 0: waist",
        "velocity limit 10 rad/s, where the file has none or 0: waist",
        "no parts of the robot, dropped: free, world",
        "damping of 0.001 s/rad of the effort limit, where the file has none or 0: l",
    ):
        assert words in said
    assert "right_shoulder" not in robot.joint_names
    # What was repaired is in the file, for people who open it.
    assert "trunk" in robot.path.read_text().split("urdf:")[0]


def test_what_is_not_simulated_is_said(imported):
    _, findings = imported(
        (r'(<joint name="waist_yaw".*?<dynamics )', r'\1friction="3" '),
        (r'(<link name="left_foot">.*?)(?=<link)',
         r'\1<link name="dummy"><inertial><mass/><inertia ixx="1" ixy="0" ixz="0" '
         'iyy="1" iyz="0" izz="1"/></inertial></link><joint name="d" type="fixed">'
         '<parent link="left_foot"/><child link="dummy"/></joint>'),
    )  # fmt: skip
    said = "\n".join(findings.of("left out"))
    assert "friction of joints, not simulated: waist_yaw" in said
    assert "inertia of links without mass: dummy" in said


def test_a_foot_that_is_too_light_without_its_motors_gets_their_inertia(imported):
    light = (
        r'(<link name="\w+_foot">.*?<mass value=")[^"]*(".*?<inertia )[^/]*/>',
        r'\g<1>0.2\g<2>ixx="1e-5" ixy="0" ixz="0" iyy="2e-4" iyz="0" izz="2e-4" />',
    )
    robot, findings = imported(light)
    (said,) = [text for text in findings.of("guessed") if "rotor inertia" in text]
    assert "left_ankle_roll" in said
    plant = robot.plant
    M = plant.CalcMassMatrix(plant.CreateDefaultContext())
    at = plant.GetJointByName("left_ankle_roll").velocity_start()
    assert M[at, at] == pytest.approx(
        1.2e-4 * robot.mass * robot.com_height**2, rel=0.02
    )
    assert "rotor_inertia" not in imported()[0].urdf.read_text()
    # What a file says of its rotors counts, and the rest is added.
    for given, total in ((1e-5, M[at, at]), (1e-3, 0.1)):
        motor = (
            r"</robot>",
            '<transmission><joint name="left_ankle_roll"/><actuator name="m">'
            f'<drake:rotor_inertia value="{given}"/><drake:gear_ratio value="-10"/>'
            "</actuator></transmission></robot>",
        )
        plant = imported(light, motor)[0].plant
        M_given = plant.CalcMassMatrix(plant.CreateDefaultContext())
        assert M_given[at, at] == pytest.approx(total, rel=0.02)


def test_a_joint_with_hardly_any_range_does_not_forbid_the_pose(imported):
    robot, _ = imported(
        limits("left_shoulder", 'lower="0.1" upper="0.105" effort="9" velocity="9"')
    )
    shoulder = robot.stand_prep[robot.joint_index("left_shoulder")]
    assert shoulder == pytest.approx(0.1025, abs=1e-4)


def test_a_link_without_shape_and_inertia_becomes_a_cube(imported):
    trunk = r'(<link name="trunk">.*?)<inertia .*?(?=</link>)'
    robot, findings = imported((trunk, r"\1</inertial>"))
    assert any(text.endswith("and shape: trunk") for text in findings.of("guessed"))
    inertia = robot.plant.GetBodyByName("trunk").default_spatial_inertia()
    central = inertia.Shift([0.0, 0.0, 0.2]).CalcRotationalInertia()
    size = 0.014 ** (1 / 3)
    np.testing.assert_allclose(central.get_moments(), 14.0 / 6.0 * size**2)


def test_an_inertia_beyond_the_size_of_the_robot_is_none(imported):
    _, findings = imported(
        (r'(<link name="trunk">.*?<inertia )[^/]*/>',
         r'\g<1>ixx="2e4" ixy="0" ixz="0" iyy="2e4" iyz="0" izz="2e4" />')
    )  # fmt: skip
    assert any("no body has" in text for text in findings.of("repaired"))


@pytest.mark.parametrize("rgba", ["0.5 0.5 0.5", "128 128 128 255"])
def test_colors_are_read_as_they_are_meant(imported, rgba):
    robot, _ = imported(
        (r'(<link name="trunk">.*?</geometry>)',
         rf'\1<material name="m"><color rgba="{rgba}"/></material>')
    )  # fmt: skip
    (found,) = re.findall(r'rgba="([^"]*)"', robot.urdf.read_text())
    rgba = [float(one) for one in found.split()]
    assert rgba == pytest.approx([0.5, 0.5, 0.5, 1.0], abs=0.01)


def test_shapes_with_a_size_of_0_are_left_out(imported):
    empty = "".join(
        f"<collision><geometry>{shape}</geometry></collision>"
        for shape in (
            '<sphere radius="0.0"/>',
            '<box size="1 0 1"/>',
            '<cylinder radius="0.1" length="0"/>',
            '<mesh filename="gone.stl" scale="1 1 0"/>',
        )
    )
    robot, findings = imported((r"(?=</link>)", empty))
    assert "shapes with a size of 0: hips, trunk" in findings.of("left out")[0]
    assert robot.urdf.read_text() == imported()[0].urdf.read_text()


@pytest.mark.parametrize(
    ("shape", "name"),
    [
        ('<capsule radius="0.05" length="0.2"/>', "Capsule"),
        ('<drake:capsule radius="0.05" length="0.2"/>', "Capsule"),
        ('<!-- Its size: --><drake:ellipsoid a="0.1" b="0.1" c="0.2"/>', "Ellipsoid"),
        ('<mesh filename="a.obj"><drake:declare_convex/></mesh>', "Convex"),
        ('<cylinder radius="0.1" length="0.2"/>', "Cylinder"),
    ],
)
def test_what_drake_reads_of_a_shape_goes_into_the_robot(
    imported, tmp_path, shape, name
):
    write_hull(np.random.default_rng(0).normal(size=(20, 3)), tmp_path / "a.obj")
    robot, _ = imported(
        (r'(<link name="trunk">.*?<collision>.*?<geometry>).*?(?=</geometry>)',
         rf"\1{shape}"),
        (r'mu_dynamic value="0.6"', 'mu_dynamic value="0.4"'),
    )  # fmt: skip
    builder = DiagramBuilder()
    plant, scene_graph = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    robot.add_to(plant)
    inspector = scene_graph.model_inspector()

    def felt(link):
        body = plant.GetBodyByName(link)
        frame = plant.GetBodyFrameIdOrThrow(body.index())
        (one, *_) = inspector.GetGeometries(frame, Role.kProximity)
        friction = inspector.GetProximityProperties(one).GetProperty(
            "material", "coulomb_friction"
        )
        return type(inspector.GetShape(one)).__name__, friction.dynamic_friction()

    assert felt("trunk") == (name, 0.4)
    assert felt("left_foot") == ("Sphere", 0.9)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("a.zip", "is no mesh: must end in one of .stl, .obj"),
        ("a.3mf", "is no mesh"),
        ("a", "is no mesh"),
        ("huge.stl", "has 1000 MB; must have at most 50"),
        ("wide.obj", "not finite"),
    ],
)
def test_only_meshes_of_a_bounded_size_are_read(tmp_path, name, words):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("a.stl", bytes(100))
    for copy in ("a", "a.3mf"):
        (tmp_path / copy).write_bytes((tmp_path / "a.zip").read_bytes())
    with (tmp_path / "huge.stl").open("wb") as file:
        file.truncate(10**9)
    (tmp_path / "wide.obj").write_text("v 0 0 1e305\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    meshes = MeshLibrary(lambda given: tmp_path / given)
    assert meshes.shape(Geometry("mesh", {"scale": (1e8,)}, name)) == []
    assert words in meshes.lost[name]


def test_a_fixed_joint_stays_where_it_would_be(imported):
    robot, _ = imported(
        (r'(<joint name="right_shoulder" )type="revolute"', r'\1type="prismatic"'),
        limits("right_shoulder", 'lower="0.1" upper="0.4" effort="9" velocity="9"'),
        (r'(<joint name="left_shoulder".*?)(?=<limit)',
         r'\1<mimic joint="waist_yaw" multiplier="1" offset="0.8"/>'),
    )  # fmt: skip
    plant, context = robot.plant, robot.plant.CreateDefaultContext()
    trunk = plant.GetFrameByName("trunk")

    def pose(link):
        return plant.GetFrameByName(link).CalcPose(context, trunk)

    assert pose("right_arm").translation()[1] == pytest.approx(-0.2 + 0.1)
    pitch = pose("left_arm").rotation().ToRollPitchYaw().pitch_angle()
    assert pitch == pytest.approx(0.8)


def test_a_round_sole_is_said(imported):
    foot = (
        r'(<link name="\w+_foot">.*?)<visual>.*?(?=</link>)',
        r'\1<visual><origin xyz="0.03 0 -0.06"/><geometry><cylinder radius="0.1" '
        'length="0.02"/></geometry></visual>',
    )
    _, findings = imported(foot)
    assert any("which fill 7" in text for text in findings.of("guessed"))


def test_collada_files_have_their_own_units(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    path = tmp_path / "a.dae"
    trimesh.creation.box(extents=[1.0, 2.0, 3.0]).export(path)
    text = re.sub(r"<unit[^>]*/>", "", path.read_text())
    path.write_text(text.replace("<asset>", '<asset><unit meter="0.01"/>', 1))

    (read,) = MeshLibrary(lambda name: path).shape(Geometry("mesh", {}, "a.dae"))
    assert sorted(read.extents) == pytest.approx([0.01, 0.02, 0.03])
