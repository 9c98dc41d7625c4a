"""Legs of other layouts than Atlas': read, solved numerically, and walked on."""

import math
import re

import numpy as np
import pytest
from pydrake.multibody.tree import JacobianWrtVariable

from atlas_drake.control.feet.leg_kinematics import leg_length, leg_solver, solve_leg
from atlas_drake.control.feet.numeric_leg import NumericLeg
from atlas_drake.robot import load_robot

from .conftest import HERON

X, Y, Z = "1 0 0", "0 1 0", "0 0 1"
PITCH_ROLL_YAW = {"hip_yaw": Y, "hip_roll": X, "hip_pitch": Z}
ROLL_YAW_PITCH = {"hip_yaw": X, "hip_roll": Z}
ANKLE_ROLL_FIRST = {"ankle_pitch": X, "ankle_roll": Y}
NEGATIVE_KNEE = {"knee": "0 -1 0"}
TILTED = {"hip_pitch": "0 0.96 0.28", "hip_roll": "0.96 0 0.28"}
LAYOUTS = {
    "pitch roll yaw": PITCH_ROLL_YAW,
    "roll yaw pitch": ROLL_YAW_PITCH,
    "ankle roll first": ANKLE_ROLL_FIRST,
    "negative knee": NEGATIVE_KNEE,
    "tilted hip": TILTED,
    "all": {**PITCH_ROLL_YAW, **ANKLE_ROLL_FIRST, **NEGATIVE_KNEE},
}
"""Axes of joints by the second part of their name in Heron's file."""


@pytest.fixture
def heron_with(copied):
    """Gives Heron's YAML file after other axes are given to joints of both legs."""

    def make(axes, offset=False):
        path = copied()
        urdf, yaml = path.parent / "heron.urdf", path.read_text()
        text = urdf.read_text()
        for name, axis in axes.items():
            for side in ("left", "right"):
                joint = rf'(<joint name="{side}_{name}" type.*?<axis xyz=")[^"]*(")'
                text, count = re.subn(joint, rf"\g<1>{axis}\2", text, flags=re.DOTALL)
                assert count == 1
        # The limits suit any axis; so does the pose, but for the pitch joints'.
        text = re.sub(r'lower="[^"]*" upper="[^"]*"', 'lower="-2.5" upper="2.5"', text)
        if offset:
            roll_links = r'(_hip_roll_link" />\n    <origin xyz=")0 0 0"'
            text = re.sub(roll_links, r'\g<1>0.02 0 -0.03"', text)
        urdf.write_text(text)
        at = {"hip_pitch": -0.3, "knee": 0.6, "ankle_pitch": -0.3}
        for pitch, others in (
            ("hip_pitch", ("hip_yaw", "hip_roll")),
            ("ankle_pitch", ("ankle_roll",)),
        ):
            for other in others:
                if axes.get(other) == Y:
                    at[other] = at.pop(pitch)
        if axes.get("knee") == "0 -1 0":
            at["knee"] = -0.6
        for name in ("hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch"):
            at.setdefault(name, 0.0)
        for name, value in at.items():
            entry = rf"(_{name}, limb.*stand_prep: )[-.\d]+"
            yaml = re.sub(entry, rf"\g<1>{value}", yaml)
        path.write_text(yaml)
        return path

    return make


def check_solved(robot):
    """Checks that poses of both soles give back the joint angles that made them."""
    plant, random = robot.plant, np.random.default_rng(1)
    context = plant.CreateDefaultContext()
    pelvis = plant.GetFrameByName(robot.file.pelvis)
    for foot, leg in enumerate(robot.legs):
        assert leg.planar is None
        solve = leg_solver(leg)
        sole = plant.GetFrameByName(robot.file.feet[foot].sole_frame)
        for _ in range(40):
            angles = leg.seed + random.uniform(-0.35, 0.35, 6)
            for place, value in zip(leg.joints, angles, strict=True):
                plant.GetJointByName(robot.joint_names[place]).set_angle(context, value)
            X_PF = sole.CalcPose(context, pelvis)
            pose = solve(X_PF.translation(), X_PF.rotation().matrix(), None)
            np.testing.assert_allclose(pose.angles, angles, atol=5e-4)
            force = np.array([20.0, -30.0, 300.0])
            p_PF = X_PF.translation()
            J = plant.CalcJacobianTranslationalVelocity(
                context, JacobianWrtVariable.kV, sole, [0, 0, 0], pelvis, pelvis
            )
            columns = robot.indices(plant).v[leg.joints]
            np.testing.assert_allclose(
                pose.torques(p_PF, force), -J[:, columns].T @ force, atol=0.02
            )


