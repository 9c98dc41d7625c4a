"""A teleoperation session with a simulated robot."""

import time

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Behavior
from atlas_drake.teleop.controls import (
    PELVIS_HEIGHT,
    PUSH_IMPULSE,
    SHARES,
    STRIDE,
    Action,
)
from atlas_drake.teleop.session import SINGLE_STEP, SLICE, Session

ACTS_WITHIN = 0.1
"""Simulated time from a click to the controller's having heard it [s]."""


@pytest.fixture(scope="module")
def shared_sim():
    return AtlasSimulation()


class Steered:
    def __init__(self, sim, panel):
        self.sim = sim
        self.session = Session(self.sim, panel, real_time=False)

    def go(self, seconds):
        end = self.sim.time + seconds - 1e-6
        while self.sim.time < end:
            self.session.advance()

    def heading(self):
        R = self.sim.pelvis_pose.rotation().matrix()
        return float(np.arctan2(R[1, 0], R[0, 0]))


@pytest.fixture
def steered(shared_sim, panel):
    shared_sim.reset(seed=0)
    return Steered(shared_sim, panel)


def test_a_click_acts_within_a_tenth_of_a_second(steered, panel):
    steered.go(SLICE)
    panel.press(Action.WALK)
    steered.go(ACTS_WITHIN)
    assert steered.sim.current_behavior is Behavior.WALK


def test_time_stands_still_while_paused(steered, panel):
    sim, session = steered.sim, steered.session
    session.advance()
    panel.press(Action.PAUSE)
    session.advance()
    panel.press(Action.FREEZE)
    session.advance()
    assert sim.time == pytest.approx(SLICE)
    panel.press(Action.SINGLE_STEP)
    session.advance()
    assert sim.time == pytest.approx(SLICE + SINGLE_STEP)
    assert session.paused
    assert panel.paused
    assert sim.current_behavior is Behavior.FREEZE
    panel.press(Action.PAUSE)
    session.advance()
    assert not panel.paused
    assert sim.time == pytest.approx(2 * SLICE + SINGLE_STEP)


def test_a_session_is_no_faster_than_real_time(steered, panel):
    session = Session(steered.sim, panel)
    begin = time.perf_counter()
    for _ in range(2):
        session.advance()
    assert time.perf_counter() - begin >= 2 * SLICE


def test_reset_works_while_paused(steered, panel):
    sim, session = steered.sim, steered.session
    session.advance()
    panel.set(SHARES["neck"], 255)
    session.advance()
    session.advance()
    assert any(sim.atlas_sim_interface_state.k_effort)
    panel.press(Action.PAUSE)
    session.advance()
    panel.press(Action.RESET)
    session.advance()
    assert not any(sim.atlas_sim_interface_state.k_effort)


@pytest.mark.slow
def test_walking_pushing_and_stopping(steered, panel):
    sim = steered.sim
    steered.go(0.2)
    panel.press(Action.FORWARD)
    steered.go(2.5)
    assert sim.pelvis_pose.translation()[0] > 0.25
    panel.set(PUSH_IMPULSE, 8.0)
    panel.press(Action.PUSH)
    steered.go(0.3)
    assert any(event.kind == "push" for event in sim.events)
    panel.press(Action.ARC_LEFT)
    steered.go(1.5)
    assert steered.heading() > 0.1
    panel.press(Action.STOP)
    steered.go(3.0)
    assert sim.current_behavior is Behavior.STAND
    assert not sim.has_fallen
    left, right = (foot.position for foot in sim.atlas_sim_interface_state.foot_pos_est)
    assert np.hypot(left.x - right.x, left.y - right.y) == pytest.approx(0.24, abs=0.02)
    assert not any(event.kind in ("refusal", "warning") for event in sim.events)


@pytest.mark.slow
def test_random_keys_at_any_moment_do_not_make_the_robot_fall(steered, panel):
    sim = steered.sim
    random = np.random.default_rng(1)
    keys = [a for a in Action if a.key.cap in "uiojklm,."]
    panel.set(STRIDE, 0.25)
    for _ in range(10):
        panel.press(keys[random.integers(len(keys))])
        steered.go(random.uniform(0.2, 1.0))
        assert not sim.has_fallen
    panel.press(Action.STOP)
    steered.go(3.0)
    assert sim.current_behavior is Behavior.STAND


@pytest.mark.slow
def test_the_pelvis_and_an_arm_follow_their_sliders(steered, panel):
    sim = steered.sim
    elbow = sim.robot.joint_index("l_arm_ely")
    steered.go(0.2)
    panel.press(Action.MANIPULATE)
    panel.set(SHARES["left arm"], 255)
    steered.go(0.4)
    panel.set(PELVIS_HEIGHT, 0.8)
    panel.joints[elbow] = 1.2
    steered.go(2.5)
    assert sim.current_behavior is Behavior.MANIPULATE
    assert sim.pelvis_pose.translation()[2] == pytest.approx(0.8, abs=0.01)
    assert sim.atlas_state.position[elbow] == pytest.approx(1.2, abs=0.05)
    panel.press(Action.RESET)
    steered.go(0.5)
    assert sim.current_behavior is Behavior.STAND
    assert panel.joints == {}
    assert not any(sim.atlas_sim_interface_state.k_effort)


@pytest.mark.slow
def test_user_and_back(steered, panel):
    sim = steered.sim
    steered.go(0.2)
    panel.press(Action.USER)
    steered.go(1.0)
    assert set(sim.atlas_sim_interface_state.k_effort) == {255}
    panel.press(Action.STAND)
    steered.go(1.0)
    assert sim.current_behavior is Behavior.STAND
    assert not any(sim.atlas_sim_interface_state.k_effort)
    panel.press(Action.STEP)
    steered.go(4.0)
    assert [step["index"] for step in sim.footsteps] == [1]
    assert not sim.has_fallen
