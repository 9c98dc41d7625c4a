"""Buttons and sliders become messages, pushes and resets."""

import math

import numpy as np
import pytest

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.messages import Behavior, BehaviorStatus, check_command
from atlas_drake.messages.behavior_catalog import (
    SHIPPED,
    BehaviorCatalog,
    BehaviorInterface,
)
from atlas_drake.robot import load_robot
from atlas_drake.teleop.commander import PUSH_DURATION, Commander, Orders
from atlas_drake.teleop.controls import (
    PELVIS_HEIGHT,
    PUSH_BODY,
    PUSH_DIRECTION,
    PUSH_IMPULSE,
    SHARES,
    Action,
    Controls,
    behavior_buttons,
    fitted,
    legend,
)
from atlas_drake.teleop.limbs import DAMPING, SPEED
from atlas_drake.teleop.pages import pages_with
from atlas_drake.teleop.walking import Direction

OWN = fitted(load_robot(), ControllerConfig())

DT = 0.04
BEHAVIORS = {
    Action.STAND: Behavior.STAND,
    Action.STEP: Behavior.STEP,
    Action.MANIPULATE: Behavior.MANIPULATE,
    Action.FREEZE: Behavior.FREEZE,
    Action.USER: Behavior.USER,
    Action.STAND_PREP: Behavior.STAND_PREP,
    Action.WALK: Behavior.WALK,
    Action.FORWARD: Behavior.WALK,
}


@pytest.fixture
def look(panel, robot, standing, state):
    """Looks once and lets the robot and the panel do what was ordered."""
    commander = Commander(robot, standing)

    def once():
        orders = commander.look(panel.read(), standing, state, DT)
        if orders.atlas_command is not None:
            check_command(orders.atlas_command, robot.joint_names)
            if len(orders.atlas_command.k_effort):
                standing.k_effort = list(orders.atlas_command.k_effort)
        if orders.sim_command is not None:
            check_command(orders.sim_command, robot.joint_names)
            behavior = Behavior(orders.sim_command.behavior)
            standing.current_behavior = standing.desired_behavior = behavior
        for slider, value in orders.sliders.items():
            panel.set(slider, value)
        panel.show_joints(orders.joints)
        standing.header.stamp += DT
        return orders

    once()
    return once


def test_an_untouched_panel_sends_nothing(look):
    assert look() == Orders()


@pytest.mark.parametrize(("action", "behavior"), BEHAVIORS.items())
def test_each_button_asks_for_its_behavior(look, panel, action, behavior):
    panel.press(action)
    assert look().sim_command.behavior == behavior


def test_walking_from_another_behavior_leads_through_stand(look, panel, standing):
    standing.current_behavior = Behavior.MANIPULATE
    panel.press(Action.FORWARD)
    assert look().sim_command.behavior == Behavior.STAND
    standing.current_behavior = Behavior.MANIPULATE
    assert look().sim_command is None  # It is on its way.
    standing.current_behavior = Behavior.STAND
    assert look().sim_command.behavior == Behavior.WALK


def test_stopping_sends_a_closing_step_and_then_stand(look, panel, standing):
    panel.press(Action.FORWARD)
    steps = look().sim_command.walk_params.step_queue
    assert [step.step_index for step in steps] == [1, 2, 3, 4]
    assert look().sim_command is not None  # Both feet down: step 1 is fixed now.
    assert look().sim_command is None
    feedback = standing.walk_feedback
    feedback.current_step_index, feedback.step_queue_saturated[0] = 1, steps[0]
    panel.press(Action.STOP)
    closing = look().sim_command.walk_params.step_queue[0]
    assert closing.step_index == 2
    assert closing.pose.position.x == pytest.approx(steps[0].pose.position.x)
    assert look().sim_command is None
    feedback.current_step_index, feedback.step_queue_saturated[0] = 2, closing
    assert look().sim_command.behavior == Behavior.STAND
    assert look().sim_command is None


def test_a_refused_walk_is_asked_for_once(look, panel, standing):
    sent = 0
    panel.press(Action.FORWARD)
    for _ in range(100):
        sent += look().sim_command is not None
        standing.current_behavior = Behavior.STAND
    assert sent == 1


def test_a_fallen_robot_gets_no_walk_command(look, panel, standing):
    standing.behavior_feedback.status_flags = BehaviorStatus.ERROR_FALLING
    panel.press(Action.FORWARD)
    assert look().sim_command is None


def test_a_gamepad_steers_as_long_as_it_is_held(look, panel, standing):
    panel.stick = Direction(forward=1.0)
    assert look().sim_command.behavior == Behavior.WALK
    panel.stick = Direction()
    queue = look().sim_command.walk_params.step_queue
    # Step 1 is under way; from step 2 on the feet stay side by side.
    x = [step.pose.position.x for step in queue]
    assert x == pytest.approx([x[0]] * 4)


