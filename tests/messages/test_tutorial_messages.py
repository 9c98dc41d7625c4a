"""The programme of the control-mode tutorial, sent as its script fills it in."""

import pytest

from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasState,
    Behavior,
    check_command,
)

NUM_JOINTS = 28
JOINTS = [f"joint_{index}" for index in range(NUM_JOINTS)]
USER_JOINTS = [
    AtlasState.neck_ry,
    AtlasState.l_arm_ely,
    AtlasState.l_arm_wrx,
    AtlasState.r_arm_ely,
    AtlasState.r_arm_wrx,
]


def test_user_mode_pose():
    message = AtlasCommand()
    message.header.stamp = 1.5
    message.position = [0.1] * NUM_JOINTS
    message.velocity = [0.0] * NUM_JOINTS
    message.effort = [0.0] * NUM_JOINTS
    message.k_effort = [255] * NUM_JOINTS
    # The script sets this gain on a message that it has sent before.
    sent = message.snapshot()
    message.kp_velocity = [50.0] * NUM_JOINTS
    check_command(sent, JOINTS)
    check_command(message, JOINTS)
    assert len(sent.kp_velocity) == 0


def test_one_message_is_sent_twice_with_changes_and_the_same_stamp():
    message = AtlasSimInterfaceCommand()
    message.header.stamp = 3.5
    message.behavior = message.STAND_PREP
    message.k_effort = [255] * NUM_JOINTS
    warm_up = message.snapshot()
    message.behavior = message.STAND
    message.k_effort = [0] * NUM_JOINTS
    stand = message.snapshot()

    check_command(warm_up, JOINTS)
    check_command(stand, JOINTS, previous_stamp=warm_up.header.stamp)
    assert (warm_up.behavior, stand.behavior) == (Behavior.STAND_PREP, Behavior.STAND)
    assert (warm_up.k_effort[0], stand.k_effort[0]) == (255, 0)


def test_arms_under_user_control():
    message = AtlasCommand()
    message.position = [0.0] * NUM_JOINTS
    message.position[AtlasState.l_arm_ely] = 2.1
    for name in ("ki_position", "kd_position", "i_effort_min", "i_effort_max"):
        setattr(message, name, [0.0] * NUM_JOINTS)
    message.kp_position = [20.0] * NUM_JOINTS
    message.k_effort = [0] * NUM_JOINTS
    for joint in USER_JOINTS:
        message.k_effort[joint] = 255
    check_command(message, JOINTS)
    assert [i for i, k in enumerate(message.k_effort) if k] == [3, 18, 21, 24, 27]


def test_walk():
    arms_k_effort = [0] * NUM_JOINTS
    message = AtlasSimInterfaceCommand()
    message.header.stamp = 8.5
    message.behavior = message.WALK
    message.walk_params.use_demo_walk = False
    for i in range(4):
        step_data = AtlasBehaviorStepData()
        step_data.step_index = i + 1
        step_data.foot_index = i % 2
        step_data.swing_height = 0.3
        step_data.duration = 0.63
        step_data.pose.position.x = (1 + i // 2) * 0.25
        step_data.pose.position.y = 0.15 if i % 2 == 0 else -0.15
        step_data.pose.position.z = 0.0
        step_data.pose.orientation.x = 0.0
        step_data.pose.orientation.y = 0.0
        step_data.pose.orientation.z = 0.0
        step_data.pose.orientation.w = 1.0
        message.walk_params.step_queue[i] = step_data
    message.k_effort = arms_k_effort
    snapshot = message.snapshot()
    arms_k_effort[0] = 255  # The script shares one list between two messages.

    check_command(snapshot, JOINTS, previous_stamp=3.5)
    assert snapshot.k_effort[0] == 0
    steps = snapshot.walk_params.step_queue
    assert [step.pose.position.x for step in steps] == [0.25, 0.25, 0.5, 0.5]
    assert [step.foot_index for step in steps] == [0, 1, 0, 1]


@pytest.mark.parametrize("name", ["STAND", "stand", "Stand"])
def test_behavior_by_name(name):
    message = AtlasSimInterfaceCommand()
    message.behavior = name
    check_command(message, JOINTS)