@pytest.mark.parametrize(
    ("axes", "roll"),
    [
        ({}, "hip_roll"),
        (PITCH_ROLL_YAW, "hip_roll"),
        (ROLL_YAW_PITCH, "hip_yaw"),
        (TILTED, "hip_roll"),
    ],
)
def test_the_roll_of_the_hip_is_known_by_its_axis(heron_with, axes, roll):
    robot = load_robot(heron_with(axes))
    names = [robot.joint_names[leg.hip_roll] for leg in robot.legs]
    assert names == [f"left_{roll}", f"right_{roll}"]


def test_stronger_hips_take_less_time(copied):
    def strengthened(*joints):
        path = copied()
        urdf = path.parent / "heron.urdf"
        text = urdf.read_text()
        for name in joints:
            joint = rf'(<joint name="(?:left|right)_{name}" type.*?effort=")([^"]*)'
            text = re.sub(
                joint, lambda m: f"{m[1]}{4.0 * float(m[2])}", text, flags=re.DOTALL
            )
        urdf.write_text(text)
        return load_robot(path).hip_time

    usual = load_robot(HERON).hip_time
    assert strengthened("hip_roll") == pytest.approx(usual / math.sqrt(2.0))
    assert strengthened("hip_roll", "hip_pitch") == pytest.approx(usual / 2.0)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_leg_of_another_layout_is_solved(heron_with, layout):
    check_solved(load_robot(heron_with(LAYOUTS[layout])))


def test_a_leg_with_an_offset_hip_is_solved(heron_with):
    check_solved(load_robot(heron_with(PITCH_ROLL_YAW, offset=True)))


def test_the_lengths_are_those_of_the_plane_in_which_the_knee_bends(heron_with):
    plain = load_robot(HERON).legs[0]
    other = load_robot(heron_with(NEGATIVE_KNEE)).legs[0]
    assert other.knee_sign == -1.0
    assert other.flexion(-0.6) == pytest.approx(0.6)
    length = leg_length(plain, 0.6)
    assert leg_length(other, other.knee_at(0.6)) == pytest.approx(length)
    np.testing.assert_allclose(other.p_PT, plain.p_PT, atol=1e-12)
    np.testing.assert_allclose(other.p_FA, plain.p_FA, atol=1e-12)


@pytest.mark.parametrize("foot", [0, 1])
def test_both_ways_to_solve_a_leg_agree(foot):
    leg = load_robot().legs[foot]
    reached = NumericLeg(leg)
    for bent in (0.3, 0.9, 1.5):
        X = reached.sole(leg.seed + np.array([0.1, 0.05, -bent, bent, 0, 0]))
        closed = solve_leg(leg, X[:3, 3], X[:3, :3])
        found = reached.solve(X[:3, 3], X[:3, :3])
        np.testing.assert_allclose(found.angles, closed.angles, atol=5e-5)


def test_a_sole_out_of_reach_has_no_joint_angles():
    leg = load_robot().legs[0]
    below = leg.sole[:3, 3] + np.array([0.0, 0.0, -0.3])
    assert NumericLeg(leg).solve(below, np.eye(3)) is None


def test_a_sole_turned_by_half_a_turn_is_not_taken_for_the_same(heron_with):
    leg = load_robot(heron_with(NEGATIVE_KNEE)).legs[0]
    turned = np.diag([-1.0, -1.0, 1.0]) @ leg.sole[:3, :3]
    found = NumericLeg(leg).solve(leg.sole[:3, 3] + [0.0, 0.0, 0.05], turned)
    if found is not None:
        reached = NumericLeg(leg).sole(found.angles)[:3, :3]
        np.testing.assert_allclose(reached, turned, atol=1e-4)
