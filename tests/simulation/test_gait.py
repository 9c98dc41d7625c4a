"""WALK rolls from heel to toes ahead, and nowhere else."""

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.clients.steering.step_stream import StepStream
from atlas_drake.planning.footstep_planner import steps_ahead

FLAT = {"roll": {"toe_off": 0.0, "heel_first": 0.0}, "com_rise": 0.0}
WALKING = slice(250, None)
"""Ticks after the first steps."""


def walk(distance, **settings):
    """Records of a walk that is still going on at its end."""
    records = []
    scenario = Scenario(controller={"walk": settings})
    with AtlasSimulation(scenario) as sim:
        sim.advance(0.5)
        gait = sim.scenario.controller_config().gait(stride=0.3)
        plan = steps_ahead(sim.atlas_sim_interface_state, distance, gait)
        steps = StepStream(plan)
        while sim.time < 3.9:
            sim.publish(steps.next_command(sim.atlas_sim_interface_state))
            sim.advance(0.009)
            records.append(sim.record)
        assert not sim.has_fallen
    return records[WALKING]


@pytest.fixture(scope="module")
def rolling():
    return walk(3.0)


def pitches(records):
    """Pitch of both soles in each tick [rad], shape (k, 2)."""
    return np.array([[pitch_of(q) for q in r.feet.orientations] for r in records])


def pitch_of(wxyz):
    w, x, y, z = wxyz
    return float(np.arcsin(np.clip(2.0 * (w * y - x * z), -1.0, 1.0)))


def loads(records):
    """Vertical forces on both feet [N], shape (k, 2)."""
    return np.array([r.feet.loads for r in records])


def stance_knee(records):
    """Mean bend of the knees of loaded legs [rad]."""
    knees = np.array([r.joints.position for r in records])[:, [7, 13]]
    return float(knees[loads(records) > 200.0].mean())


@pytest.mark.slow
def test_ahead_it_leaves_on_the_toes_and_lands_on_the_heel_with_straighter_knees(
    rolling,
):
    flat = walk(3.0, **FLAT)
    pitch = pitches(rolling)
    on_ground = loads(rolling) > 20.0
    assert pitch[on_ground].max() > 0.15, "a heel rises while its toes carry load"
    assert pitch[on_ground].min() < -0.03, "a heel carries load before its toes"
    assert np.abs(pitches(flat)[loads(flat) > 20.0]).max() < 0.03
    assert stance_knee(rolling) < 0.75 * stance_knee(flat)


@pytest.mark.slow
def test_backward_the_soles_stay_flat():
    records = walk(-2.0)
    assert np.abs(pitches(records)[loads(records) > 20.0]).max() < 0.03


@pytest.mark.slow
def test_arms_swing_against_the_legs(rolling):
    joints = np.array([r.joints.position for r in rolling])
    feet = np.array([r.feet.left_position - r.feet.right_position for r in rolling])
    # Shoulders, whose positive pitch takes the hand back.
    left, right = joints[:, 16], joints[:, 22]
    apart = np.corrcoef(right - left, -feet[:, 0])[0, 1]
    assert apart > 0.9
    assert np.ptp(left) > 0.1
