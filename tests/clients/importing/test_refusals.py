"""What cannot become a robot is refused by its name, and what is there stays."""

import numpy as np
import pytest

from atlas_drake.clients.cli.main import main
from atlas_drake.clients.importing.findings import ImportRefused
from atlas_drake.clients.importing.options import ImportOptions

from .replaced import limits


@pytest.mark.parametrize(
    ("replacement", "words"),
    [
        (limits("left_knee", 'lower="-0.1" upper="0.1" effort="90" velocity="9"'),
         r"left_knee: goes from -0.1 to 0.1 rad.*needs 0.7: shuffled limits"),
        (limits("left_ankle_pitch", 'lower="0.2" upper="2" effort="90" velocity="9"'),
         r"left_ankle_pitch: goes from 0.2 to 2 rad.*needs about -0.35"),
        (limits("right_knee", 'lower="0" upper="2" effort="4" velocity="9"'),
         r"right_knee: has 4 N·m, and standing on both feet needs"),
        # The trunk's center of mass lies ahead of a waist that pitches.
        ((r'(<link name="trunk">.*?<origin xyz=")0(.*?<axis xyz=")0 0 1(.*?effort=")80',
          r'\g<1>0.1\g<2>0 1 0\g<3>9'), r"waist_yaw: has 9 N·m, and standing .* needs"),
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
        ((r"<geometry>.*?</geometry>", "<geometry><plane/></geometry>"),
         r"link \w+, <\w+>: its geometry is <plane>; must be one of box, sphere"),
        ((r"<geometry>.*?</geometry>", "<geometry></geometry>"),
         r"link \w+, <\w+>: its geometry is nothing; must be one of box, sphere"),
        ((r"<box [^/]*/>", '<drake:ellipsoid a="1" b="2"/>'),
         r"link hips, <drake:ellipsoid>: has no c"),
        ((r"</visual>", '<material><color rgba="1 0"/></material></visual>'),
         r"link \w+, <color>: rgba is '1 0'; must be 4 numbers"),
        ((r"</visual>", '<material><color rgba="1 nan 0 1"/></material></visual>'),
         r"link \w+, <color>: rgba is '1 nan 0 1'; must be 4 numbers, finite"),
        ((r"(<robot [^>]*>)", r'\1<material name="sky"><color rgba="1 red 0 1"/>'
          "</material>"), r"material sky, <color>: rgba is '1 red 0 1'; must be 4 num"),
        ((r'(<joint name="left_knee".*?)(?=<limit)',
          r'\1<mimic joint="waist_yaw" offset="much"/>'),
         r"joint left_knee, <mimic>: offset is 'much'; must be a number"),
        ((r"</robot>", '<transmission name="t"><joint name="waist_yaw"/><actuator>'
          '<drake:rotor_inertia value="x"/></actuator></transmission></robot>'),
         r"transmission t, <drake:rotor_inertia>: value is 'x'; must be a number"),
        ((r'mu_static value="0.6"', 'mu_static value="nan"'),
         r"link \w+, <drake:mu_static>: value is 'nan'; must be a number, finite"),
        ((r'(<axis xyz=")0 1 0"', r'\g<1>0 up 0"'),
         r"joint \w+, <axis>: xyz is '0 up 0'; must be 3 numbers"),
        ((r'(<sphere radius=")[^"]*"', r'\g<1>-1"'),
         r"link \w+, <sphere>: radius is '-1'; must be a number, not below 0"),
        ((r"</robot>", '<link name="trunk"/></robot>'), "link trunk: is there twice"),
        ((r'joint name="left_knee"', 'joint name="right_knee"'),
         "joint right_knee: is there twice"),
        ((r'(name="left_knee" type=")revolute', r"\g<1>wobbly"),
         "joint left_knee: its type is 'wobbly'; must be one of revolute"),
        ((r'<child link="left_shank" />', ""), "joint left_knee, <joint>: has no <chi"),
        ((r'<box size="[^"]*"', "<box"), r"link \w+, <box>: has no size"),
        ((r"<inertial>.*?</inertial>", ""), "all links have 0 kg together"),
        ((r'<dynamics damping="[^"]*"', '<dynamics damping="-1"'),
         r"joint \w+, <dynamics>: damping is '-1'; must be a number, not below 0"),
        ((r'<dynamics damping="[^"]*"', '<dynamics friction="lots"'),
         r"joint \w+, <dynamics>: friction is 'lots'; must be a number"),
        ((r'xyz="0 0 0.14"', 'xyz="0 0 1e300"'), r"joint waist_yaw, <origin>: xyz is"),
        ((r'"trunk"', '"l_sole_frame"'), "link l_sole_frame: that is the name of a fr"),
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


MESH = '<geometry><mesh filename="package://gone/foot.stl"/></geometry>'
BALL = '<geometry><sphere radius="0.01"/></geometry>'


@pytest.mark.parametrize(
    ("collisions", "words"),
    [([MESH], "has no shape"), ([BALL], "a point"), ([BALL, MESH], "a point.*gone=")],
)
def test_feet_whose_shapes_are_not_all_there_need_a_word(imported, collisions, words):
    shapes = "".join(f"<collision>{one}</collision>" for one in collisions)
    foot = r'(<link name="\w+_foot">.*?)'
    lost = (rf"{foot}<(?:visual|collision).*?(?=</link>)", rf"\1{shapes}")
    with pytest.raises(ImportRefused, match=f"left_foot: .*{words}.*--sole"):
        imported(lost)
    # The visible shapes tell it, too.
    robot, findings = imported((rf"{foot}<collision.*?(?=</link>)", rf"\1{shapes}"))
    assert robot.file.sole.length == pytest.approx(0.2)
    assert any("from the visual shapes" in text for text in findings.of("guessed"))


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"chest": "left_foot"}, "--chest left_foot: is no link of the trunk, hips"),
        ({"chest": "head"}, "--chest: there is no link head"),
        (
            {"hands": ("left_foot", "right_foot")},
            "--hands left_foot right_foot: are no",
        ),
        ({"faces": "-x"}, r"knee: goes from .*shuffled limits, .*\(--faces\)"),
        ({"sole": (-0.2, 0.1, 0.07, 0.0)}, r"--sole .*must be numbers"),
        ({"sole": (0.2, 0.1, np.nan, 0.0)}, r"--sole .*must be numbers"),
        ({"sole": (0.2, 0.1, -0.7, 0.0)}, r"--sole .*must be numbers"),
        ({"feet": ("left_foot", "left_foot")}, "--feet: both are left_foot"),
        ({"feet": ("hips", "left_foot")}, "hips and left_foot: are on the same leg"),
    ],
)
def test_what_the_user_says_is_checked(imported, told, words):
    with pytest.raises(ImportRefused, match=words):
        imported(options=ImportOptions(**told))


def test_a_refused_file_leaves_the_folder_as_it_was(imported):
    robot, _ = imported()
    folder = robot.path.parent
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    with pytest.raises(ImportRefused, match="shuffled efforts"):
        imported(limits("right_knee", 'lower="0" upper="2" effort="4" velocity="9"'))
    assert before == {path: path.read_bytes() for path in before}
    assert sorted(path.name for path in folder.parent.iterdir()) == [
        folder.name, "published.urdf"
    ]  # fmt: skip


def test_the_users_own_file_is_not_written_over(
    published, tmp_path, capsys, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    source = tmp_path / "robot" / "robot.urdf"
    source.parent.mkdir()
    source.write_text(published)
    for out in ([], ["--out", "robot"], ["--out", "."]):
        assert main(["import", str(source), "--no-trial", *out]) == 2
        assert "holds robot.urdf itself" in capsys.readouterr().err
    linked = tmp_path / "linked" / "robot.urdf"
    linked.parent.mkdir()
    linked.symlink_to(source)
    assert main(["import", str(linked), "--no-trial", "--out", "linked"]) == 2
    assert source.read_text() == published
    assert [path.name for path in source.parent.iterdir()] == ["robot.urdf"]
