"""The description of a robot: files that fit, orders, names, limbs, errors."""

import shutil

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake import robot as robot_module
from atlas_drake.errors import AtlasError, RobotDescriptionError
from atlas_drake.robot import (
    DEFAULT_ROBOT,
    LIMBS,
    MODELS_FOLDER,
    available_robots,
    load_robot,
)

MIRRORED_AXES = ("x", "z")
"""Last letter of joints whose angle changes sign in a mirror: roll and yaw."""


@pytest.fixture(scope="module", params=available_robots())
def robot(request):
    return load_robot(request.param)


@pytest.fixture(scope="module")
def plant(robot):
    plant = MultibodyPlant(time_step=0.001)
    robot.add_to(plant)
    plant.Finalize()
    return plant


def test_the_default_robot_comes_first():
    names = available_robots()
    assert names[0] == DEFAULT_ROBOT
    assert len(names) == len(set(names)) >= 2
    assert load_robot().name == DEFAULT_ROBOT


def test_arrays_have_one_element_per_joint(robot):
    n = robot.num_joints
    assert n == len(robot.joint_names) == len(set(robot.joint_names))
    for name in (
        "position_lower",
        "position_upper",
        "velocity_limit",
        "effort_limit",
        "stand_prep",
        "default_kp",
        "default_kd",
    ):
        values = getattr(robot, name)
        assert values.shape == (n,)
        assert np.isfinite(values).all()


def test_limits_are_the_plants_joint_by_joint(robot, plant):
    for index, name in enumerate(robot.joint_names):
        joint = plant.GetJointByName(name)
        assert robot.position_lower[index] == joint.position_lower_limits()[0]
        assert robot.position_upper[index] == joint.position_upper_limits()[0]
        assert robot.velocity_limit[index] == joint.velocity_upper_limits()[0]
        actuator = next(
            plant.get_joint_actuator(i)
            for i in plant.GetJointActuatorIndices()
            if plant.get_joint_actuator(i).joint().name() == name
        )
        assert robot.effort_limit[index] == actuator.effort_limit()


def test_limits_and_gains_make_sense(robot):
    assert (robot.position_lower < robot.position_upper).all()
    assert (robot.velocity_limit > 0.0).all()
    assert (robot.effort_limit > 0.0).all()
    assert (robot.default_kp > 0.0).all()
    assert (robot.default_kd > 0.0).all()
    assert (robot.stand_prep >= robot.position_lower).all()
    assert (robot.stand_prep <= robot.position_upper).all()


def test_mass_is_the_plants(robot, plant):
    mass = plant.CalcTotalMass(plant.CreateDefaultContext())
    assert robot.mass == pytest.approx(mass)


def test_positions_and_velocities_of_one_joint_at_a_time(robot, plant):
    indices = robot.indices(plant)
    context = plant.CreateDefaultContext()
    for number, name in enumerate(robot.joint_names):
        joint = plant.GetJointByName(name)
        q, v = np.zeros(plant.num_positions()), np.zeros(plant.num_velocities())
        q[0] = 1.0
        q[indices.q[number]] = 0.123
        v[indices.v[number]] = 0.456
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        assert joint.GetOnePosition(context) == 0.123
        assert joint.GetOneVelocity(context) == 0.456


def test_actuation_of_one_joint_at_a_time(robot, plant):
    indices = robot.indices(plant)
    B = plant.MakeActuationMatrix()
    for number in range(robot.num_joints):
        actuation = np.zeros(robot.num_joints)
        actuation[indices.actuation[number]] = 1.0
        expected = np.zeros(plant.num_velocities())
        expected[indices.v[number]] = 1.0
        np.testing.assert_array_equal(B @ actuation, expected)


def test_generalized_velocities_are_pelvis_then_joints(robot, plant):
    indices = robot.indices(plant)
    order = indices.generalized
    np.testing.assert_array_equal(np.sort(order), np.arange(plant.num_velocities()))
    np.testing.assert_array_equal(order[6:], indices.v)
    context = plant.CreateDefaultContext()
    pelvis = plant.GetBodyByName(robot.file.pelvis)
    for number in range(6):
        v = np.zeros(plant.num_velocities())
        v[order[number]] = 1.0
        plant.SetVelocities(context, v)
        spatial = plant.EvalBodySpatialVelocityInWorld(context, pelvis)
        np.testing.assert_allclose(spatial.get_coeffs(), np.eye(6)[number], atol=1e-15)


def test_indices_count_in_any_plant(robot):
    # Something else before the robot shifts all of its indices.
    plant = MultibodyPlant(time_step=0.001)
    instance = plant.AddModelInstance("box")
    plant.AddRigidBody("box", instance)
    robot.add_to(plant)
    plant.Finalize()
    indices = robot.indices(plant)
    for number, name in enumerate(robot.joint_names):
        joint = plant.GetJointByName(name)
        assert indices.q[number] == joint.position_start()
        assert indices.v[number] == joint.velocity_start()
    base = plant.GetBodyByName(robot.file.pelvis).floating_velocities_start_in_v()
    np.testing.assert_array_equal(indices.generalized[:6], np.arange(base, base + 6))


def test_names_and_aliases_find_their_joint(robot):
    for index, joint in enumerate(robot.file.joints):
        assert robot.joint_index(joint.name) == index
        if joint.alias:
            assert robot.joint_index(joint.alias) == index


