"""A replay shows the contents of the log in the same way as the run."""

import numpy as np
import pytest
from pydrake.common.yaml import yaml_dump
from pydrake.geometry import Meshcat
from pydrake.systems.analysis import Simulator

from atlas_drake import (
    AtlasSimulation,
    LogError,
    Scenario,
    read_log,
)
from atlas_drake.clients.film.replay import make_replay
from atlas_drake.clients.view.colors import joint_colors
from atlas_drake.clients.view.meshcat_shapes import PATH
from atlas_drake.clients.view.overlays import OVERLAYS, Overlays, logged_overlays
from atlas_drake.clients.view.shapes import shapes_of
from atlas_drake.config import as_plain
from atlas_drake.frozen import replace
from atlas_drake.scenario.scenario import LogContent
from atlas_drake.worlds.terrain import Block

from .conftest import walk_command, with_header


@pytest.fixture(scope="module")
def meshcat():
    return Meshcat()


class Replayed:
    """The output ports of a log's replay at any time."""

    def __init__(self, log, **options):
        diagram = make_replay(log, **options)
        self._root = diagram.CreateDefaultContext()
        self.station = diagram.GetSubsystemByName("station")
        self._own = self.station.GetMyContextFromRoot(self._root)

    def at(self, time, name="record"):
        self._root.SetTime(time)
        return self.station.GetOutputPort(name).Eval(self._own)


def test_bodies_are_where_the_log_has_them(run, meshcat):
    sim, log = run
    replayed, plant = Replayed(log, meshcat=meshcat), sim.plant
    scratch = plant.CreateDefaultContext()
    for row in (0, len(log) // 2, len(log) - 1):
        query = replayed.at(log.time[row], "query_object")
        inspector = query.inspector()
        poses = {
            inspector.GetName(frame): query.GetPoseInWorld(frame).GetAsMatrix4()
            for frame in inspector.GetAllFrameIds()
        }
        plant.SetPositions(scratch, log["state.q"][row])
        for name in sim.robot.body_names:
            X_WB = plant.EvalBodyPoseInWorld(scratch, plant.GetBodyByName(name))
            np.testing.assert_allclose(
                poses[f"atlas::{name}"], X_WB.GetAsMatrix4(), atol=1e-12
            )


def test_the_record_is_that_of_the_tick_before_as_in_a_run(log):
    replayed, period = Replayed(log), log.header.control_period
    last = len(log) - 1
    for time, row, before in (
        (0.0, 0, 0),
        (1.5 * period, 1, 1),
        (2.0 * period, 2, 1),
        (99.0, last, last),
    ):
        shown = replayed.at(time)
        assert shown == replace(log.record(before), paths=shown.paths)
        # Paths are kept every 0.1 s, and shown until the next ones.
        assert shown.paths is not None
        np.testing.assert_array_equal(
            replayed.at(time, "plant_state"),
            np.concatenate([log["state.q"][row], log["state.v"][row]]),
        )


def test_what_is_seen_is_what_was_seen(recorded):
    sim, log, records = recorded
    replayed, sole, shown = Replayed(log), sim.robot.file.sole, set()
    for record in (*records, sim.record):
        # As in the run, a picture has the paths that were planned last.
        again = replayed.at(record.time + 1e-3)
        live = replace(record, paths=again.paths)
        assert again == live
        was = shapes_of(live, OVERLAYS, sole)
        is_now = shapes_of(again, OVERLAYS, sole)
        for a, b in zip(is_now, was, strict=True):
            assert (a.name, a.solid.key, a.length) == (b.name, b.solid.key, b.length)
            assert a.X_WS.IsExactlyEqualTo(b.X_WS)
        for on in (["owner"], ["effort"]):
            colors = joint_colors(live, on, sim.robot)
            assert joint_colors(again, on, log.robot) == colors
        shown |= {one.name for one in was}
    assert {"support", "plan_com", "cop"} <= shown
    assert sum(one.name == "footsteps" for one in was) >= 4
    assert again.request == walk_command()


def test_a_replay_shows_robot_footsteps_and_balance(log):
    meshcat = Meshcat()
    overlays = Overlays(logged_overlays(log.scenario.log))
    simulator = Simulator(make_replay(log, meshcat, overlays))
    for name in ("owner", "effort"):
        overlays.switch(name, True)
        simulator.AdvanceTo(simulator.get_context().get_time() + 0.05)
    assert meshcat.HasPath("/drake/visualizer/atlas/pelvis")
    for name in ("com_ball", "dcm", "cop", "support"):
        assert meshcat.HasPath(f"{PATH}/{name}")
    assert not meshcat.HasPath(f"{PATH}/forces")
    simulator.AdvanceTo(log.time[-1])
    assert meshcat.HasPath(f"{PATH}/footsteps")


def test_contact_forces_are_shown_if_the_scenario_asks_for_them(tmp_path):
    scenario = Scenario(log=LogContent(contacts=True, paths=False))
    with AtlasSimulation(scenario, log=tmp_path / "run.mcap") as sim:
        sim.advance(0.05)
    log = read_log(tmp_path / "run.mcap")
    overlays = Overlays(logged_overlays(log.scenario.log))
    assert "forces" in overlays.on
    assert "plan" not in overlays.on
    record = Replayed(log).at(0.04)
    assert record.paths is None
    weight = sum(contact.force_W[2] for contact in record.contacts)
    assert weight == pytest.approx(sum(record.feet.loads), rel=0.2)
    shapes = shapes_of(record, overlays.on, log.robot.file.sole)
    assert sum(shape.name.startswith("forces") for shape in shapes) == len(
        record.contacts
    )


def test_terrain_is_shown(log, scenario, meshcat):
    rough = yaml_dump(as_plain(replace(scenario, terrain=[Block()])))
    terrain = with_header(log, scenario=rough)
    scene = Replayed(terrain, meshcat=meshcat).station.GetSubsystemByName("scene_graph")
    inspector = scene.model_inspector()
    names = [inspector.GetName(key) for key in inspector.GetAllGeometryIds()]
    assert any("terrain_0" in name for name in names)


def test_a_scenario_that_this_version_cannot_read_is_named(log):
    with pytest.raises(LogError, match="gravity"):
        make_replay(with_header(log, scenario="gravity: up\n"))
