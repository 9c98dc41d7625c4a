"""An operator over a simulation, without a page."""

import pytest

from atlas_drake import AtlasSimulation
from atlas_drake.cockpit.operator import Operator
from atlas_drake.cockpit.orders import Order
from atlas_drake.messages import AtlasSimInterfaceState, Behavior

LOOK = 0.02
"""Simulated time between two looks at the controls [s]."""


class Driven:
    """A simulated robot, and who drives it."""

    def __init__(self, sim):
        self.sim, self.operator = sim, Operator(sim)

    def do(self, control, **values):
        return self.operator.do(Order(control, values))

    def go(self, seconds):
        end = self.sim.time + seconds - 1e-6
        while self.sim.time < end:
            self.operator.update(self.sim.time)
            self.sim.advance(LOOK)


@pytest.fixture(scope="module")
def shared_sim():
    return AtlasSimulation()


@pytest.fixture
def driven(shared_sim):
    shared_sim.reset(seed=0)
    return Driven(shared_sim)


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
