"""The controller's own constants; its ticks are tested in whole simulations."""

from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.messages import Behavior
from atlas_drake.systems.whole_body_controller import WholeBodyController


def test_the_robot_stands_lower_than_in_its_stand_prep_pose(robot):
    controller = WholeBodyController(robot, ControllerConfig(), 0.009, Behavior.STAND)
    height = controller._supervisor._tools.nominal_height
    drop = robot.com_height - height
    assert 0.0 < drop < 0.1
