"""``atlas-drake import``: limbs found, files repaired, files refused."""

import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from atlas_drake.app.main import main
from atlas_drake.control.feet.leg_kinematics import leg_solver
from atlas_drake.control.pelvis.pelvis_pose import PelvisPose
from atlas_drake.control.pelvis.pelvis_reach import PelvisReach
from atlas_drake.importing.findings import Findings, ImportRefused
from atlas_drake.importing.importer import import_robot
from atlas_drake.importing.meshes import write_hull
from atlas_drake.importing.options import ImportOptions
from atlas_drake.importing.source import find_source, resolve
from atlas_drake.robot import load_robot

HERON = Path(__file__).parents[1] / "robots" / "heron" / "heron.urdf"
PLAIN = re.sub(
    r"<transmission.*?</transmission>|<frame .*?/>", "", HERON.read_text(), flags=re.S
)
"""Heron as somebody might publish it: no motors, no frames of the soles."""


@pytest.fixture
def imported(tmp_path):
    """Imports Heron's URDF with some words replaced; gives robot and findings."""

    def make(*replacements, options=None):
        text = PLAIN
        for old, new in replacements:
            assert re.search(old, text, flags=re.S), old
            text = re.sub(old, new, text, flags=re.S)
        source = tmp_path / "published.urdf"
        source.write_text(text)
        findings = Findings(lambda line: None)
        folder = tmp_path / "made"
        robot = import_robot(source, folder, options or ImportOptions(), findings)
        return robot, findings

    return make


def limits(joint, text):
    return rf'(<joint name="{joint}".*?<limit )[^/]*/>', rf"\g<1>{text} />"


def test_heron_is_found_without_a_word_of_help(imported):
    robot, findings = imported()
    heron = load_robot(HERON.with_suffix(".yaml"))
    assert robot.name == "made"
    assert robot.mass == pytest.approx(heron.mass)
    limbs = {joint.name: joint.limb for joint in robot.file.joints}
    assert limbs == {joint.name: joint.limb for joint in heron.file.joints}
    assert robot.file.pelvis == "hips"
    assert [foot.body for foot in robot.file.feet] == ["left_foot", "right_foot"]
    assert robot.file.sole.length == pytest.approx(heron.file.sole.length, abs=0.025)
    assert robot.file.sole.width == pytest.approx(heron.file.sole.width, abs=0.025)
    # The pose has level soles below the center of mass, with bent knees.
    assert [leg.flexion(robot.stand_prep[leg.knee]) for leg in robot.legs] == (
        pytest.approx([0.7, 0.7], abs=0.1)
    )
    assert findings.of("repaired") == []
    text = robot.path.read_text()
    assert text.startswith("# Imported from published.urdf")
    assert (robot.default_kp > 0.0).all()


