"""Policies of several exporters: what is read, and what is refused."""

import numpy as np
import pytest
import yaml

from atlas_drake import AtlasSimulation, PolicyUse, Scenario
from atlas_drake.clients.policies.policy_user import PolicyUser
from atlas_drake.clients.policies.reading import read_policy
from atlas_drake.errors import ScenarioError
from atlas_drake.robot import load_robot
from tests.policy_networks import ARM, METADATA, save

DESCRIPTION = {
    "network": "policy.onnx",
    "joints": list(ARM),
    "position": [1.2, -0.6],
    "kp": [60, 40],
    "kd": [3, 2],
    "action_scale": [0.5],
    "observation": [
        {"name": "joint_pos", "scale": [1]},
        {"name": "joint_vel", "scale": [0.05]},
        {"name": "actions", "scale": [1]},
    ],
}


def described(tmp_path, **changes):
    """A description beside its network."""
    save(tmp_path / "policy.onnx", [0.0, 0.0])
    file = tmp_path / "policy.yaml"
    file.write_text(yaml.safe_dump({**DESCRIPTION, **changes}))
    return file


def test_metadata_of_an_exporter_needs_no_description(tmp_path):
    file = save(tmp_path / "p.onnx", [0.0, 0.0], metadata=METADATA)
    description = read_policy(file).description
    assert tuple(description.joints) == ARM
    assert description.kp == [600.0, 400.0]
    assert description.kd == [30.0, 20.0]
    assert description.position == [1.2, -0.6]
    assert description.action_scale == [0.5, 0.25]
    names = [term.name for term in description.observation]
    assert names == ["joint_pos", "joint_vel", "actions"]


def test_metadata_may_ask_for_a_history(tmp_path):
    metadata = {**METADATA, "observation_history_lengths": "3,1,1"}
    file = save(tmp_path / "p.onnx", [0.0, 0.0], seen=10, metadata=metadata)
    histories = [term.history for term in read_policy(file).description.observation]
    assert histories == [3, 1, 1]


def test_a_deploy_file_of_unitree_is_read_with_the_joints_that_it_does_not_name(
    tmp_path,
):
    save(tmp_path / "motion.onnx", [0.0, 0.0], seen=17)
    file = tmp_path / "g1.yaml"
    file.write_text(
        "policy_path: '{LEGGED_GYM_ROOT_DIR}/deploy/pre_train/g1/motion.pt'\n"
        "simulation_dt: 0.002\ncontrol_decimation: 10\n"
        "kps: [100, 40]\nkds: [2, 2]\ndefault_angles: [-0.1, 0.3]\n"
        "ang_vel_scale: 0.25\ndof_pos_scale: 1.0\ndof_vel_scale: 0.05\n"
        "action_scale: 0.25\ncmd_scale: [2.0, 2.0, 0.25]\n"
        "num_actions: 2\nnum_obs: 17\n"
    )
    description = read_policy(file, list(ARM)).description
    assert description.period == pytest.approx(0.02)
    assert description.kp == [100.0, 40.0]
    scales = {term.name: term.scale for term in description.observation}
    assert scales["velocity_commands"] == [2.0, 2.0, 0.25]
    assert scales["base_ang_vel"] == [0.25]
    with pytest.raises(ScenarioError, match="joints: is missing"):
        read_policy(file)


def test_a_term_of_ones_own_is_known_by_its_name(tmp_path):
    terms = [{"name": "height", "scale": [1.0], "history": 6}]
    file = described(tmp_path, observation=terms)
    with pytest.raises(ScenarioError, match="no term 'height'"):
        read_policy(file)
    assert read_policy(file, terms={"height": lambda seen: np.ones(1)}).terms


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kp": [60.0]}, "kp: has 1 values, and joints has 2"),
        ({"action_scale": [1.0] * 3}, "action_scale: has 3 values, not 1 or 2"),
        ({"joints": [ARM[0]] * 2}, r"joints\[1\]: names r_arm_shx twice"),
        ({"network": "other.onnx"}, "there is no file .*other.onnx"),
        ({"network": "policy.yaml"}, "is no network"),
        ({"stiffness": 3}, "no such field"),
        (
            {"observation": [{"name": "joint_position", "scale": [1]}]},
            "no term 'joint_position'. Did you mean 'joint_pos'",
        ),
        (
            {"observation": [{"name": "joint_pos", "scale": [1] * 3}]},
            r"observation\[0\].scale: has 3 values, not 1 or 2",
        ),
        (
            {"observation": DESCRIPTION["observation"][:2]},
            "takes 6 numbers, and the terms have 4: joint_pos 2, joint_vel 2",
        ),
    ],
)
def test_a_fault_is_named_with_its_field(tmp_path, changes, message):
    with pytest.raises(ScenarioError, match=message):
        read_policy(described(tmp_path, **changes))


def test_a_network_of_another_size_is_refused(tmp_path):
    file = described(tmp_path)
    save(tmp_path / "policy.onnx", [0.0] * 3)
    with pytest.raises(ScenarioError, match="has 3 actions for 2 joints"):
        read_policy(file)


def test_a_network_without_metadata_asks_for_a_description(tmp_path):
    with pytest.raises(
        ScenarioError, match="has no metadata joint_names, joint_stiffness"
    ):
        read_policy(save(tmp_path / "p.onnx", [0.0, 0.0]))


@pytest.mark.slow
def test_a_description_makes_the_robot_that_of_the_training(tmp_path):
    """Its rotors are so heavy that the arm hardly moves."""
    moved = []
    raised = {"position": [0.2, -0.6]}
    for changes in ({}, {"armature": [50.0, 50.0], "effort_limit": [20.0, 1e6]}):
        file = described(tmp_path, **raised, **changes)
        sim = AtlasSimulation(Scenario(policy=PolicyUse(file=str(file))))
        shoulder = sim.robot.joint_index(ARM[0])
        before = sim.atlas_state.position[shoulder]
        sim.advance(0.6)
        moved.append(abs(sim.atlas_state.position[shoulder] - before))
        assert not sim.has_fallen
    assert moved[0] > 5.0 * moved[1] > 0.0
    limits = [
        sim.plant.get_joint_actuator(number).effort_limit()
        for number in sim.plant.GetJointActuatorIndices()
    ]
    assert 20.0 in limits
    assert max(limits) < 1e6


def test_a_joint_that_the_robot_lacks_is_named(tmp_path):
    policy = read_policy(described(tmp_path, joints=["r_arm_shx", "r_arm_elz"]))
    with pytest.raises(ScenarioError, match="has no joint 'r_arm_elz'"):
        PolicyUser(policy, load_robot("atlas"))
