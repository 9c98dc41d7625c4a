"""A station stands on its feet in its default context, and after placement."""

import numpy as np
import pytest
from pydrake.math import RollPitchYaw
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from atlas_drake import Block, InvalidMessageError, Scenario, place_robot
from atlas_drake.diagrams.atlas_station import make_atlas_station
from atlas_drake.robot import load_robot

BLOCK = Block(size=[0.8, 0.8, 0.1], position=[0.0, 0.0, 0.1])


def make(model="atlas", terrain=()):
    """A station inside a diagram of somebody else's, and its default context."""
    robot = load_robot(model)
    builder = DiagramBuilder()
    scenario = Scenario(terrain=list(terrain))
    station = builder.AddSystem(make_atlas_station(robot, scenario))
    return robot, station, Simulator(builder.Build())


@pytest.fixture(scope="module")
def station_at_rest():
    return make()


def sole_heights(robot, station, root):
    plant = station.GetSubsystemByName("plant")
    context = plant.GetMyContextFromRoot(root)
    frames = [plant.GetFrameByName(foot.sole_frame) for foot in robot.file.feet]
    return [frame.CalcPoseInWorld(context).translation()[2] for frame in frames]


@pytest.mark.parametrize("model", ["atlas", "atlas_v3"])
@pytest.mark.parametrize("terrain", [(), (BLOCK,)])
def test_by_default_the_robot_stands_at_rest_on_what_is_there(model, terrain):
    robot, station, simulator = make(model, terrain)
    root = simulator.get_context()
    ground = 0.1 if terrain else 0.0
    np.testing.assert_allclose(sole_heights(robot, station, root), ground, atol=2e-3)
    plant = station.GetSubsystemByName("plant")
    context = plant.GetMyContextFromRoot(root)
    q = plant.GetPositions(context)
    np.testing.assert_array_equal(q[robot.indices(plant).q], robot.stand_prep)
    assert not plant.GetVelocities(context).any()


def test_the_robot_is_placed_with_one_call():
    robot, station, simulator = make(terrain=[BLOCK])
    plant = station.GetSubsystemByName("plant")
    root = simulator.get_mutable_context()
    context = plant.GetMyMutableContextFromRoot(root)
    place_robot(plant, context, robot, position=(2.0, -1.0), rpy=(0.0, 0.0, 0.7))
    X_WP = plant.GetBodyByName("pelvis").EvalPoseInWorld(context)
    np.testing.assert_allclose(X_WP.translation()[:2], [2.0, -1.0])
    assert RollPitchYaw(X_WP.rotation()).yaw_angle() == pytest.approx(0.7)
    np.testing.assert_allclose(sole_heights(robot, station, root), 0.0, atol=2e-3)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("position", "ab"),
        ("position", (float("nan"), 0.0)),
        ("rpy", (0.0, 0.0, 1e308)),
        ("joints", [0.0] * 27),
        ("clearance", "x"),
    ],
)
def test_an_invalid_placement_is_refused(station_at_rest, field, value):
    robot, station, simulator = station_at_rest
    plant = station.GetSubsystemByName("plant")
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    with pytest.raises(InvalidMessageError, match=field):
        place_robot(plant, context, robot, **{field: value})
