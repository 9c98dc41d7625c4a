"""The description of a robot that is not Atlas: values read, and faults refused."""

import logging
import re

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.control.feet.leg_kinematics import solve_leg
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.errors import RobotDescriptionError
from atlas_drake.robot import load_robot
from atlas_drake.shipped import BEHAVIORS


def test_heron_has_other_joints_and_legs_than_atlas(heron):
    atlas = load_robot()
    assert heron.num_joints == 15
    assert heron.mass == pytest.approx(43.2)
    assert not set(heron.joint_names) & set(atlas.joint_names)
    leg = heron.legs[0]
    assert (leg.thigh_length, leg.shank_length) == pytest.approx((0.32, 0.32))
    assert leg.straight == 0.0
    assert heron.joint_names[leg.knee] == "left_knee"
    # All that moves with the hip is on the leg: its six bodies.
    assert leg.distal_mass[0] == pytest.approx(8.8)
    assert leg.distal_mass[-1] == pytest.approx(1.0)
    assert heron.contact("left fist").frame == "left_fist"
    with pytest.raises(RobotDescriptionError, match="left fist, right fist"):
        heron.contact("nose")


@pytest.mark.parametrize("foot", [0, 1])
def test_the_legs_have_the_closed_form(heron, foot):
    model = WholeBodyModel(heron)
    random = np.random.default_rng(foot)
    state = np.zeros(model.num_states)
    state[0] = 1.0
    leg = heron.legs[foot]
    for _ in range(10):
        low, high = heron.position_lower, heron.position_upper
        q = random.uniform(0.6 * low, 0.6 * high)
        q[leg.knee] = random.uniform(0.2, 1.5)
        state[heron.indices(model.plant).q] = q
        terms = model.evaluate(model.create_context(), state)
        sole = terms.feet[foot]
        held = solve_leg(leg, sole.p_WF - terms.p_WP, sole.R_WF)
        np.testing.assert_allclose(held.angles, q[leg.joints], atol=1e-9)


WAIST = '<limit lower="-1" upper="1" effort="80" velocity="8" />'
HIPS, THIGH = '<link name="hips">', '<link name="left_thigh">'


def with_mesh(link, kind, mesh):
    shape = f'<{kind}><geometry><mesh filename="{mesh}"/></geometry></{kind}>'
    return link, link + shape


@pytest.mark.parametrize(
    ("words", "change"),
    [
        ("link hips", ('<mass value="8"', '<mass value="1e300"')),
        ("link hips", ('<mass value="8"', '<mass value="1e12"')),
        ("link hips", ('<mass value="8"', '<mass value="-5"')),
        ("link hips", ('<mass value="8"', '<mass value="0"')),
        ("link hips", ('<mass value="8"', '<mass value="nan"')),
        ("link hips", ('<mass value="8"', '<mass value="heavy"')),
        ("link hips", ('ixx="0.04533"', 'ixx="-1"')),
        ("link hips", ('ixx="0.04533"', 'ixx="100"')),
        ("link hips", with_mesh(HIPS, "visual", "gone.obj")),
        ("link left_thigh", with_mesh(THIGH, "collision", "gone.obj")),
        ("link left_thigh", with_mesh(THIGH, "visual", "package://none/gone.obj")),
        ("joint waist_yaw", (WAIST, WAIST.replace("-1", "9"))),
        ("joint waist_yaw", (WAIST, WAIST.replace('"8"', '"-8"'))),
        ("hipz", ('<parent link="hips"', '<parent link="hipz"')),
        ("XML", ("</robot>", "")),
    ],
)
def test_a_faulty_urdf_is_refused_in_one_line_that_names_the_part(
    copied, caplog, words, change
):
    # As in a campaign, which silences Drake's warnings.
    caplog.set_level(logging.CRITICAL, logger="drake")
    path = copied(change)
    with pytest.raises(RobotDescriptionError) as caught:
        load_robot(path)
    assert caught.value.field == "urdf"
    said = str(caught.value)
    assert words in said
    assert str(path) in said
    assert "\n" not in said


def test_drakes_other_warnings_are_given_once(copied, caplog):
    unknown = '<safety_controller k_velocity="1" />\n    <axis xyz="0 1 0" />'
    path = copied(('<axis xyz="0 1 0" />', unknown))
    with caplog.at_level(logging.WARNING, logger="drake"):
        assert load_robot(path).plant.is_finalized()
    (warning,) = [r for r in caplog.records if "safety_controller" in r.getMessage()]
    assert "heron.urdf" in warning.getMessage()


INSIDE = (
    '<link name="left_thigh">',
    '<link name="left_thigh"><collision><geometry><sphere radius="0.1" /></geometry>'
    "</collision>",
)
"""A ball on the left thigh that reaches into the hips."""