def test_a_limb_that_is_taken_stays_where_it_is(look, panel, robot, state):
    panel.set(SHARES["left arm"], 255)
    orders = look()
    left_arm = robot.limb("l_arm")
    command = orders.atlas_command
    assert np.array_equal(np.array(command.k_effort) == 255, left_arm)
    assert np.array(command.position)[left_arm] == pytest.approx(0.1)
    assert set(command.kp_velocity) == {DAMPING}
    assert set(orders.joints) == set(np.flatnonzero(left_arm))
    assert look().atlas_command is None
    panel.set(SHARES["left arm"], 0)
    orders = look()
    assert not any(orders.atlas_command.k_effort)
    assert not orders.joints


def test_a_joint_follows_its_slider_at_a_bounded_speed(look, panel, robot):
    panel.set(SHARES["left arm"], 255)
    look()
    elbow = robot.joint_index("l_arm_ely")
    panel.joints[elbow] = 0.1 + 2.5 * SPEED * DT
    positions = [look().atlas_command.position[elbow] for _ in range(3)]
    assert positions == pytest.approx([0.1 + SPEED * DT * k for k in (1.0, 2.0, 2.5)])
    assert look().atlas_command is None


def test_user_takes_all_joints_and_the_next_behavior_restores_the_shares(
    look, panel, standing
):
    panel.set(SHARES["left arm"], 255)
    look()
    panel.press(Action.USER)
    orders = look()
    assert set(orders.atlas_command.k_effort) == {255}
    assert len(orders.joints) == 28
    assert {panel.sliders[slider.label] for slider in SHARES.values()} == {255}
    look()
    panel.press(Action.STAND)
    orders = look()
    assert orders.sim_command.behavior == Behavior.STAND
    assert sum(orders.atlas_command.k_effort) == 6 * 255
    assert panel.sliders[SHARES["left arm"].label] == 255
    assert panel.sliders[SHARES["legs"].label] == 0
    assert look().atlas_command is None


def test_the_sliders_follow_commands_of_others(look, panel, standing):
    standing.k_effort = [255] * 28
    look()
    assert panel.sliders[SHARES["back"].label] == 255
    assert look().atlas_command is None


def test_the_pelvis_moves_only_once_its_sliders_do(look, panel):
    panel.press(Action.MANIPULATE)
    assert not look().sim_command.manipulate_params.use_desired
    assert panel.sliders[PELVIS_HEIGHT.label] == pytest.approx(0.89)
    assert look().sim_command is None
    panel.set(PELVIS_HEIGHT, 0.75)
    params = look().sim_command.manipulate_params
    assert params.use_desired
    assert params.desired.pelvis_height == 0.75
    assert look().sim_command is None


def test_a_push_is_an_impulse_in_a_direction_from_the_heading(look, panel, standing):
    yaw = math.radians(90.0)
    for pose in standing.foot_pos_est:
        pose.orientation.z, pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    panel.set(PUSH_BODY, 1)
    panel.set(PUSH_DIRECTION, 90.0)
    panel.set(PUSH_IMPULSE, 20.0)
    panel.press(Action.PUSH)
    push = look().push
    assert push.body == "pelvis"
    assert push.force_W * PUSH_DURATION == pytest.approx([-20.0, 0.0, 0.0])
    assert look().push is None


def test_a_reset_forgets_everything(look, panel, robot, standing):
    commander = Commander(robot, standing)
    panel.press(Action.RESET, Action.FORWARD)
    orders = commander.look(panel.read(), standing, None, DT)
    assert orders.reset
    assert orders.sim_command is None
    assert commander.restart(standing).sliders[SHARES["legs"]] == 0


def test_a_users_behavior_has_a_button_and_a_page(robot, standing, state):
    entries = [
        BehaviorInterface(name=f"TRICK_{number}", number=100 + number)
        for number in range(4)
    ]
    catalog = BehaviorCatalog((*SHIPPED, *entries))
    buttons = behavior_buttons(catalog)
    labels = ["TRICK_0 (8)", "TRICK_1 (9)", "TRICK_2 (0)", "TRICK_3"]
    assert [button.label for button in buttons] == labels
    titles = [page.title for page in pages_with(robot, OWN, (), buttons)]
    assert titles[1] == "behaviors"
    assert "behaviors" not in [page.title for page in pages_with(robot, OWN, ())]
    commander = Commander(robot, standing)
    orders = commander.look(Controls(clicks=(buttons[1],)), standing, state, DT)
    assert orders.sim_command.behavior.name == "TRICK_1"
    told = legend(robot, catalog)
    assert "\n   8  TRICK_0\n   9  TRICK_1\n   0  TRICK_2\n   -  TRICK_3\n" in told
    assert "modes, behaviors, walking" in told
    assert "behaviors," not in legend(robot)
