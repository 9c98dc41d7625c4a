"""Walking beyond the tutorial: directions, speed, estimated state, uneven ground."""

import math
from pathlib import Path

import numpy as np
import pytest
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimulation,
    Behavior,
    BehaviorStatus,
    Gait,
    Quaternion,
    Scenario,
    Vector3,
    nearest_velocity,
    steps_ahead,
    steps_to,
    walk_at,
)
from atlas_drake.rotations import rotation_matrix
from atlas_drake.scenario import Jitter, Start
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.worlds.terrain import Block

pytestmark = pytest.mark.slow

HERON = str(Path(__file__).parent / "robots" / "heron" / "heron.yaml")
HALF_WIDTH = 0.12
"""Of each foot from the middle [m]."""
HALF_SOLE = 0.13
"""[m]"""
MARGIN = 0.03
"""Between a sole and an edge [m]."""
GAIT = Gait(stride=0.25, duration=0.65)
"""No multiple of the control period."""


def step(index, x, z, R_WF=None, half_width=HALF_WIDTH):
    """A step of the left foot if the index is odd, of the right one if it is even."""
    foot = (index - 1) % 2
    data = AtlasBehaviorStepData(index, foot, duration=0.63, swing_height=0.1)
    data.pose.position = Vector3(x, half_width * (1 - 2 * foot), z)
    quaternion = (R_WF or RotationMatrix()).ToQuaternion()
    data.pose.orientation = Quaternion.from_wxyz(quaternion.wxyz())
    return data


def assert_walked(sim, steps, largest_error=0.02):
    """One walk in one piece took every step and ended in STAND."""
    assert not sim.has_fallen
    assert sim.current_behavior is Behavior.STAND
    status = sim.atlas_sim_interface_state.behavior_feedback.status_flags
    assert status == BehaviorStatus.WARNING_AUTO_TRANS
    assert len([e for e in sim.events if e.kind == "behavior"]) == 2
    taken = [(step["index"], step["foot"]) for step in sim.footsteps]
    assert taken == [(step.step_index, step.foot_index) for step in steps]
    for step, sent in zip(sim.footsteps, steps, strict=True):
        position = sent.pose.position
        assert step["commanded"][:2] == [position.x, position.y]
        error = math.dist(step["landed"][:2], (position.x, position.y))
        assert step["error_m"] == pytest.approx(error)
        assert error <= largest_error, step
    assert sim.summary()["success"]


@pytest.mark.parametrize(
    ("model", "goal"),
    [
        ("atlas_v3", (1.5, 0.0)),
        ("atlas", (0.0, 0.45)),
    ],
    ids=["ahead", "sideways"],
)
def test_a_walk_arrives_at_its_pace(walk, model, goal):
    sim = AtlasSimulation(Scenario(model=model))
    steps = steps_to(sim.atlas_sim_interface_state, *goal, 0.0, GAIT)
    walk(sim, steps)
    assert_walked(sim, steps)
    assert sim.pelvis_pose.translation()[:2] == pytest.approx(goal, abs=0.05)
    assert sim.summary()["max_pelvis_tilt_rad"] < 0.25
    landings = [event.time for event in sim.events if event.kind == "footstep"]
    np.testing.assert_allclose(np.diff(landings), GAIT.duration, rtol=0.035)
    assert np.mean(np.diff(landings)) == pytest.approx(GAIT.duration, rel=0.01)


@pytest.mark.parametrize(
    ("distance", "speed"), [(5.0, 1.05), (-2.5, 0.7)], ids=["ahead", "backward"]
)
def test_a_fast_walk(walk, distance, speed):
    sim = AtlasSimulation(Scenario(seed=3, jitter=Jitter(mass=0.05)))
    gait = sim.scenario.controller_config().gait()
    steps = steps_ahead(sim.atlas_sim_interface_state, distance, gait, speed)
    footsteps = walk(sim, steps)
    assert_walked(sim, steps, largest_error=0.03)
    landings = [event.time for event in sim.events if event.kind == "footstep"]
    places = [step["landed"][0] for step in footsteps]
    # The fastest part of the walk: strides between the ramps.
    way = np.diff(places) / np.diff(landings)
    assert np.abs(way).max() == pytest.approx(speed, rel=0.1)


STEADY = {
    "ahead": {"forward": 0.4},
    "back": {"forward": -0.4},
    "aside": {"left": 0.2},
    "turning": {"turn": 0.5},
}
"""Velocities, as far as the robot walks them [m/s], [rad/s]."""


@pytest.mark.parametrize(
    ("model", "way"),
    [*(("atlas", way) for way in STEADY), (HERON, "ahead"), (HERON, "turning")],
)
def test_the_forces_give_the_cmp_that_balance_commands(model, way):
    sim = AtlasSimulation(Scenario(model=model))
    gait = sim.scenario.controller_config().gait()
    velocity = nearest_velocity(**STEADY[way], gait=gait)
    apart, dcm_error, at_edge = [], [], []
    sim.advance(0.5)
    while sim.time < 5.0:
        sim.publish(walk_at(sim.atlas_sim_interface_state, *velocity, gait=gait))
        for _ in range(10):
            sim.advance(sim.scenario.control_period)
            balance, loads = sim.record.balance, sim.record.feet.loads
            # One foot down, and the walk is steady.
            if sim.time > 2.5 and min(loads) <= 0.0:
                apart.append(math.dist(balance.cmp, balance.cmp_reference))
                dcm_error.append(math.dist(balance.dcm, balance.dcm_reference))
                corners = balance.support[~np.isnan(balance.support[:, 0])]
                outside = SupportPolygon(corners).distance_outside(balance.cop)
                at_edge.append(outside > -0.002)
    assert not sim.has_fallen
    assert max(apart) < 0.03
    assert np.percentile(dcm_error, 95) < 0.015
    assert np.mean(at_edge) <= 0.01
    assert max(step["error_m"] for step in sim.footsteps) < 0.01


