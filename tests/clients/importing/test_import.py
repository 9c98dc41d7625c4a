"""``atlas-drake import``: limbs found, files repaired, files refused."""

import math
import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from atlas_drake.clients.cli.main import main
from atlas_drake.clients.importing.findings import Findings
from atlas_drake.clients.importing.importer import import_robot
from atlas_drake.clients.importing.meshes import write_hull
from atlas_drake.clients.importing.options import ImportOptions
from atlas_drake.clients.importing.source import find_source, resolve
from atlas_drake.control.feet.leg_kinematics import leg_solver
from atlas_drake.parts.manipulate.pelvis_pose import PelvisPose
from atlas_drake.parts.manipulate.pelvis_reach import PelvisReach
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.systems.pushes import PlannedPush
from atlas_drake.units import GRAVITY

from .replaced import limits

HERON = Path(__file__).parents[2] / "robots" / "heron" / "heron.yaml"


def test_heron_is_found_without_a_word_of_help(imported):
    robot, findings = imported()
    heron = load_robot(HERON)
    assert robot.name == "made"
    assert robot.mass == pytest.approx(heron.mass)
    limbs = {joint.name: joint.limb for joint in robot.file.joints}
    assert limbs == {joint.name: joint.limb for joint in heron.file.joints}
    assert robot.file.pelvis == "hips"
    assert [foot.body for foot in robot.file.feet] == ["left_foot", "right_foot"]
    assert robot.file.sole.length == pytest.approx(heron.file.sole.length, abs=1e-3)
    assert robot.file.sole.width == pytest.approx(heron.file.sole.width, abs=1e-3)
    # The pose has level soles below the center of mass, with bent knees.
    assert [leg.flexion(robot.stand_prep[leg.knee]) for leg in robot.legs] == (
        pytest.approx([0.7, 0.7], abs=0.01)
    )
    assert findings.of("repaired") == []
    text = robot.path.read_text()
    assert text.startswith("# Imported from published.urdf")
    assert (robot.default_kp > 0.0).all()


def test_a_robot_that_faces_backward_is_turned(imported, published):
    ahead, _ = imported()
    # A half turn about z of all that hangs on the hips.
    turned = re.compile(r'(<parent link="hips" />.*?<origin xyz=")([^"]*)"', re.S)

    def half_turn(match):
        x, y, z = map(float, match[2].split())
        return f'{match[1]}{-x} {-y} {z}" rpy="0 0 3.141592653589793"'

    text = turned.sub(half_turn, published)
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
    # A folder of the package's name goes before the bare rest of the path.
    beside = tmp_path / "hand_description" / "meshes" / "a.stl"
    beside.parent.mkdir(parents=True)
    beside.write_text("")
    assert resolve("package://hand_description/meshes/a.stl", urdf, {}) == beside
    with pytest.raises(FileNotFoundError, match="--package arms=FOLDER"):
        resolve("package://arms/b.stl", urdf, {})
    assert resolve("package://arms/b.stl", urdf, {"arms": other.parent}) == other
    (tmp_path / "bot_description" / "package.xml").write_text(
        "<package><name>renamed</name></package>"
    )
    assert resolve("package://renamed/meshes/a.stl", urdf, {}) == mesh


def test_a_tilde_is_the_home_folder(tmp_path, monkeypatch, source, capsys):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "meshes").mkdir()
    given = [f"~/{source.name}", "--package", "bot=~/meshes", "--no-trial"]
    assert main(["import", *given, "--out", "bird"]) == 0
    capsys.readouterr()
    assert main(["import", "~no-such-user/x.urdf"]) == 2
    assert "~no-such-user/x.urdf: there is no such file" in capsys.readouterr().err


