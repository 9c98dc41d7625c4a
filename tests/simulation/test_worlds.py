"""Worlds in a simulation: the robot stands where it starts, and replays show them."""

from pathlib import Path

import numpy as np
import pytest
from pydrake.geometry import Role

from atlas_drake import (
    AtlasSimulation,
    Behavior,
    Scenario,
    ScenarioError,
    Start,
    load_scenario,
    read_log,
)
from atlas_drake.clients.cli.main import main
from atlas_drake.clients.film.replay import make_replay
from atlas_drake.worlds.terrain import START_REACH
from atlas_drake.worlds.world_file import available_worlds

EXAMPLE = Path(__file__).parents[2] / "examples/scenarios/qual_task_1.yaml"


@pytest.mark.slow
@pytest.mark.parametrize("name", available_worlds())
def test_the_robot_stands_in_every_world(name, tmp_path):
    log = tmp_path / "run.mcap"
    sim = AtlasSimulation(Scenario(world=name), log=log)
    boxes = sim.scenario.all_terrain()
    inspector = sim.station.GetSubsystemByName("scene_graph").model_inspector()
    world = inspector.world_frame_id()
    ground = 1
    assert (
        inspector.NumGeometriesForFrameWithRole(world, Role.kProximity)
        == len(boxes) + ground
    )
    assert inspector.NumGeometriesForFrameWithRole(world, Role.kIllustration) == len(
        boxes
    )
    sim.advance(0.5)
    assert not sim.has_fallen
    assert sim.current_behavior is Behavior.STAND
    surface = 1.0 if name == "qual_task_1" else 0.0
    for foot in sim.atlas_sim_interface_state.foot_pos_est:
        assert foot.position.z == pytest.approx(surface, abs=0.002)
    place, _ = sim.scenario.start_pose()
    np.testing.assert_allclose(sim.pelvis_pose.translation()[:2], place, atol=0.03)
    sim.close()
    replay = make_replay(read_log(log))
    shown = replay.GetSubsystemByName("station").GetSubsystemByName("scene_graph")
    shown = shown.model_inspector()
    assert shown.NumGeometriesForFrameWithRole(
        shown.world_frame_id(), Role.kIllustration
    ) == len(boxes)


def test_boxes_of_any_number_can_stand_on_the_ground():
    sim = AtlasSimulation(Scenario(world={"stairs": {"number": 100}}))
    sim.advance(0.05)
    assert len(sim.scenario.all_terrain()) == 100


def test_the_ground_extends_to_every_allowed_start():
    sim = AtlasSimulation(Scenario(start=Start(position=[START_REACH, -START_REACH])))
    sim.advance(0.2)
    assert not sim.has_fallen
    loads = sim.output("foot_wrenches")[[5, 11]]
    assert sum(loads) == pytest.approx(9.81 * sim.robot.mass, rel=0.1)
    beyond = [0.0, 1.01 * START_REACH]
    with pytest.raises(ScenarioError, match=r"start.position\[1\].*equal to 5000"):
        Scenario(start=Start(position=beyond)).validate()
    with pytest.raises(ScenarioError, match=r"pose.position\[1\]"):
        sim.reset(pose=Start(position=beyond))
    world = {"start": {"position": beyond}}
    with pytest.raises(ScenarioError, match=r"world.start.position\[1\]"):
        Scenario(world=world).validate()


def test_a_reset_goes_back_to_where_the_world_has_the_robot_start():
    sim = AtlasSimulation(Scenario(world="qual_task_1"))
    begin = sim.pelvis_pose.translation()
    sim.reset(pose=Start(position=[3.0, 1.0]))
    np.testing.assert_allclose(
        sim.pelvis_pose.translation() - begin, [3.5, 1.0, 0.0], atol=1e-9
    )
    for pose in (None, Start()):
        sim.reset(pose=pose)
        np.testing.assert_allclose(sim.pelvis_pose.translation(), begin, atol=1e-9)


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_the_command_line_takes_a_world(capsys):
    arguments = ["run", str(EXAMPLE), "--headless"]
    arguments += ["--set", "duration=0.1", "--set", "schedule=none"]
    assert main([*arguments, "--set", "messages=[]", "--world", "rubble"]) == 0
    capsys.readouterr()
    assert main([*arguments, "--world", "stares"]) == 2
    assert "Did you mean 'stairs'" in capsys.readouterr().err


@pytest.mark.slow
def test_atlas_does_the_tutorial_in_its_pen_and_walks_out():
    sim = AtlasSimulation(load_scenario(EXAMPLE))
    sim.advance_to(17.0)
    # In the pen still, after the tutorial's four steps.
    assert len(sim.footsteps) == 4
    assert sim.pelvis_pose.translation()[0] < 0.3
    sim.advance_to(29.0)
    assert not sim.has_fallen
    assert sim.current_behavior is Behavior.STAND
    assert len(sim.footsteps) == 13
    for foot, side in zip(
        sim.atlas_sim_interface_state.foot_pos_est, (1.0, -1.0), strict=True
    ):
        assert foot.position.x == pytest.approx(2.0, abs=0.02)
        assert foot.position.y == pytest.approx(0.12 * side, abs=0.02)
        assert foot.position.z == pytest.approx(1.0, abs=0.01)
    assert sim.summary()["success"]


@pytest.mark.slow
@pytest.mark.parametrize(("lever", "opens"), [(0.0, False), (0.65, True)])
def test_the_door_opens_only_if_its_lever_is_pressed(lever, opens):
    sim = AtlasSimulation(Scenario(world="door"))
    context = sim.part("plant")[1]
    hinge, latch = map(sim.plant.GetJointByName, ("hinge", "latch"))
    latch.set_angle(context, lever)
    hinge.set_angular_rate(context, 2.0)
    sim.advance(0.5)
    assert (hinge.get_angle(context) > 0.15) == opens
    assert latch.get_angle(context) < 0.05
    assert hinge.get_angle(context) < 0.02 or opens
