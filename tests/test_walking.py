"""Walking beyond the tutorial: far, backward, sideways, turning and along curves."""

import math

import numpy as np
import pytest

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimulation,
    Behavior,
    BehaviorStatus,
    Scenario,
    steps_ahead,
)
from atlas_drake.scenario import Jitter

pytestmark = pytest.mark.slow

HALF_WIDTH = 0.12
"""Of each foot from the middle [m]."""
DURATION = 0.65
"""Of a step [s]; no multiple of the control period."""
LANDING_ERROR = 0.02
"""[m]"""


class Path:
    """Footsteps along the way of a point between the feet, left foot first."""

    def __init__(self, sim):
        feet = sim.atlas_sim_interface_state.foot_pos_est
        self._x = 0.5 * (feet[0].position.x + feet[1].position.x)
        self._y = 0.5 * (feet[0].position.y + feet[1].position.y)
        self._yaw = 0.0
        self.steps = []

    def step(self, ahead=0.0, left=0.0, turn=0.0):
        """Moves the point in its own frame, and puts the next foot beside it."""
        cos, sin = math.cos(self._yaw), math.sin(self._yaw)
        self._x += cos * ahead - sin * left
        self._y += sin * ahead + cos * left
        self._yaw += turn
        foot = len(self.steps) % 2
        side = HALF_WIDTH if foot == 0 else -HALF_WIDTH
        step = AtlasBehaviorStepData()
        step.step_index, step.foot_index = len(self.steps) + 1, foot
        step.duration, step.swing_height = DURATION, 0.1
        step.pose.position.x = self._x - side * math.sin(self._yaw)
        step.pose.position.y = self._y + side * math.cos(self._yaw)
        step.pose.orientation.z = math.sin(0.5 * self._yaw)
        step.pose.orientation.w = math.cos(0.5 * self._yaw)
        self.steps.append(step)
        return self


def assert_walked(sim, steps):
    assert not sim.has_fallen
    assert sim.current_behavior is Behavior.STAND
    status = sim.atlas_sim_interface_state.behavior_feedback.status_flags
    assert status == BehaviorStatus.WARNING_AUTO_TRANS
    taken = [(step["index"], step["foot"]) for step in sim.footsteps]
    assert taken == [(step.step_index, step.foot_index) for step in steps]
    for step, sent in zip(sim.footsteps, steps, strict=True):
        position = sent.pose.position
        assert step["commanded"][:2] == [position.x, position.y]
        error = math.dist(step["landed"][:2], (position.x, position.y))
        assert error <= LANDING_ERROR, step
        assert step["error_m"] == pytest.approx(error)
    # One walk in one piece.
    assert len([e for e in sim.events if e.kind == "behavior"]) == 2
    summary = sim.summary()
    assert summary["success"]
    assert summary["max_pelvis_tilt_rad"] < 0.25
    sim.advance(0.5)
    assert not sim.has_fallen


@pytest.fixture
def sim():
    return AtlasSimulation()


@pytest.mark.parametrize(("model", "count"), [("atlas", 12), ("atlas_v3", 6)])
def test_many_steps_ahead(walk, model, count):
    sim = AtlasSimulation(Scenario(model=model))
    path = Path(sim)
    for _ in range(count - 1):
        path.step(ahead=0.25)
    path.step()
    walk(sim, path.steps)
    assert_walked(sim, path.steps)
    way = (count - 1) * 0.25
    assert sim.pelvis_pose.translation()[0] == pytest.approx(way, abs=0.05)
    # At the pace that was asked for, from touchdown to touchdown.
    landings = [event.time for event in sim.events if event.kind == "footstep"]
    assert np.mean(np.diff(landings)) == pytest.approx(DURATION, rel=0.01)
    np.testing.assert_allclose(np.diff(landings), DURATION, rtol=0.035)


@pytest.mark.parametrize(
    ("moves", "axis", "way"),
    [([{"ahead": -0.2}] * 3 + [{}], 0, -0.6), ([{"left": 0.15}, {}] * 3, 1, 0.45)],
    ids=["backward", "sideways"],
)
def test_straight_in_other_directions(walk, sim, moves, axis, way):
    path = Path(sim)
    for move in moves:
        path.step(**move)
    walk(sim, path.steps)
    assert_walked(sim, path.steps)
    assert sim.pelvis_pose.translation()[axis] == pytest.approx(way, abs=0.05)


@pytest.mark.parametrize(
    ("distance", "speed"), [(5.0, 1.05), (-2.5, 0.7)], ids=["ahead", "backward"]
)
def test_a_fast_walk(walk, distance, speed):
    sim = AtlasSimulation(Scenario(seed=3, jitter=Jitter(mass=0.05)))
    gait = sim.scenario.controller_config().gait()
    report = sim.atlas_sim_interface_state
    footsteps = walk(sim, steps_ahead(report, distance, gait, speed))
    assert sim.current_behavior is Behavior.STAND
    assert max(step["error_m"] for step in footsteps) <= 0.03
    landings = [event.time for event in sim.events if event.kind == "footstep"]
    places = [step["landed"][0] for step in footsteps]
    # The fastest part of the walk: strides between the ramps.
    way = np.diff(places) / np.diff(landings)
    assert np.abs(way).max() == pytest.approx(speed, rel=0.1)


def test_ahead_on_the_estimated_state(walk):
    sim = AtlasSimulation(
        Scenario(
            model="atlas_v3",
            state="estimated",
            noise="rough",
            seed=2,
        )
    )
    path = Path(sim)
    for _ in range(7):
        path.step(ahead=0.25)
    path.step()
    walk(sim, path.steps)
    assert_walked(sim, path.steps)
    # The feet are truly where the last two steps were sent, but for 1 % of the way.
    drift = sim.summary()["estimator_drift"]["largest"]["position_m"]
    assert 0.0 < drift < 0.0175
    for step in path.steps[-2:]:
        sole = sim.plant.GetFrameByName(sim.robot.file.feet[step.foot_index].sole_frame)
        context = sim.plant.GetMyContextFromRoot(sim.context)
        there = sole.CalcPoseInWorld(context).translation()
        sent = step.pose.position
        off = math.dist(there[:2], (sent.x, sent.y))
        assert off < LANDING_ERROR + drift
    # It catches a push, and tilt and heading stay known within 1.5 mrad.
    sim.apply_push("utorso", [0.0, 120.0, 0.0], 0.2)
    sim.advance(2.0)
    assert not sim.has_fallen
    largest = sim.summary()["estimator_drift"]["largest"]
    assert largest["velocity_m_s"] < 0.04
    assert largest["tilt_rad"] < 1.5e-3
    assert largest["yaw_rad"] < 1.5e-3