def test_the_command_writes_robots_and_says_what_is_wrong(
    source, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    assert main(["import", str(source), "--no-trial", "--out", "my_bird"]) == 0
    assert load_robot(tmp_path / "my_bird" / "robot.yaml").name == "my_bird"
    assert "left leg left_hip_yaw" in capsys.readouterr().out
    assert main(["import", "nobody"]) == 2
    assert "nobody: there is no such file" in capsys.readouterr().err
    assert main(["import", "nobody.sdf"]) == 2
    assert "nobody.sdf: there is no such file" in capsys.readouterr().err
    (tmp_path / "taken").write_text("")
    assert main(["import", str(source), "--no-trial", "--out", "taken/bird"]) == 3
    assert re.search("! .*taken.*: (Not a d|File e)", capsys.readouterr().out)
    (tmp_path / "world.sdf").write_text("<sdf/>")
    assert main(["import", "world.sdf"]) == 2
    assert "only URDF is read" in capsys.readouterr().err


@pytest.mark.slow
def test_the_trial_reports_what_the_robot_does(source, tmp_path, capsys, monkeypatch):
    for name, fewer in {"STANDS": 1.0, "PUSHES": (0.2,)}.items():
        monkeypatch.setattr(f"atlas_drake.clients.importing.trial.{name}", fewer)
    made = tmp_path / "made"
    assert main(["import", str(source), "--out", str(made)]) == 0
    page = (made / "report.md").read_text()
    assert "| stands | yes |" in page
    assert re.search(r"walks, steps of .* \| yes, feet within \d mm", page)
    assert (made / "report.png").stat().st_size > 20_000
    assert "pushes while it stands: forward" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.skipif(not find_spec("jvrc_description"), reason="needs jvrc-description")
def test_jvrc_walks(tmp_path, monkeypatch):
    assert main(["import", "jvrc", "--out", str(tmp_path / "jvrc"), "--no-trial"]) == 0
    robot = load_robot(tmp_path / "jvrc" / "robot.yaml")
    assert robot.num_joints == 32
    # Its ankles roll first.
    assert robot.legs[0].planar is None
    from atlas_drake.clients.importing.trial import try_robot

    monkeypatch.setattr("atlas_drake.clients.importing.trial.PUSHES", (0.2,))
    trial = try_robot(robot.path, tmp_path / "log.mcap", lambda text: None)
    assert trial.walks
    assert len(trial.pushes) == 4
    assert all(trial.pushes.values())
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
    assert name == robot.trunk == robot.pushed_link("trunk")


def test_pushes_on_the_trunk_mean_the_chests_link(imported):
    robot, _ = imported(('"trunk"', '"cage"'))
    assert robot.file.chest not in robot.body_names
    plan = PlannedPush(time=0.0, impulse=1.0)
    sim = AtlasSimulation(Scenario(model=str(robot.path), pushes=[plan]))
    sim.apply_push("trunk", [1.0, 0.0, 0.0], 0.1)
    sim.advance(0.01)
    assert [event.data["body"] for event in sim.events] == ["cage", "cage"]


def below(link, rpy="0 0 0"):
    """A link above the hips, on which they are fixed."""
    return (
        r"</robot>",
        f'<link name="{link}"/><joint name="{link}_joint" type="fixed"><parent '
        f'link="{link}"/><child link="hips"/><origin rpy="{rpy}"/></joint></robot>',
    )


def test_a_robot_may_face_any_way(imported):
    robot, findings = imported(below("base", "0 0 0.5"))
    assert any("faced 29° from x" in text for text in findings.of("repaired"))
    straight, _ = imported()
    assert robot.file.sole == straight.file.sole
    for mine, its in zip(robot.legs, straight.legs, strict=True):
        np.testing.assert_allclose(mine.p_PT, its.p_PT, atol=1e-9)


def test_the_world_turns_the_robot_and_its_furniture_goes(imported):
    tilted = (
        r"</robot>",
        '<link name="world"/><link name="table"/><joint name="there" type="fixed">'
        '<parent link="world"/><child link="table"/></joint><joint name="here" '
        'type="fixed"><parent link="world"/><child link="base"/><origin rpy="0.3 0 0"/>'
        "</joint></robot>",
    )
    robot, findings = imported(below("base", "-0.3 0 0"), tilted)
    assert "table" not in robot.body_names
    assert any("here, world, table" in text for text in findings.of("repaired"))
    for mine, its in zip(robot.legs, imported()[0].legs, strict=True):
        np.testing.assert_allclose(mine.p_PT, its.p_PT, atol=1e-9)


def test_a_robot_may_hang_on_its_trunk(imported):
    robot, findings = imported(
        (r'<parent link="hips" />(\s*)<child link="trunk" />\s*<origin[^/]*/>',
         r'<parent link="trunk" />\1<child link="hips" /><origin xyz="0 0 -0.14"/>'),
    )  # fmt: skip
    assert robot.file.pelvis == "trunk"
    assert any("between the root and the legs: waist_yaw" in text
               for text in findings.of("repaired"))  # fmt: skip


def test_a_camera_beside_an_arm_is_no_arm(imported):
    camera = (
        r'(?=<joint name="left_shoulder")',
        '<link name="camera"><inertial><mass value="0.1"/></inertial></link>'
        '<joint name="pan" type="revolute"><parent link="trunk"/>'
        '<child link="camera"/><origin xyz="0 0.15 0.3"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="5"/></joint>',
    )
    robot, _ = imported(camera)
    assert robot.file.hands == ["left_arm", "right_arm"]
    assert "pan" not in robot.joint_names


def test_the_zero_pose_may_have_bent_knees(imported):
    bent = 0.6
    turns = {"hip_pitch": -bent / 2, "knee": bent, "ankle_pitch": -bent / 2}
    robot, _ = imported(*(
        (rf'(<joint name="\w+_{joint}".*?<origin xyz="[^"]*")',
         rf'\1 rpy="0 {angle} 0"')
        for joint, angle in turns.items()
    ))  # fmt: skip
    flexions = [leg.flexion(robot.stand_prep[leg.knee]) for leg in robot.legs]
    assert flexions == pytest.approx([0.7, 0.7], abs=0.01)


def test_a_weak_knee_is_bent_less(imported):
    weak = limits(r"\w+_knee", 'lower="0" upper="2.3" effort="80" velocity="12"')
    robot, _ = imported(weak)
    for leg in robot.legs:
        flexion = leg.flexion(robot.stand_prep[leg.knee])
        assert 0.35 < flexion < 0.6
        # Standing on one leg takes the same share of any weak knee's torque.
        lever = leg.thigh_length * math.sin(0.5 * flexion)
        assert lever * robot.mass * GRAVITY == pytest.approx(0.4 * 80, rel=0.02)


def test_an_import_keeps_what_people_edited(imported):
    robot, _ = imported()
    edited = robot.path.read_text() + "scaled: true\n"
    robot.path.write_text(edited)
    report = robot.path.with_name("report.md")
    report.write_text("of the import before")
    _, findings = imported()
    assert robot.path.with_name("robot.yaml.old").read_text() == edited
    assert any("now robot.yaml.old" in text for text in findings.of("found"))
    assert not report.exists()


def test_an_interrupted_trial_leaves_the_robot(source, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("atlas_drake.clients.importing.trial.try_robot", interrupted)
    assert main(["import", str(source), "--out", "bird"]) == 130
    assert "bird/robot.yaml is whole, but not tried" in capsys.readouterr().out
    assert load_robot(tmp_path / "bird" / "robot.yaml")
