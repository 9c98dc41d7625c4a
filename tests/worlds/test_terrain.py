"""Terrain: the boxes of a scenario, their height, and a robot that stands on them."""

import math

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.scenario import Start
from atlas_drake.worlds.terrain import Block, surface_height


def test_the_surface_is_the_highest_top_face_or_the_ground():
    terrain = [
        Block(size=[2.0, 2.0, 0.1], position=[0.0, 0.0, 0.1]),
        Block(size=[0.4, 0.4, 0.05], position=[0.5, 0.0, 0.15]),
    ]
    assert surface_height(terrain, 0.5, 0.0) == pytest.approx(0.15)
    assert surface_height(terrain, 0.0, 0.9) == pytest.approx(0.1)
    assert surface_height(terrain, 1.2, 0.0) == 0.0
    assert surface_height([], 0.0, 0.0) == 0.0


def test_a_ramp_rises_along_its_face():
    pitch = -0.2
    ramp = Block(size=[2.0, 1.0, 0.1], position=[1.0, 0.0, 0.3], rpy=[0.0, pitch, 0.0])
    for x in (0.6, 1.0, 1.4):
        z = 0.3 + (x - 1.0) * math.tan(-pitch)
        assert surface_height([ramp], x, 0.2) == pytest.approx(z)


def test_the_top_face_is_where_it_was_put():
    block = Block(size=[1.0, 1.0, 0.4], position=[1.0, 2.0, 0.3], rpy=[0.1, 0.2, 0.3])
    top = block.X_WC @ np.array([0.0, 0.0, 0.2])
    np.testing.assert_allclose(top, [1.0, 2.0, 0.3], atol=1e-12)


@pytest.mark.slow
def test_a_robot_stands_on_a_block():
    top, friction = 0.10, 0.8
    block = Block(size=[2.0, 2.0, 0.1], position=[1.0, 0.5, top], friction=friction)
    start = Start(position=[1.0, 0.5], yaw=0.4)
    on_ground = AtlasSimulation(Scenario(start=start))
    sim = AtlasSimulation(Scenario(terrain=[block], start=start))
    lifted = sim.pelvis_pose.translation() - on_ground.pelvis_pose.translation()
    np.testing.assert_allclose(lifted, [0.0, 0.0, top], atol=1e-12)
    sim.advance(0.5)
    assert not sim.has_fallen
    for foot in sim.atlas_sim_interface_state.foot_pos_est:
        assert foot.position.z == pytest.approx(top, abs=0.002)
    weight = sim.atlas_state.l_foot.force.z + sim.atlas_state.r_foot.force.z
    assert weight == pytest.approx(sim.robot.mass * 9.81, rel=0.05)


def test_blocks_are_seen_and_have_their_own_friction():
    sim = AtlasSimulation(Scenario(terrain=[Block(friction=0.4), Block()]))
    world = sim.plant.world_body()
    assert len(sim.plant.GetVisualGeometriesForBody(world)) == 2
    inspector = sim.station.GetSubsystemByName("scene_graph").model_inspector()
    found = {}
    for geometry in sim.plant.GetCollisionGeometriesForBody(world):
        properties = inspector.GetProximityProperties(geometry)
        friction = properties.GetProperty("material", "coulomb_friction")
        name = inspector.GetName(geometry).split("::")[-1]
        found[name] = friction.static_friction()
    assert found == {"ground": 0.9, "terrain_0": 0.4, "terrain_1": 0.9}