@pytest.mark.parametrize(
    ("alias", "name"),
    [
        ("back_lbz", "back_bkz"),
        ("neck_ay", "neck_ry"),
        ("l_leg_uhz", "l_leg_hpz"),
        ("r_leg_lax", "r_leg_akx"),
        ("l_arm_usy", "l_arm_shy"),
        ("r_arm_mwx", "r_arm_wrx"),
    ],
)
def test_names_of_the_first_version(robot, alias, name):
    assert robot.joint_names[robot.joint_index(alias)] == name


def test_names_and_aliases_are_unambiguous(robot):
    names = [n for joint in robot.file.joints for n in (joint.name, joint.alias) if n]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("name", ["l_leg_knee", "", "BACK_BKZ", "pelvis"])
def test_an_unknown_joint_is_an_error_that_lists_the_known(robot, name):
    with pytest.raises(RobotDescriptionError, match="l_leg_kny") as caught:
        robot.joint_index(name)
    assert repr(name) in str(caught.value)
    assert robot.name in str(caught.value)


def test_every_joint_belongs_to_one_limb(robot):
    members = np.array([robot.limb(limb) for limb in LIMBS])
    np.testing.assert_array_equal(members.sum(axis=0), 1)
    assert members.any(axis=1).all()


def test_limbs_can_be_joined(robot):
    both = robot.limb("l_leg", "r_leg")
    np.testing.assert_array_equal(both, robot.limb("l_leg") | robot.limb("r_leg"))
    for index, name in enumerate(robot.joint_names):
        assert both[index] == ("_leg_" in name)


def test_left_and_right_are_mirror_images(robot):
    for index, name in enumerate(robot.joint_names):
        if not name.startswith("l_"):
            continue
        twin = robot.joint_index("r_" + name[2:])
        assert robot.effort_limit[index] == robot.effort_limit[twin]
        assert robot.default_kp[index] == robot.default_kp[twin]
        # As deep in the leg or arm: the stand-prep pose is symmetric.
        if name.startswith("l_leg"):
            sign = -1.0 if name.endswith(MIRRORED_AXES) else 1.0
            expected = sign * robot.stand_prep[twin]
            assert robot.stand_prep[index] == pytest.approx(expected, abs=1e-3)


def test_named_bodies_and_frames_exist(robot, plant):
    file = robot.file
    for body in (file.pelvis, file.chest, *file.hands, *(f.body for f in file.feet)):
        assert plant.HasBodyNamed(body)
        assert body in robot.body_names
    for frame in (file.imu_frame, *(f.sole_frame for f in file.feet)):
        assert plant.HasFrameNamed(frame)
    assert len(file.feet) == len(file.hands) == 2


def test_soles_are_left_then_right_and_level_in_stand_prep(robot, plant):
    context = plant.CreateDefaultContext()
    q = plant.GetPositions(context)
    q[robot.indices(plant).q] = robot.stand_prep
    plant.SetPositions(context, q)
    left, right = (
        plant.GetFrameByName(foot.sole_frame).CalcPoseInWorld(context)
        for foot in robot.file.feet
    )
    assert left.translation()[1] > 0.0 > right.translation()[1]
    assert left.translation()[2] == pytest.approx(right.translation()[2], abs=2e-3)
    for sole in (left, right):
        normal, toes = sole.rotation().matrix()[:, 2], sole.rotation().matrix()[:, 0]
        np.testing.assert_allclose(normal, [0.0, 0.0, 1.0], atol=0.03)
        assert toes[0] > 0.99


def test_an_unknown_robot_is_an_error_that_lists_the_known():
    with pytest.raises(RobotDescriptionError, match="there is no robot 'hermes'") as e:
        load_robot("hermes")
    for name in available_robots():
        assert name in str(e.value)
    assert isinstance(e.value, AtlasError)


@pytest.mark.parametrize("name", ["../models/atlas", str(MODELS_FOLDER / "atlas")])
def test_a_path_is_no_name_of_a_robot(name):
    with pytest.raises(RobotDescriptionError, match="there is no robot"):
        load_robot(name)


@pytest.fixture
def other_models(tmp_path, monkeypatch):
    """A copy of the default robot's files that a test may spoil."""
    for suffix in ("yaml", "urdf"):
        shutil.copy(MODELS_FOLDER / f"{DEFAULT_ROBOT}.{suffix}", tmp_path)
    monkeypatch.setattr(robot_module, "MODELS_FOLDER", tmp_path)
    return tmp_path / f"{DEFAULT_ROBOT}.yaml"


def test_a_description_that_names_other_joints_is_an_error(other_models):
    text = other_models.read_text()
    other_models.write_text(text.replace("name: back_bkz", "name: back_xyz"))
    with pytest.raises(RobotDescriptionError, match="different actuated joints") as e:
        load_robot()
    assert "back_bkz" in str(e.value)
    assert "back_xyz" in str(e.value)


def test_a_description_with_an_unknown_key_is_an_error(other_models):
    other_models.write_text(other_models.read_text() + "wings: 2\n")
    with pytest.raises(RuntimeError, match="wings"):
        load_robot()


def test_message_order_is_the_descriptions(other_models):
    # The order comes from the file, so that another robot may have another.
    lines = other_models.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if "back_bkz" in line)
    lines[first], lines[first + 1] = lines[first + 1], lines[first]
    other_models.write_text("\n".join(lines))
    swapped = load_robot()
    assert swapped.joint_names[:2] == ("back_bky", "back_bkz")
    plant = MultibodyPlant(time_step=0.0)
    swapped.add_to(plant)
    plant.Finalize()
    starts = [
        plant.GetJointByName(name).position_start() for name in swapped.joint_names
    ]
    np.testing.assert_array_equal(swapped.indices(plant).q, starts)