def test_ahead_on_the_estimated_state(walk):
    sim = AtlasSimulation(
        Scenario(model="atlas_v3", state="estimated", noise="rough", seed=2)
    )
    steps = steps_ahead(sim.atlas_sim_interface_state, 1.75, GAIT)
    walk(sim, steps)
    assert_walked(sim, steps)
    # The feet are truly where the last two steps were sent, but for 1 % of the way.
    drift = sim.summary()["estimator_drift"]["largest"]["position_m"]
    assert 0.0 < drift < 0.0175
    for sent in steps[-2:]:
        sole = sim.robot.file.feet[sent.foot_index].sole_frame
        there = sim.frame_pose(sole).translation()
        off = math.dist(there[:2], (sent.pose.position.x, sent.pose.position.y))
        assert off < 0.02 + drift
    # It catches a push, and tilt and heading stay known within 1.5 mrad.
    sim.apply_push("utorso", [0.0, 120.0, 0.0], 0.2)
    sim.advance(2.0)
    assert not sim.has_fallen
    largest = sim.summary()["estimator_drift"]["largest"]
    assert largest["velocity_m_s"] < 0.04
    assert largest["tilt_rad"] < 1.5e-3
    assert largest["yaw_rad"] < 1.5e-3


def walk_over(walk, terrain, steps, model="atlas", seed=1, x=0.0, **params):
    """A walk of a robot that starts at ``x``, not quite as it believes."""
    jitter = Jitter(position=0.005, orientation=0.01, joints=0.01)
    start = Start(position=[x, 0.0])
    sim = AtlasSimulation(
        Scenario(model=model, seed=seed, jitter=jitter, terrain=terrain, start=start)
    )
    sim.advance(0.5)
    walk(sim, steps, **params)
    assert_walked(sim, steps, largest_error=0.025)
    return sim


@pytest.mark.parametrize(
    ("model", "rise", "relative"),
    [("atlas", 0.10, False), ("atlas_v3", 0.06, True)],
    ids=["absolute", "relative"],
)
def test_up_a_step_and_down_again(walk, model, rise, relative):
    reach = HALF_SOLE + MARGIN
    block = Block(size=[2 * reach, 2.0, rise], position=[2 * reach, 0.0, rise])
    places = [(2 * reach, rise)] * 2 + [(4 * reach, 0.0)] * 2
    # As each foot finds the ground from the one that stays behind.
    heights = [rise, 0.0, -rise, 0.0] if relative else [z for _, z in places]
    steps = [step(i, places[i - 1][0], heights[i - 1]) for i in range(1, 5)]
    # With the toes off the block, also where the seed moves the robot.
    options = {"x": -0.03, "use_relative_step_height": relative}
    sim = walk_over(walk, [block], steps, model, int(relative), **options)
    landed = [s["landed_height"] for s in sim.footsteps]
    np.testing.assert_allclose(landed, [z for _, z in places], atol=0.02)
    for foot in sim.atlas_sim_interface_state.foot_pos_est:
        assert foot.position.z == pytest.approx(0.0, abs=0.003)


def test_tilted_footholds(walk):
    tilt, height, half_width = 0.1, 0.04, 0.14
    tilts = [(tilt, 0.0), (0.0, -tilt), (-tilt, 0.0), (0.0, tilt)]
    terrain, steps = [], []
    for index, (roll, pitch) in enumerate(tilts, 1):
        R_WF = RollPitchYaw(roll, pitch, 0.0).ToRotationMatrix()
        steps.append(step(index, 0.15 + 0.2 * index, height, R_WF, half_width))
        position = steps[-1].pose.position.to_array()
        rpy = [roll, pitch, 0.0]
        terrain.append(Block(size=[0.36, 0.22, 0.02], position=position, rpy=rpy))
    # The robot ends on the last two of them, and stands.
    sim = walk_over(walk, terrain, steps)
    sim.advance(1.0)
    assert not sim.has_fallen
    for foot, sent in zip((0, 1), steps[2:], strict=True):
        pose = sim.atlas_sim_interface_state.foot_pos_est[foot]
        assert pose.position.z == pytest.approx(height, abs=0.005)
        normal, expected = (
            rotation_matrix(one.orientation.to_wxyz())[:, 2]
            for one in (pose, sent.pose)
        )
        np.testing.assert_allclose(normal, expected, atol=0.02)


@pytest.mark.parametrize("way", ["up", "down"])
def test_stairs_foot_over_foot(walk, way):
    rise, run, number, start = 0.20, 0.30, 4, 0.19
    heights = [rise * (k if way == "up" else number - k) for k in range(number + 1)]
    stairs = [
        Block(size=[run, 2.0, z], position=[start + (k - 0.5) * run, 0.0, z])
        for k, z in enumerate(heights)
        if k > 0 and z > 0.0
    ]
    # The floor at the upper end, before or behind the stairs.
    near, far = (start + number * run, 6.0) if way == "up" else (-2.0, start)
    middle, top = 0.5 * (near + far), max(heights)
    stairs.append(Block(size=[far - near, 2.0, top], position=[middle, 0.0, top]))
    # Every tread takes one foot, and the last one both.
    treads = [*range(1, number + 1), number]
    steps = [
        step(i, start + (k - 0.5) * run, heights[k]) for i, k in enumerate(treads, 1)
    ]
    sim = walk_over(walk, stairs, steps, seed=2)
    knees = [leg.knee for leg in sim.robot.legs]
    assert max(sim.output("peaks")[knees]) < 0.95
