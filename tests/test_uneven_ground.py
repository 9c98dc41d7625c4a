"""Walking on uneven ground: up and down a step, and over tilted footholds."""

import numpy as np
import pytest
from pydrake.math import RollPitchYaw, RotationMatrix

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasSimulation,
    Behavior,
    BehaviorStatus,
    Quaternion,
    Scenario,
    Vector3,
)
from atlas_drake.control.estimation.attitude import rotation_matrix
from atlas_drake.scenario import Jitter, Start
from atlas_drake.scenario.terrain import Block

pytestmark = pytest.mark.slow


HALF_WIDTH = 0.12
"""Of each foot from the middle [m]."""
HALF_SOLE = 0.13
"""[m]"""
MARGIN = 0.03
"""Between a sole and an edge [m]."""
LANDING_ERROR = 0.025
"""[m]"""


def step(index, x, y, z, R_WF=None):
    data = AtlasBehaviorStepData()
    data.step_index, data.foot_index = index, (index - 1) % 2
    data.duration, data.swing_height = 0.63, 0.1
    data.pose.position = Vector3(x, y, z)
    quaternion = (R_WF or RotationMatrix()).ToQuaternion()
    data.pose.orientation = Quaternion.from_wxyz(quaternion.wxyz())
    return data


def simulate(model, seed, terrain, x=0.0):
    """A robot that starts at ``x``, not quite as it believes."""
    jitter = Jitter(position=0.005, orientation=0.01, joints=0.01)
    return AtlasSimulation(
        Scenario(
            model=model,
            seed=seed,
            jitter=jitter,
            terrain=terrain,
            start=Start(position=[x, 0.0]),
        )
    )


def assert_walked(sim, steps):
    assert not sim.has_fallen
    assert sim.current_behavior is Behavior.STAND
    status = sim.atlas_sim_interface_state.behavior_feedback.status_flags
    assert status == BehaviorStatus.WARNING_AUTO_TRANS
    assert [s["index"] for s in sim.footsteps] == [s.step_index for s in steps]
    errors = [s["error_m"] for s in sim.footsteps]
    assert max(errors) <= LANDING_ERROR, errors


@pytest.mark.parametrize(
    ("model", "rise", "relative"),
    [("atlas", 0.10, False), ("atlas_v3", 0.06, True)],
    ids=["absolute", "relative"],
)
def test_up_a_step_and_down_again(walk, model, rise, relative):
    reach = HALF_SOLE + MARGIN
    length = 2.0 * reach
    block = Block(size=[length, 2.0, rise], position=[2.0 * reach, 0.0, rise])
    # With the toes off the block, also where the seed moves the robot.
    sim = simulate(model, int(relative), [block], x=-0.03)
    up, down = 2.0 * reach, 4.0 * reach
    places = [(up, rise), (up, rise), (down, 0.0), (down, 0.0)]
    # As each foot finds the ground from the one that stays behind.
    heights = [rise, 0.0, -rise, 0.0] if relative else [z for _, z in places]
    steps = [
        step(i + 1, x, HALF_WIDTH * (1 - 2 * (i % 2)), z)
        for i, ((x, _), z) in enumerate(zip(places, heights, strict=True))
    ]
    sim.advance(0.5)
    walk(sim, steps, use_relative_step_height=relative)
    assert_walked(sim, steps)
    landed = [s["landed_height"] for s in sim.footsteps]
    np.testing.assert_allclose(landed, [z for _, z in places], atol=0.02)
    for foot in sim.atlas_sim_interface_state.foot_pos_est:
        assert foot.position.z == pytest.approx(0.0, abs=0.003)


def test_tilted_footholds(walk):
    tilt, height = 0.1, 0.04
    tilts = [(tilt, 0.0), (0.0, -tilt), (-tilt, 0.0), (0.0, tilt)]
    terrain, steps = [], []
    for i, (roll, pitch) in enumerate(tilts):
        x, y = 0.2 * (i + 1), 0.14 * (1 - 2 * (i % 2))
        block = Block(
            size=[0.36, 0.22, 0.02], position=[x, y, height], rpy=[roll, pitch, 0.0]
        )
        terrain.append(block)
        R_WF = RollPitchYaw(roll, pitch, 0.0).ToRotationMatrix()
        steps.append(step(i + 1, x, y, height, R_WF))
    # The robot ends on the last two of them, and stands.
    sim = simulate("atlas", 1, terrain)
    sim.advance(0.5)
    walk(sim, steps)
    assert_walked(sim, steps)
    sim.advance(1.0)
    assert not sim.has_fallen
    for foot, (roll, pitch) in zip((0, 1), tilts[2:], strict=True):
        pose = sim.atlas_sim_interface_state.foot_pos_est[foot]
        assert pose.position.z == pytest.approx(height, abs=0.005)
        normal = rotation_matrix(pose.orientation.to_wxyz())[:, 2]
        expected = RollPitchYaw(roll, pitch, 0.0).ToRotationMatrix().matrix()[:, 2]
        np.testing.assert_allclose(normal, expected, atol=0.02)


@pytest.mark.parametrize("way", ["up", "down"])
def test_stairs_foot_over_foot(walk, way):
    rise, run, number, start = 0.15, 0.32, 6, 0.19
    heights = [rise * (k if way == "up" else number - k) for k in range(number + 1)]
    stairs = [
        Block(size=[run, 2.0, z], position=[start + (k - 0.5) * run, 0.0, z])
        for k, z in enumerate(heights)
        if k > 0 and z > 0.0
    ]
    # The floor at the upper end, before or behind the stairs.
    near, far = (start + number * run, 6.0) if way == "up" else (-2.0, start)
    top = max(heights)
    stairs.append(
        Block(size=[far - near, 2.0, top], position=[0.5 * (near + far), 0.0, top])
    )
    # Every tread takes one foot, and the last one both.
    treads = [*range(1, number + 1), number]
    steps = [
        step(i + 1, start + (k - 0.5) * run, HALF_WIDTH * (1 - 2 * (i % 2)), heights[k])
        for i, k in enumerate(treads)
    ]
    sim = simulate("atlas", 2, stairs)
    sim.advance(0.5)
    walk(sim, steps)
    assert_walked(sim, steps)
