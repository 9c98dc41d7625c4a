"""A panel without a browser: a test presses its buttons and moves its sliders."""

from atlas_drake.teleop.controls import SLIDERS, Controls


class FakePanel:
    """Answers as the one in Meshcat does."""

    def __init__(self):
        self.sliders = {slider.label: slider.value for slider in SLIDERS}
        self.joints = {}
        self.stick = None
        self._clicks = []

    def press(self, *actions):
        self._clicks += actions

    def set(self, slider, value):
        self.sliders[slider.label] = value

    def show_joints(self, positions):
        self.joints = {i: self.joints.get(i, p) for i, p in positions.items()}

    def read(self):
        clicks, self._clicks = tuple(self._clicks), []
        return Controls(clicks, dict(self.sliders), dict(self.joints), self.stick)
