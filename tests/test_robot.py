"""The description of a robot: matching files, orders, names, limbs, errors."""

import numpy as np
import pytest
from pydrake.math import RollPitchYaw
from pydrake.multibody.plant import MultibodyPlant

from atlas_drake.errors import AtlasError, RobotDescriptionError
from atlas_drake.messages import AtlasState
from atlas_drake.robot import (
    DEFAULT_ROBOT,
    MODELS_FOLDER,
    available_robots,
    load_robot,
)

MIRRORED_AXES = ("x", "z")
"""Last letter of joints whose angle changes sign in a mirror: roll and yaw."""


@pytest.fixture(scope="module", params=available_robots())
def robot(request, load_or_skip):
    return load_or_skip(request.param)


@pytest.fixture(scope="module")
def plant(robot):
    return robot.plant


def test_limits_are_the_plants_joint_by_joint(robot, plant):
    actuators = map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
    efforts = {one.joint().name(): one.effort_limit() for one in actuators}
    assert sorted(robot.joint_names) == sorted(efforts)
    for index, name in enumerate(robot.joint_names):
        joint = plant.GetJointByName(name)
        assert robot.position_lower[index] == joint.position_lower_limit()
        assert robot.position_upper[index] == joint.position_upper_limit()
        assert robot.velocity_limit[index] == joint.velocity_upper_limit()
        assert robot.effort_limit[index] == efforts[name]
        entry = robot.file.joints[index]
        assert robot.stand_prep[index] == entry.stand_prep
        assert robot.default_kp[index] == entry.kp
        assert robot.default_kd[index] == entry.kd


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


def test_joints_are_found_by_name_and_by_alias(robot):
    joints = robot.joints
    both = robot.limb("l_leg", "r_leg")
    for index, joint in enumerate(robot.file.joints):
        assert both[index] == ("_leg_" in joint.name)
        for name in filter(None, (joint.name, joint.alias)):
            assert robot.joint_index(name) == getattr(joints, name) == index
            assert name in dir(joints)
    with pytest.raises(AttributeError, match="l_leg_kn"):
        _ = joints.l_leg_kn
    with pytest.raises(RobotDescriptionError, match="l_leg_kny"):
        robot.joint_index("l_leg_kn")


def test_the_constants_of_messages_are_those_of_the_tutorials_robots():
    for robot in map(load_robot, ("atlas", "atlas_v3")):
        for joint in robot.file.joints:
            for name in filter(None, (joint.name, joint.alias)):
                assert getattr(robot.joints, name) == getattr(AtlasState, name)


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


@pytest.mark.parametrize("model", ["hermes", "no.yaml", "../models/atlas"])
def test_an_unknown_robot_is_an_error_that_lists_the_known(model):
    with pytest.raises(AtlasError) as error:
        load_robot(model)
    assert error.value.field == "model"
    for name in (model, *available_robots()):
        assert name in str(error.value)


@pytest.fixture
def spoil(tmp_path):
    """A copy of the default robot's files with some words replaced; gives its path."""
    (tmp_path / "meshes").symlink_to(MODELS_FOLDER / "meshes")

    def spoil(*replacements, urdf=(), name="mine"):
        for suffix, changes in (("yaml", replacements), ("urdf", urdf)):
            text = (MODELS_FOLDER / f"{DEFAULT_ROBOT}.{suffix}").read_text()
            for old, new in changes:
                assert old in text
                text = text.replace(old, new)
            stem = name if suffix == "yaml" else DEFAULT_ROBOT
            (tmp_path / f"{stem}.{suffix}").write_text(text)
        return tmp_path / f"{name}.yaml"

    return spoil


def test_a_robot_is_loaded_from_a_path(spoil, monkeypatch, tmp_path):
    path = spoil(("kp: 20,", "kp: 21,"))
    monkeypatch.chdir(tmp_path)
    for model in (path, str(path), "mine.yaml", "./mine.yaml"):
        robot = load_robot(model)
        assert robot.name == "mine"
        assert robot.path == path
        assert robot.model == str(path)
        assert robot.default_kp[0] == 21.0
        # Bodies are found in the plant by the robot's name, whatever the URDF's is.
        assert robot.plant.HasModelInstanceNamed("mine")
    assert load_robot().model == DEFAULT_ROBOT == available_robots()[0]


