"""A log in the cockpit: its frames, jumps in time, columns, and what is refused."""

import numpy as np
import orjson
import pytest

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    InvalidMessageError,
    read_log,
)
from atlas_drake.clients.cockpit.log_page import MOST_POINTS, LogPage
from atlas_drake.clients.view.overlays import Overlays

from .conftest import Asked

END = 0.8
"""End of the run [s]."""
COLUMNS = ["balance.com.x", "joints.effort.l_leg_kny", "feet.left_force.z"]


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("playback") / "run.mcap"
    with AtlasSimulation(log=path) as sim:
        sim.advance(0.1)
        sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))
        sim.advance(END - 0.1)
    return read_log(path)


@pytest.fixture
def replay(log, meshcat):
    return Asked(LogPage(log, [], meshcat, Overlays(["com"])))


@pytest.mark.slow
def test_a_frame_shows_the_record_of_its_time(replay, log):
    replay.do("seek", time=0.5)
    shown, record = replay.shown(), log.record(log.row_at(0.5))
    assert (shown["time"], shown["behavior"]) == (0.5, "FREEZE")
    assert shown["record"]["balance"]["com"] == pytest.approx(record.balance.com)
    assert shown["command"]["k_effort"] == [0] * log.robot.num_joints
    assert shown["command"]["kp_position"] == pytest.approx(record.gains.kp_position)


def test_time_plays_pauses_and_jumps_within_the_log(replay, log):
    page = replay.page
    page.advance(0.1)
    assert page.time == pytest.approx(0.1)
    replay.do("rate", rate=0.5)
    page.advance(0.1)
    assert page.time == pytest.approx(0.15)
    replay.do("pause", on=True)
    page.advance(0.1)
    assert page.time == pytest.approx(0.15)
    row = page.row
    replay.do("step")
    assert page.row == row + 1
    assert replay.do("seek", time=0.5) == 0.5
    assert replay.do("seek", time=100.0) == log.time[-1]
    assert replay.do("back") == log.time[0]
    replay.do("seek", time=100.0)
    replay.do("pause", on=False)
    assert page.time == log.time[0]  # From the end it plays again.
    page.advance(100.0)
    assert page.paused
    assert page.time == log.time[-1]
    with pytest.raises(InvalidMessageError):
        replay.do("seek", time="soon")


def test_a_log_is_described_with_its_phases_events_and_columns(replay, log):
    described = orjson.loads(replay.page.described().page)
    of_log = described["log"]
    assert (of_log["begin"], of_log["end"]) == (log.time[0], log.time[-1])
    assert [name for _, name in of_log["phases"]] == ["STAND", "FREEZE"]
    assert [text for _, _, text in of_log["events"]] == ["STAND -> FREEZE"]
    assert of_log["share"][0] == [pytest.approx(log.time[0], abs=1e-3), 0.0]
    assert described["columns"]["joints.effort.l_leg_kny"] == {"unit": "N·m"}
    assert "forces" not in described["overlays"]  # No log has them.
    assert replay.page.described().robot is None


def test_whole_columns_are_given_of_both_logs(log, meshcat):
    replay = Asked(LogPage(log, [], meshcat, Overlays(), beside=log))
    curves = replay.do("columns", names=COLUMNS)
    for name in COLUMNS:
        assert curves[name]["time"] == log.time.tolist()
        assert curves[name]["value"] == pytest.approx(log[name])
        assert curves[name]["beside"]["value"] == curves[name]["value"]
    assert len(log) < MOST_POINTS
    gap = replay.do("columns", names=["balance.dcm_reference.x"])
    values = gap["balance.dcm_reference.x"]["value"]
    missing = np.isnan(log["balance.dcm_reference.x"])
    assert [value is None for value in values] == missing.tolist()
    for names in (["no such"], "balance.com.x", 7, COLUMNS * 100):
        with pytest.raises(InvalidMessageError):
            replay.do("columns", names=names)


def test_a_log_is_not_commanded(replay):
    assert not replay.page.requests.keys() & {"message", "push", "start", "done"}
    replay.do("show", overlay="dcm", on=True)
    assert replay.shown()["overlays"] == ["com", "dcm"]
