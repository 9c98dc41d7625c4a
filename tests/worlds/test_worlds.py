"""Worlds as data: by name, by path, changed in part; every fault named."""

import dataclasses
import math
from dataclasses import replace
from pathlib import Path

import pytest
from pydrake.common.yaml import yaml_dump, yaml_load

from atlas_drake import Block, Scenario, ScenarioError, Start, load_scenario
from atlas_drake.config import as_plain
from atlas_drake.scenario import scenario_from, with_settings
from atlas_drake.worlds.terrain import surface_height
from atlas_drake.worlds.world_file import World, available_worlds, load_world

BALL = Path(__file__).parents[2] / "examples/scenarios/world/ball.sdf"
OWN = """
description: a table and a ball
start: {position: [1.0, 2.0], yaw: 0.5}
boxes: [{size: [1.0, 1.0, 0.7], position: [3.0, 0.0, 0.7], color: [0.1, 0.2, 0.3]}]
models: [{file: ball.sdf, X_WB: {translation: [3.0, 0.0, 0.8]}}]
rubble: {number: 5}
"""


@pytest.fixture
def own(tmp_path):
    """The path of a world of one's own, in a folder with a ball."""
    (tmp_path / "ball.sdf").write_text(BALL.read_text())
    path = tmp_path / "own.yaml"
    path.write_text(OWN)
    return path


def test_level_ground_is_the_default_and_adds_nothing():
    scenario = Scenario().validate()
    assert scenario.world.name == "level"
    assert scenario.all_terrain() == []
    assert scenario.all_models() == []
    assert scenario.start_pose() == ([0.0, 0.0], 0.0)
    assert load_world("level") == dataclasses.replace(
        World(), description="level ground"
    )


@pytest.mark.slow
def test_the_shipped_worlds_have_something_and_a_free_start():
    shipped = {"qual_task_1", "stairs", "ramp", "blocks", "rubble", "bricks", "tables"}
    shipped |= {"valve", "door", "box", "tray"}
    assert set(available_worlds()) == {"level"} | shipped
    for name in shipped:
        world = load_world(name)
        assert world.name == name
        assert world.description
        assert world.terrain() or world.models
        # Nothing but the platform is where the robot starts.
        x, y = world.start.position
        under = {surface_height(world.terrain(), x + dx, y) for dx in (-0.2, 0.0, 0.2)}
        assert under == {1.0 if name == "qual_task_1" else 0.0}


@pytest.mark.parametrize(
    "given",
    [
        {"name": "stairs", "stairs": {"rise": 0.05, "number": 2}},
        ["world=stairs", "world.stairs.rise=0.05", "world.stairs.number=2"],
        ["world.name=stairs", "world.stairs={rise: 5e-2, number: 2}"],
    ],
)
def test_a_part_of_a_world_can_be_changed(given):
    if isinstance(given, dict):
        scenario = Scenario(world=given).validate()
        assert scenario == scenario_from({"world": given})
    else:
        scenario = with_settings(Scenario(), given)
    assert scenario.world.stairs.run == load_world("stairs").stairs.run
    heights = [block.position[2] for block in scenario.all_terrain()]
    assert heights == pytest.approx([0.05, 0.10])


def test_settings_change_the_world_that_is_there():
    steep = with_settings(Scenario(world="ramp"), ["world.ramp.angle=0.3"])
    assert steep.world.name == "ramp"
    assert steep.world.ramp.angle == 0.3
    # Another world is read afresh.
    assert with_settings(steep, ["world=ramp"]).world == load_world("ramp")
    # Level ground can get an obstacle, and a world lose one.
    assert len(with_settings(Scenario(), ["world.stairs.number=3"]).all_terrain()) == 3
    assert with_settings(steep, ["world.ramp=null"]).all_terrain() == []


@pytest.mark.slow
def test_a_path_works_as_a_name_does(own):
    world = Scenario(world=str(own)).validate().world
    assert world.name == str(own)
    assert world.models[0].file == str(own.with_name("ball.sdf"))
    assert len(world.terrain()) == 6
    assert world.boxes[0].rgba.tolist() == [0.1, 0.2, 0.3, 1.0]
    beside = own.with_name("scenario.yaml")
    for text in ("world: own.yaml", "world: {name: own.yaml, rubble: {number: 1}}"):
        beside.write_text(f"{text}\nterrain: [{{}}]\nmodels: [{{file: ball.sdf}}]\n")
        scenario = load_scenario(beside)
        assert scenario.world.name == str(own)
        assert len(scenario.all_terrain()) in (3, 7)
        assert scenario.all_terrain()[-1] == Block()
        assert len(scenario.all_models()) == 2


def test_the_scenario_decides_where_the_robot_starts_and_then_the_world(own):
    scenario = Scenario(world=str(own)).validate()
    assert scenario.start_pose() == ([1.0, 2.0], 0.5)
    assert scenario.start_pose(Start(yaw=0.0)) == ([1.0, 2.0], 0.0)
    scenario = replace(scenario, start=Start(position=[0.0, 0.0]))
    assert scenario.start_pose() == ([0.0, 0.0], 0.5)


def test_a_logged_scenario_is_read_without_the_file_of_its_world(own):
    scenario = Scenario(world={"name": str(own), "rubble": {"seed": 4}}).validate()
    text = yaml_dump(as_plain(scenario))
    own.unlink()
    assert scenario_from(yaml_load(data=text)) == scenario