LEG = "{name: l_leg_kny, limb: l_leg,"
FAULTS = {
    "joints[1].kp": ["kp: 4000", "kp: -1"],
    "joints[3].limb": ["limb: neck", "limb: tail"],
    "joints[1].name": ["alias: back_lbz", "alias: back_bky"],
    "joints[7].stand_prep": ["stand_prep: 0.5181", "stand_prep: 9"],
    "joints[].stand_prep": ["stand_prep: -0.2762", "stand_prep: 0"],
    "joints": ["name: back_bkz", "name: back_xyz"],
    "wings": ["pelvis: pelvis", "pelvis: pelvis\nwings: 2"],
    "sole.lenght": ["{length: 0.26", "{lenght: 0.26"],
    "sole.width": ["width: 0.124887", "width: 0"],
    "feet": ["- {body: r_foot, sole_frame: r_sole}\n", ""],
    "feet[0].sole_frame": ["frame: l_sole", "frame: l_sol"],
    "chest": ["chest: utorso\n", ""],
    "pelvis": ["pelvis: pelvis", "pelvis: hips"],
    "hands": ["[l_hand, r_hand]", "[l_hand]"],
    "palms": ["palms: [[0, 0.1, 0], ", "palms: ["],
    "contacts[0].frame": ["frame: l_hand", "frame: fist"],
    "urdf": ["urdf: atlas", "urdf: nothing"],
}


@pytest.mark.parametrize("field", FAULTS)
def test_a_faulty_description_is_an_error_that_names_the_field(spoil, field):
    path = spoil(FAULTS[field])
    with pytest.raises(RobotDescriptionError) as caught:
        load_robot(path)
    assert caught.value.field == field
    assert str(path) in str(caught.value)


UNLIKE = {
    "leaning back": (
        [("prep: -0.2333", "prep: -0.5333"), ("prep: -0.2762", "prep: 0.0238")],
        r"-0\.18\d m ahead",
    ),
    "five joints": ([(LEG, LEG.replace("l_leg,", "l_arm,"))], "5 joints"),
    "unlike order": (
        [
            ("name: l_leg_hpz", "name: X"),
            ("name: l_leg_hpx", "name: l_leg_hpz"),
            ("name: X", "name: l_leg_hpx"),
        ],
        "l_leg_hpx",
    ),
    "legs exchanged": ([("{body: l_foot", "{body: r_foot")], "r_foot"),
}


@pytest.mark.parametrize("fault", UNLIKE)
def test_a_robot_that_cannot_stand_is_refused(spoil, fault):
    replacements, words = UNLIKE[fault]
    with pytest.raises(RobotDescriptionError, match=words):
        load_robot(spoil(*replacements))


def test_a_contact_points_from_the_touched_object_into_the_robot(robot, plant):
    context = plant.CreateDefaultContext()
    for side, outward in (("l", 1.0), ("r", -1.0)):
        entry = robot.contact(f"{side}_hand")
        center = plant.GetBodyByName(entry.frame).CalcCenterOfMassInBodyFrame(context)
        R_FC = RollPitchYaw(entry.rpy_FC).ToRotationMatrix()
        inward = R_FC.matrix()[:, 2]
        assert inward @ (center - entry.p_FC) > 0.1
        if robot.name == "drake_atlas":
            # The tip of the gripper, which both arms have on the same side.
            assert entry.p_FC == [0.0, -0.355, 0.0]
            np.testing.assert_allclose(inward, [0.0, 1.0, 0.0], atol=1e-5)
            continue
        # The tip of the capsule that stands for the hand.
        np.testing.assert_allclose(inward, [0.0, -outward, 0.0], atol=1e-5)
        assert entry.p_FC == [0.0, outward * 0.21, 0.005]
    with pytest.raises(RobotDescriptionError, match="no contact 'nose'; it has l_hand"):
        robot.contact("nose")


def test_defaults_are_filled_in(spoil):
    file = load_robot(spoil(("imu_frame: imu\n", ""))).file
    assert file.imu_frame == file.pelvis
    lines = ("pushed: [pelvis, utorso, head, l_hand, r_hand]\n", "")
    file = load_robot(spoil(lines)).file
    assert file.pushed == ["pelvis", "trunk", "l_hand", "r_hand"]


def test_message_order_is_the_descriptions(spoil):
    # The order comes from the file, so that another robot may have another.
    path = spoil()
    lines = path.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if "back_bkz" in line)
    lines[first], lines[first + 1] = lines[first + 1], lines[first]
    path.write_text("\n".join(lines))
    swapped = load_robot(path)
    assert swapped.joint_names[:2] == ("back_bky", "back_bkz")
    plant = swapped.plant
    starts = [
        plant.GetJointByName(name).position_start() for name in swapped.joint_names
    ]
    np.testing.assert_array_equal(swapped.indices(plant).q, starts)
