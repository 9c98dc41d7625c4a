"""Made-up reports of a robot, and a panel without a browser."""

import pytest

from atlas_drake.messages import AtlasSimInterfaceState, AtlasState, Behavior
from atlas_drake.robot import load_robot
from atlas_drake.teleop.controls import SLIDERS, Controls


class FakePanel:
    """Answers as the one in Meshcat does."""

    def __init__(self):
        self.sliders = {slider.label: slider.value for slider in SLIDERS}
        self.joints = {}
        self.stick = None
        self.paused = False
        self._clicks = []

    def show_paused(self, paused):
        self.paused = paused

    def press(self, *actions):
        self._clicks += actions

    def set(self, slider, value):
        self.sliders[slider.label] = value

    def show_joints(self, positions):
        self.joints = {i: self.joints.get(i, p) for i, p in positions.items()}

    def read(self):
        clicks, self._clicks = tuple(self._clicks), []
        return Controls(clicks, dict(self.sliders), dict(self.joints), self.stick)


@pytest.fixture
def panel():
    return FakePanel()


@pytest.fixture(scope="session")
def robot():
    return load_robot()


@pytest.fixture
def standing():
    """A report of a robot that stands at the origin and looks along x."""
    report = AtlasSimInterfaceState()
    report.current_behavior = report.desired_behavior = Behavior.STAND
    report.k_effort = [0] * 28
    report.pos_est.position.z = 0.89
    for pose, y in zip(report.foot_pos_est, (0.12, -0.12), strict=True):
        pose.position.y = y
    return report


@pytest.fixture
def state(robot):
    message = AtlasState()
    message.position = [0.1] * robot.num_joints
    return message