def test_bricks_are_rubble_by_their_seed_and_lie_apart():
    def places(seed):
        world = Scenario(world={"name": "rubble", "rubble": {"seed": seed}})
        return [block.position for block in world.validate().all_terrain()]

    assert places(3) == places(3) != places(4)
    found = places(3)
    assert len(found) == 60
    apart = min(math.dist(a, b) for i, a in enumerate(found) for b in found[:i])
    assert apart >= math.hypot(0.20, 0.10)


def test_sunk_bricks_have_tops_of_different_heights_above_the_ground():
    sunk = {"size": [0.10, 0.05, 0.027], "sunk": 0.017, "number": 40}
    world = Scenario(world={"name": "rubble", "rubble": sunk}).validate()
    tops = [block.position[2] for block in world.all_terrain()]
    assert 0.010 <= min(tops) < 0.013
    assert 0.024 < max(tops) <= 0.027


def test_obstacles_turn_and_move_with_their_frame():
    place = {"position": [1.0, 2.0, 0.5], "yaw": math.pi / 2}
    for name in ("stairs", "ramp", "blocks"):
        at_origin, moved = (
            Scenario(world={"name": name, name: where}).validate().all_terrain()
            for where in ({"position": [0.0, 0.0, 0.0], "yaw": 0.0}, place)
        )
        for x, y in ((0.2, 0.1), (0.75, 0.1), (1.2, -0.1)):
            height = surface_height(at_origin, x, y)
            assert height > 0.0
            found = surface_height(moved, 1.0 - y, 2.0 + x)
            assert found == pytest.approx(0.5 + height)


def test_blocks_are_tilted_and_reach_the_ground():
    blocks = Scenario(world="blocks").validate().all_terrain()
    assert len({tuple(block.rpy) for block in blocks}) == 4
    for block in blocks:
        for x in (-0.18, 0.18):
            for y in (-0.18, 0.18):
                corner = block.X_WC @ [x, y, -0.5 * block.size[2]]
                assert corner[2] <= 1e-9


def test_the_tutorials_world_has_the_figures_of_the_task():
    boxes = load_world("qual_task_1").terrain()
    found = {(*box.size, *box.position) for box in boxes}
    assert (20.0, 22.0, 1.0, 7.0, 0.0, 1.0) in found
    assert (5.0, 7.0, 1.0, 22.0, 8.0, 1.0) in found
    for x, y in ((17.4, 8.0), (17.9, 8.5), (18.6, 8.5), (19.1, 8.0)):
        assert (0.5, 0.5, 1.0, x, y, 1.0) in found
    for x, y, turned in ((1, 0, 0), (6, 0, 0), (10, 4, 1), (14, 8, 0), (22, 8, 0)):
        for side in (-2.5, 2.5):
            post = (x + side, y) if turned else (x, y + side)
            assert (0.2, 0.2, 4.0, *post, 5.0) in found
        lintel = (5.2, 0.2, 0.2) if turned else (0.2, 5.2, 0.2)
        assert (*lintel, x, y, 5.2) in found


FAULTS = {
    "world": ["stair", "nowhere.yaml", 3, {"name": "ramps"}],
    "world.name": [{"name": 3}],
    "world.boxs": [{"boxs": []}],
    "world.stairs.rises": [{"stairs": {"rises": 0.1}}],
    "world.stairs.rise": [{"stairs": {"rise": 0.0}}],
    "world.stairs.number": [{"stairs": {"number": 0}}, {"stairs": {"number": 2.5}}],
    "world.ramp.angle": [{"ramp": {"angle": 1.2}}, {"ramp": {"angle": "steep"}}],
    "world.ramp.yaw": [{"ramp": {"yaw": math.nan}}],
    "world.blocks.heights": [{"blocks": {"heights": []}}],
    "world.blocks.heights[0]": [{"blocks": {"heights": [0.0]}}],
    "world.rubble.number": [{"rubble": {"number": 900}}],
    "world.rubble.size": [{"rubble": {"size": [0.2, 0.1]}}],
    "world.rubble.sunk": [{"rubble": {"sunk": 0.05}}],
    "world.boxes[0].color[2]": [{"boxes": [{"color": [0, 0, 2]}]}],
    "world.models[0].file": [{"models": [{"file": "no.sdf"}]}],
    "world.start.position": [{"start": {"position": [1]}}],
    "world.view.lens": [{"view": {"lens": [1, 1, 1], "target": [1, 1, 1]}}],
}


@pytest.mark.parametrize("field", FAULTS)
def test_a_world_that_cannot_be_used_is_named(field):
    for world in FAULTS[field]:
        with pytest.raises(ScenarioError) as error:
            Scenario(world=world).validate()
        assert error.value.field == field


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("name: mine", "world.name"),
        ("steps: {}", "world.steps"),
        ("stairs: {rise: 0}", "world.stairs.rise"),
        ("boxes: [{size: [1, 1, 0]}]", "world.boxes[0].size"),
    ],
)
def test_a_faulty_file_is_named_with_its_field(text, field, own):
    own.write_text(text)
    with pytest.raises(ScenarioError) as error:
        load_world(own)
    assert error.value.field == field
    assert str(own) in str(error.value)