@pytest.mark.parametrize(
    ("replacement", "words"),
    [
        (limits("left_knee", 'lower="-0.1" upper="0.1" effort="90" velocity="9"'),
         r"left_knee: goes from -0.1 to 0.1 rad.*needs 0.7: shuffled limits"),
        (limits("left_ankle_pitch", 'lower="0.2" upper="2" effort="90" velocity="9"'),
         r"left_ankle_pitch: goes from 0.2 to 2 rad.*needs about -0.35"),
        (limits("right_knee", 'lower="0" upper="2" effort="4" velocity="9"'),
         r"right_knee: has 4 N·m, and standing on both feet needs"),
        (limits("waist_yaw", 'lower="1" upper="-1" effort="4" velocity="9"'),
         r"waist_yaw: goes from 1 to -1 rad, backward"),
        ((r'(<joint name="left_ankle_roll" type=")revolute', r"\g<1>fixed"),
         r"left leg has 5 moving joints \(left_hip_yaw, .*\); must have 6"),
        ((r'_(hip|knee|ankle)(\w*)" type="revolute"', r'_\1\2" type="fixed"'),
         "there are no two legs"),
        ((r'<mass value="[\d.]+"', '<mass value="-2"'), r"link \w+: its mass is -2 kg"),
        ((r'<child link="left_shank" />', '<child link="nowhere" />'),
         r"joint left_knee: there is no link nowhere"),
        ((r"</robot>", '<link name="stray"/></robot>'),
         "one root link, and has hips, stray"),
        ((r"<robot ", "<robots "), "is no URDF"),
        ((r"</robot>", '<link name="a"/><link name="b"/>'
          '<joint name="ab" type="fixed"><parent link="a"/><child link="b"/></joint>'
          '<joint name="ba" type="fixed"><parent link="b"/><child link="a"/></joint>'
          "</robot>"), "links a, b: hang on each other in a loop"),
        ((r'<mass value="[^"]*"', '<mass value="heavy"'),
         r"link \w+, <mass>: value is 'heavy'; must be a number"),
        (limits("waist_yaw", 'lower="nan" upper="1" effort="4" velocity="9"'),
         r"joint waist_yaw, <limit>: lower is 'nan'; must be a number, finite"),
        ((r"<geometry>.*?</geometry>", "<geometry><capsule/></geometry>"),
         r"link \w+, <\w+>: its geometry is <capsule>; must be one of box, sphere"),
        ((r'(<axis xyz=")0 1 0"', r'\g<1>0 up 0"'),
         r"joint \w+, <axis>: xyz is '0 up 0'; must be 3 numbers"),
        ((r'(<sphere radius=")[^"]*"', r'\g<1>-1"'),
         r"link \w+, <sphere>: radius is '-1'; must be a number, above 0"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_become_a_robot_is_refused(imported, replacement, words):
    with pytest.raises(ImportRefused, match=words):
        imported(replacement)


SHAPELESS = (
    r'(<link name="(?:left|right)_foot">.*?)<(?:visual|collision).*?(?=</link>)',
    r"\1",
)


def test_feet_without_shapes_need_a_word(imported):
    with pytest.raises(ImportRefused, match=r"left_foot: has no shape.*--sole"):
        imported(SHAPELESS)
    told = ImportOptions(sole=(0.2, 0.1, 0.07, 0.03))
    robot, _ = imported(SHAPELESS, options=told)
    assert robot.file.sole.length == 0.2


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


def test_a_robot_that_faces_backward_is_turned(imported):
    ahead, _ = imported()
    # A half turn about z of all that hangs on the hips.
    turned = re.compile(r'(<parent link="hips" />.*?<origin xyz=")([^"]*)"', re.S)

    def half_turn(match):
        x, y, z = map(float, match[2].split())
        return f'{match[1]}{-x} {-y} {z}" rpy="0 0 3.141592653589793"'

    text = turned.sub(half_turn, PLAIN)
    source = ahead.path.parent / "backward.urdf"
    source.write_text(text)
    findings = Findings(lambda line: None)
    back = import_robot(source, source.parent / "back", ImportOptions(), findings)
    assert any("180° from x" in text for text in findings.of("repaired"))
    for mine, its in zip(ahead.legs, back.legs, strict=True):
        np.testing.assert_allclose(mine.p_PT, its.p_PT, atol=1e-9)
    np.testing.assert_allclose(ahead.stand_prep, back.stand_prep, atol=1e-3)


def test_the_soles_are_where_the_feet_reach(imported):
    robot, _ = imported()
    for leg in robot.legs:
        sole = leg.sole
        assert leg_solver(leg)(sole[:3, 3] + [0, 0, 0.1], sole[:3, :3], None)


def test_fingers_are_fixed_or_a_limb(imported):
    fingers = "".join(
        f'<link name="f{k}"><inertial><mass value="0.02"/><inertia ixx="1e-5" '
        'ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial></link>'
        f'<joint name="finger{k}" type="revolute"><parent link="left_arm"/><child '
        f'link="f{k}"/><origin xyz="0 0 {-0.4 - 0.02 * k}"/><axis xyz="0 1 0"/><limit '
        'lower="0" upper="1" effort="1" velocity="5"/></joint>'
        for k in (1, 2)
    )
    hand = (r"</robot>", f"{fingers}</robot>")
    robot, findings = imported(hand)
    assert "finger1, finger2" in "\n".join(findings.of("repaired"))
    assert "finger1" not in robot.joint_names
    robot, _ = imported(hand, options=ImportOptions(fingers=True))
    assert robot.limb("l_hand").sum() == 2


def test_packages_are_found_by_name_manifest_and_option(tmp_path):
    urdf = tmp_path / "bot_description" / "urdf" / "bot.urdf"
    mesh = tmp_path / "bot_description" / "meshes" / "a.stl"
    other = tmp_path / "elsewhere" / "b.stl"
    for path in (urdf, mesh, other):
        path.parent.mkdir(parents=True)
        path.write_text("")
    assert resolve("package://bot_description/meshes/a.stl", urdf, {}) == mesh
    assert resolve("../meshes/a.stl", urdf, {}).resolve() == mesh
    with pytest.raises(FileNotFoundError, match=r"there is no file .*b\.stl"):
        resolve("meshes/b.stl", urdf, {})
    with pytest.raises(FileNotFoundError, match="--package arms=FOLDER"):
        resolve("package://arms/b.stl", urdf, {})
    assert resolve("package://arms/b.stl", urdf, {"arms": other.parent}) == other
    (tmp_path / "bot_description" / "package.xml").write_text(
        "<package><name>renamed</name></package>"
    )
    assert resolve("package://renamed/meshes/a.stl", urdf, {}) == mesh


def test_the_command_writes_robots_and_says_what_is_wrong(
    tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    source = tmp_path / "published.urdf"
    source.write_text(PLAIN)
    assert main(["import", str(source), "--no-trial", "--name", "my_bird"]) == 0
    assert load_robot(tmp_path / "my_bird" / "robot.yaml").name == "my_bird"
    assert "left leg left_hip_yaw" in capsys.readouterr().out
    assert main(["import", "nobody"]) == 2
    assert "nobody: there is no such file" in capsys.readouterr().err
    assert main(["import", "nobody.sdf"]) == 2
    assert "no such .urdf file" in capsys.readouterr().err
    (tmp_path / "taken").write_text("")
    assert main(["import", str(source), "--no-trial", "--out", "taken/bird"]) == 3
    assert re.search("! .*taken.*: (Not a d|File e)", capsys.readouterr().out)
    (tmp_path / "world.sdf").write_text("<sdf/>")
    assert main(["import", "world.sdf"]) == 2
    assert "only URDF is read" in capsys.readouterr().err


@pytest.mark.slow
def test_the_trial_reports_what_the_robot_does(tmp_path, capsys):
    source = tmp_path / "published.urdf"
    source.write_text(PLAIN)
    made = tmp_path / "made"
    assert main(["import", str(source), "--out", str(made)]) == 0
    page = (made / "report.md").read_text()
    assert "| stands | yes |" in page
    assert re.search(r"walks, steps of .* \| yes, feet within \d mm", page)
    assert (made / "report.png").stat().st_size > 20_000
    assert "pushes while it stands: forward" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.skipif(not find_spec("jvrc_description"), reason="needs jvrc-description")
def test_jvrc_walks(tmp_path):
    assert main(["import", "jvrc", "--out", str(tmp_path / "jvrc"), "--no-trial"]) == 0
    robot = load_robot(tmp_path / "jvrc" / "robot.yaml")
    assert robot.num_joints == 32
    # Its ankles roll first.
    assert robot.legs[0].planar is None
    from atlas_drake.importing.trial import try_robot

    trial = try_robot(robot.path, tmp_path / "log.mcap", 0.0, lambda text: None)
    assert trial.walks
    assert trial.pushed
    assert trial.landing < 0.01
    assert find_source("jvrc").name == "jvrc1.urdf"


def test_a_color_may_be_that_of_a_material_of_the_whole_file(imported):
    robot, _ = imported(
        (r"(<robot [^>]*>)", r'\1<material name="sky"><color rgba="0.1 0.2 0.9 1"/>'
         "</material>"),
        (r'(<link name="trunk">.*?<visual>.*?)(<material.*?)?(\s*</visual>)',
         r'\1<material name="sky"/>\3'),
    )  # fmt: skip
    assert 'rgba="0.1 0.2 0.9 1"' in robot.urdf.read_text()


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
    assert M[at, at] == pytest.approx(1e-4 * robot.mass * robot.com_height**2, rel=0.02)
    assert "rotor_inertia" not in imported()[0].urdf.read_text()


def test_the_users_own_file_is_not_written_over(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source = tmp_path / "robot" / "robot.urdf"
    source.parent.mkdir()
    source.write_text(PLAIN)
    for out in ([], ["--out", "robot"], ["--out", "."]):
        assert main(["import", str(source), "--no-trial", *out]) == 2
        assert "holds robot.urdf itself" in capsys.readouterr().err
    assert source.read_text() == PLAIN
    assert [path.name for path in source.parent.iterdir()] == ["robot.urdf"]


def test_knees_of_an_even_range_do_not_turn_the_robot(imported):
    even = (
        r'(<joint name="\w+_knee".*?<limit )lower="[^"]*" upper="[^"]*"',
        r'\g<1>lower="-2.3" upper="2.3"',
    )
    robot, findings = imported(even)
    said = "\n".join(findings.of("repaired") + findings.of("guessed"))
    assert "the knees do not tell where it faces: along x" in said
    assert "from x" not in said
    assert all(robot.stand_prep[leg.knee] > 0.5 for leg in robot.legs)


def test_the_left_foot_is_that_on_the_left(imported):
    told = ImportOptions(feet=("right_foot", "left_foot"))
    robot, _ = imported(options=told)
    assert [foot.body for foot in robot.file.feet] == ["left_foot", "right_foot"]


TOES = "".join(
    f'<link name="{side}_toe"><inertial><mass value="0.1"/><inertia ixx="1e-4" ixy="0" '
    'ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>'
    f'<joint name="{side}_toe_joint" type="revolute"><parent link="{side}_foot"/>'
    f'<child link="{side}_toe"/><origin xyz="0.1 0 -0.05"/><axis xyz="0 1 0"/>'
    '<limit lower="-1" upper="1" effort="5" velocity="5"/></joint>'
    f'<link name="{side}_mount"/><joint name="{side}_mounted" type="fixed">'
    f'<parent link="hips"/><child link="{side}_mount"/></joint>'
    for side in ("left", "right")
)


@pytest.mark.parametrize("feet", [None, ("left_toe", "right_toe")])
def test_toes_are_fixed_also_where_hips_hang_on_mounts(imported, feet):
    robot, findings = imported(
        (r"</robot>", f"{TOES}</robot>"),
        (r'(<joint name="(left|right)_hip_yaw" type="revolute">\s*<parent link=")hips',
         r"\1\2_mount"),
        options=ImportOptions(feet=feet),
    )  # fmt: skip
    assert [foot.body for foot in robot.file.feet] == ["left_foot", "right_foot"]
    assert "left_toe_joint, right_toe_joint" in "\n".join(findings.of("repaired"))


def test_a_root_on_the_ground_is_no_trap_for_the_pelvis(imported):
    robot, _ = imported(
        (r"</robot>", '<link name="base_footprint"/><joint name="above" type="fixed">'
         '<parent link="base_footprint"/><child link="hips"/><origin xyz="0 0 0.9"/>'
         "</joint></robot>")
    )  # fmt: skip
    assert robot.pelvis_height < 0.0
    reach = PelvisReach(robot)
    reach.allows = lambda *_: False
    home = PelvisPose(robot.pelvis_height)
    assert reach.attainable(home, None, None) == home


def test_meshes_of_feet_that_are_not_found_are_named(imported):
    lost = (
        r'(<link name="\w+_foot">.*?)<(?:visual|collision).*?(?=</link>)',
        r'\1<collision><geometry><mesh filename="package://gone/foot.stl"/></geometry>'
        "</collision>",
    )
    with pytest.raises(ImportRefused, match=r"left_foot: .*--package gone=.*--sole"):
        imported(lost)


def test_names_of_links_may_have_any_characters(imported, tmp_path):
    # A mesh of its own for a link whose name is no file's and no plain YAML.
    write_hull(np.eye(4)[:, :3], tmp_path / "trunk.obj")
    name = '*ns/trunk "1"'
    robot, _ = imported(
        (r'link(?: name)?="trunk"',
         lambda found: found[0].replace('"trunk"', f"'{name}'")),
        (rf"(<link name='{re.escape(name)}'>.*?<collision>.*?try>).*?(</geometry>)",
         r'\1<mesh filename="trunk.obj"/>\2'),
    )  # fmt: skip
    assert name in robot.body_names
    assert name in robot.file.pushed


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


def test_a_joint_with_hardly_any_range_does_not_forbid_the_pose(imported):
    robot, _ = imported(
        limits("left_shoulder", 'lower="0.1" upper="0.105" effort="9" velocity="9"')
    )
    shoulder = robot.stand_prep[robot.joint_index("left_shoulder")]
    assert shoulder == pytest.approx(0.1025, abs=1e-4)


@pytest.mark.parametrize("sole", [(-0.2, 0.1, 0.07, 0.0), (0.2, 0.1, np.nan, 0.0)])
def test_a_sole_that_cannot_be_is_refused(imported, sole):
    with pytest.raises(ImportRefused, match=r"--sole .*must be numbers"):
        imported(options=ImportOptions(sole=sole))


def test_one_leg_is_not_two(imported):
    with pytest.raises(ImportRefused, match="--feet: both are left_foot"):
        imported(options=ImportOptions(feet=("left_foot", "left_foot")))
    with pytest.raises(ImportRefused, match="hips and left_foot: are on the same leg"):
        imported(options=ImportOptions(feet=("hips", "left_foot")))