def test_shapes_of_the_robot_inside_each_other_are_named_and_can_be_let_pass(copied):
    path = copied(INSIDE)
    with pytest.raises(RobotDescriptionError) as caught:
        load_robot(path)
    assert caught.value.field == "no_collisions"
    found = re.search(r"no_collisions: (\[\[.*?\]\])", caught.value.problem)
    assert found[1] == "[[hips, left_thigh]]"
    path.write_text(f"{path.read_text()}\n{found[0]}\n")
    sim = AtlasSimulation(Scenario(model=str(path)))
    sim.advance(0.03)
    results = sim.output("contact_results")
    touching = [
        sim.plant.get_body(body).name()
        for k in range(results.num_point_pair_contacts())
        for info in [results.point_pair_contact_info(k)]
        for body in (info.bodyA_index(), info.bodyB_index())
    ]
    assert set(touching) == {"world", "left_foot", "right_foot"}


@pytest.mark.parametrize(
    ("pairs", "field"),
    [("[[hips]]", "no_collisions[0]"), ("[[hips, nose]]", "no_collisions[0][1]")],
)
def test_pairs_that_do_not_exist_are_refused(copied, pairs, field):
    path = copied()
    path.write_text(f"{path.read_text()}\nno_collisions: {pairs}\n")
    with pytest.raises(RobotDescriptionError) as caught:
        load_robot(path)
    assert caught.value.field == field


HIPS_ASIDE = [
    (
        f'<child link="{side}_thigh" />\n    <origin xyz="0 0 0"',
        f'<child link="{side}_thigh" />\n    <origin xyz="0.01 {aside} 0"',
    )
    for side, aside in (("left", 0.03), ("right", -0.03))
]
"""As Drake's Atlas has them: hip y, knee and ankle beside the hip's center."""


@pytest.mark.parametrize("foot", [0, 1])
def test_legs_may_hang_beside_the_hips_center(copied, foot):
    robot = load_robot(copied(*HIPS_ASIDE))
    leg = robot.legs[foot]
    assert leg.planar.lateral_offset == pytest.approx((0.03, -0.03)[foot])
    test_the_legs_have_the_closed_form(robot, foot)
    # Nearer than the plane of the leg there is no way to turn it there.
    beside = leg.planar.p_PH + np.array([0.0, 0.0, -0.01]) - leg.p_FA
    assert solve_leg(leg, beside, np.eye(3)) is None


SHANK = '<child link="left_shank" />\n    <origin xyz="0 0 -0.32"'
UNUSABLE = {
    "hip's axes, of left_hip_yaw, left_hip_roll, left_hip_pitch, are parallel": (
        '<origin xyz="0 0.09 0" />\n    <axis xyz="0 0 1" />',
        '<origin xyz="0 0.09 0" />\n    <axis xyz="1 0 0" />',
    ),
    "left_knee, the knee's pitch, turns about": (SHANK, f'{SHANK} rpy="0 0 0.9"'),
    "waist_yaw has the velocity limit inf": (' velocity="8"', ""),
    "zero effort": ('effort="80" vel', 'effort="0" vel'),
    "waist_yaw is prismatic": (
        '"waist_yaw" type="revolute"',
        '"waist_yaw" type="prismatic"',
    ),
    "ball": (
        "</robot>",
        '<link name="ball"><inertial><mass value="1" /><inertia ixx="1" iyy="1" '
        'izz="1" ixy="0" ixz="0" iyz="0" /></inertial></link></robot>',
    ),
    "waist_yaw has no <transmission>": (
        '<transmission name="waist_yaw_transmission">\n'
        "    <type>transmission_interface/SimpleTransmission</type>\n"
        '    <joint name="waist_yaw" />\n    <actuator name="waist_yaw" />\n'
        "  </transmission>",
        "",
    ),
}


@pytest.mark.parametrize("words", UNUSABLE)
def test_what_the_controller_cannot_command_is_refused(copied, words):
    path = copied(UNUSABLE[words])
    with pytest.raises(RobotDescriptionError, match=words) as caught:
        load_robot(path)
    assert str(path) in str(caught.value)


def test_the_gait_keeps_the_robots_limits(heron):
    config = ControllerConfig.of(heron.file, heron, BEHAVIORS)
    usual = config.gait()
    assert (usual.stride, usual.turn, usual.half_width) == (0.14, 0.15, 0.09)
    assert config.gait(stride=0.2).duration == usual.duration
    with pytest.raises(ValueError, match=r"gait.stride is 0.3, and not between"):
        config.gait(stride=0.3)
    widest = usual.nearest(stride=0.9, duration=9.0, turn=2.0, swing_height=1.0)
    assert 0.19 < widest.stride < 0.3
    assert widest.swing_height == 0.2
    assert widest.duration < 3.0
    assert usual.nearest() == usual
