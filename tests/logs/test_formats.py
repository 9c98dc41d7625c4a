"""Every format restores the written data; other files are refused."""

import contextlib
import json
import secrets
import shutil
import sys

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, LogError, read_log
from atlas_drake.logs.formats import LogFile
from atlas_drake.scenario.noise import NOISE_MODELS

from .conftest import assert_same_arrays


def table_of(log):
    parts = [log.arrays[c.name] for c in log.header.layout.channels]
    return np.hstack([part.reshape(len(log), -1).astype(float) for part in parts])


def write(log, path, rows=None):
    """The log in another file."""
    file = LogFile(path, log.header)
    file.rows(table_of(log)[:rows])
    for note in log.notes:
        file.note(note)
    file.close()
    return path


def test_every_format_gives_back_the_same_log(log, suffix, tmp_path):
    table = table_of(log)
    table[:5, log.header.layout.places["balance.cop"]] = np.nan
    file = LogFile(tmp_path / f"again{suffix}", log.header)
    file.note(log.notes[0])  # Before the first row.
    for part in np.split(table, [1, 3, 4, 20]):
        file.rows(part)
    for note in log.notes[1:]:
        file.note(note)
    file.close()
    again = read_log(file.path)
    assert_same_arrays(again.arrays, log.header.layout.split(table))
    assert again.header.to_json() == log.header.to_json()
    assert again.events == log.events
    assert [c.message for c in again.commands] == [c.message for c in log.commands]
    times = [command.time for command in log.commands]
    assert [command.time for command in again.commands] == pytest.approx(times)


def test_the_log_knows_its_scenario_and_robot(log):
    assert log.scenario.name == "recorded"
    assert log.scenario.noise == NOISE_MODELS["reference"]
    assert log.robot.name == "atlas"
    with pytest.raises(KeyError, match=r"joints\.position"):
        log["joints.positon"]


# ---- MCAP --------------------------------------------------------------------


@pytest.fixture
def small_chunks(monkeypatch):
    mcap_file = pytest.importorskip("atlas_drake.logs.mcap_file")
    monkeypatch.setattr(mcap_file, "CHUNK", 50_000)


def assert_beginning_of(log, path):
    """The file holds the first rows of the log; returns their number."""
    again = read_log(path)
    rows = len(again)
    assert 0 < rows <= len(log)
    first = {name: values[:rows] for name, values in log.arrays.items()}
    assert_same_arrays(again.arrays, first)
    return rows


@pytest.mark.usefixtures("small_chunks")
@pytest.mark.parametrize("share", [0.3, 0.95])
def test_a_torn_mcap_is_read_as_far_as_it_goes(log, share, tmp_path):
    whole = write(log, tmp_path / "whole.mcap").read_bytes()
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(whole[: int(share * len(whole))])
    assert_beginning_of(log, torn)


@pytest.mark.usefixtures("small_chunks")
def test_an_mcap_can_be_read_while_it_is_written(log, tmp_path):
    file = LogFile(tmp_path / "run.mcap", log.header)
    file.rows(table_of(log))
    shutil.copy(file.path, tmp_path / "killed.mcap")
    file.close()
    assert assert_beginning_of(log, tmp_path / "killed.mcap") > 15


def test_mcap_viewers_find_topics_schemas_and_an_index(log, tmp_path):
    pytest.importorskip("mcap")
    from mcap.reader import make_reader

    path = write(log, tmp_path / "run.mcap")
    with path.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        schemas = {
            channel.topic: summary.schemas[channel.schema_id]
            for channel in summary.channels.values()
        }
        latest = {
            channel.topic: (message.log_time, json.loads(message.data))
            for _, channel, message in reader.iter_messages()
        }
    assert {channel.message_encoding for channel in summary.channels.values()} == {
        "json"
    }
    assert {schema.encoding for schema in schemas.values()} == {"jsonschema"}
    assert schemas["/tf"].name == "foxglove.FrameTransforms"
    assert schemas["/joint_states"].name == "foxglove.JointStates"
    assert schemas["/events"].name == "foxglove.Log"
    stamp, joints = latest["/joints"]
    assert stamp == round(1e9 * log.time[-1])
    knee = log.robot.joint_index("l_leg_kny")
    assert joints["position"]["l_leg_kny"] == log["joints.position"][-1, knee]
    described = json.loads(schemas["/joints"].data)
    assert described["properties"]["position"]["properties"]["l_leg_kny"] == {
        "type": "number"
    }
    (pelvis, *_soles) = latest["/tf"][1]["transforms"]
    assert pelvis["child_frame_id"] == "pelvis"
    x, y, z = (pelvis["translation"][axis] for axis in "xyz")
    places = log["pelvis.position"]
    assert np.abs(places - [x, y, z]).max(axis=1).min() == 0.0
    assert set(latest) >= {"/behavior", "/walk", "/balance", "/atlas_command"}
    # What changes seldom is written seldom.
    counts = {
        summary.channels[key].topic: count
        for key, count in summary.statistics.channel_message_counts.items()
    }
    assert counts["/joints"] == len(log)
    assert counts["/gains"] == 2
    assert counts["/step"] == 1
    assert 1 < counts["/walk"] < len(log)


# ---- errors ------------------------------------------------------------------


def test_an_unknown_ending_names_the_known_ones(log, tmp_path):
    for act in (read_log, lambda path: LogFile(path, log.header)):
        with pytest.raises(LogError, match=r"\.mcap, \.npz, \.parquet"):
            act(tmp_path / "run.csv")
    with pytest.raises(LogError, match="Did you mean"):
        read_log(tmp_path / "run.npy")


@pytest.mark.parametrize("content", [b"", b"no log at all", b"PK\x03\x04" + 50 * b"x"])
def test_a_file_that_is_no_log_is_refused(content, suffix, tmp_path):
    path = tmp_path / f"fake{suffix}"
    path.write_bytes(content)
    with pytest.raises(LogError, match=f"fake{suffix}: it is no"):
        read_log(path)


@pytest.mark.parametrize(
    ("name", "package"), [("mcap", "mcap"), ("parquet", "pyarrow")]
)
def test_a_missing_package_is_named_with_what_to_install(
    name, package, tmp_path, monkeypatch
):
    for module in list(sys.modules):
        if module.split(".")[0] == package or module.endswith(f"{name}_file"):
            monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(LogError, match=rf"'{package}'.*pip install {package},.*\[log"):
        AtlasSimulation(log=tmp_path / f"run.{name}")


def test_a_file_that_cannot_be_written_is_named(log, suffix, tmp_path):
    with pytest.raises(LogError, match=f"run{suffix}: cannot be written: No such"):
        AtlasSimulation(log=tmp_path / "missing" / f"run{suffix}")
    (tmp_path / f"run{suffix}").mkdir()
    with pytest.raises(LogError, match=f"run{suffix}: cannot be written: Is a dir"):
        LogFile(tmp_path / f"run{suffix}", log.header)


def test_files_of_others_are_refused(tmp_path):
    path = tmp_path / "other.npz"
    for header, complaint in (
        ("", r"not a \.npz log file"),
        (json.dumps({"format": "something else", "version": 1}), "something else"),
        (json.dumps({"format": "atlas_drake log", "version": 99}), "newer"),
    ):
        np.savez(path, **({"header": header} if header else {"x": np.zeros(3)}))
        with pytest.raises(LogError, match=complaint):
            read_log(path)


@pytest.mark.parametrize("damage", ["bit", "block"])
def test_a_damaged_log_is_refused_or_read_as_far_as_it_goes(
    damage, log, suffix, tmp_path
):
    draw = np.random.default_rng(0)
    path = write(log, tmp_path / f"run{suffix}", rows=5)
    whole, data = read_log(path), path.read_bytes()
    for _ in range(4):
        damaged = bytearray(data)
        begin = int(draw.integers(len(data)))
        if damage == "bit":
            damaged[begin] ^= 1 << int(draw.integers(8))
        else:
            length = int(draw.integers(1, 100))
            damaged[begin : begin + length] = draw.bytes(length)
        path.write_bytes(damaged)
        with contextlib.suppress(LogError):
            assert_part_of(whole, read_log(path))


def assert_part_of(whole, found):
    """All that was found is as it was written."""
    assert len(found) > 0
    for name, values in found.arrays.items():
        np.testing.assert_array_equal(values, whole[name][: len(found)], err_msg=name)
    assert found.header.to_json() == whole.header.to_json()
    assert all(note in whole.notes for note in found.notes)


def test_a_parquet_whose_notes_changed_is_refused(log, tmp_path):
    path = write(log, tmp_path / "run.parquet", rows=3)
    data = path.read_bytes()
    for text in (b"duration: ", b'"walk_params'):
        assert data.count(text) >= 1
        path.write_bytes(data.replace(text, text.swapcase(), 1))
        with pytest.raises(LogError, match="do not match their checksum"):
            read_log(path)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"time": np.linspace(1.0, 0.0, 30)}, "time is not finite or decreases"),
        ({"time": np.zeros((30, 2))}, "time is float64 of shape"),
        ({"joints.effort": np.zeros((30, 3))}, r"joints\.effort"),
        ({"state.q": np.zeros((30, 35))}, r"state\.q is not a pose"),
        ({"state.q": np.full((30, 35), np.nan)}, r"state\.q is not a pose"),
        ({"behavior.current": np.full(30, 99)}, "99"),
        ({"notes": '[[0.0, "event", {}]]'}, "damaged"),
        ({"notes": "[[0.0]]"}, "damaged"),
        ({"header": "model ../../../tmp/spot"}, "there is no robot"),
        ({"header": "model /tmp/spot"}, "there is no robot"),
        ({"header": "control_period nan"}, "control_period is nan"),
    ],
)
def test_a_log_that_contradicts_itself_is_refused(change, complaint, log, tmp_path):
    path = write(log, tmp_path / "run.npz", rows=30)
    with np.load(path) as file:
        arrays = dict(file)
    if "header" in change:
        name, value = change["header"].split()
        header = json.loads(str(arrays["header"]))
        header[name] = value
        change = {"header": json.dumps(header)}
    np.savez(path, **(arrays | change))
    with pytest.raises(LogError, match=complaint):
        _ = read_log(path).robot


def test_a_missing_log_is_named(suffix, tmp_path):
    with pytest.raises(LogError, match="there is no such file"):
        read_log(tmp_path / f"none{suffix}")


def test_a_log_without_rows_is_refused(log, tmp_path):
    pytest.importorskip("mcap")
    file = LogFile(tmp_path / "empty.mcap", log.header)
    file._writer._begin()  # As torn before its first tick.
    file._writer.close()
    with pytest.raises(LogError, match="no rows"):
        read_log(file.path)


def test_a_log_without_rows_does_not_replace_an_older_file(log, suffix, tmp_path):
    file = LogFile(write(log, tmp_path / f"run{suffix}"), log.header)
    file.note(log.notes[0])
    file.close()
    assert len(read_log(tmp_path / f"run{suffix}")) == len(log)
    LogFile(tmp_path / f"new{suffix}", log.header).close()
    assert [*tmp_path.iterdir()] == [tmp_path / f"run{suffix}"]


def test_a_simulation_that_cannot_be_built_leaves_the_log_of_another(log, tmp_path):
    pytest.importorskip("mcap")
    path = write(log, tmp_path / "run.mcap")
    with pytest.raises(ZeroDivisionError):
        AtlasSimulation(extend=lambda _builder, _station: 1 / 0, log=path)
    assert len(read_log(path)) == len(log)
    assert [*tmp_path.iterdir()] == [path]


def write_rows(file, rows):
    for row in rows:
        file.rows(row[None])


@pytest.mark.usefixtures("small_chunks")
@pytest.mark.parametrize("size", [100, 60_000])
def test_an_mcap_on_a_full_disk_is_readable_up_to_its_last_chunk(
    size, log, tmp_path, largest_file
):
    """It is cut back, which leaves room for what is written after it."""
    file = LogFile(tmp_path / "run.mcap", log.header)
    with (
        largest_file(size),
        pytest.raises(LogError, match="cannot be written: File too large"),
    ):
        write_rows(file, table_of(log))
    if size > 100:
        assert file.path.stat().st_size < size
        assert assert_beginning_of(log, file.path) < len(log)


def test_two_runs_may_not_write_one_mcap_and_replace_whole_other_files(
    log, suffix, tmp_path
):
    path = tmp_path / f"run{suffix}"
    first = LogFile(path, log.header)
    if suffix == ".mcap":
        with pytest.raises(LogError, match="another run is writing it"):
            LogFile(path, log.header)
    else:
        second = LogFile(path, log.header)
        second.rows(table_of(log)[:1])
        second.close()
        assert len(read_log(path)) == 1
    first.rows(table_of(log))
    first.close()
    assert len(read_log(path)) == len(log)
    assert [*tmp_path.iterdir()] == [path]


def test_a_link_with_the_name_of_the_unfinished_file_is_not_followed(
    log, tmp_path, monkeypatch
):
    precious = tmp_path / "precious"
    precious.write_text("precious")
    monkeypatch.setattr(secrets, "token_hex", lambda _length: "0")
    (tmp_path / ".0.unfinished.npz").symlink_to(precious)
    with pytest.raises(LogError, match="File exists"):
        LogFile(tmp_path / "run.npz", log.header)
    assert precious.read_text() == "precious"


def test_a_file_that_cannot_be_completed_leaves_nothing(log, tmp_path, monkeypatch):
    file = LogFile(tmp_path / "run.npz", log.header)
    file.rows(table_of(log)[:1])

    def fail(*_arguments, **_options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(file._writer, "_write", fail)
    with pytest.raises(LogError, match="No space left"):
        file.close()
    assert [*tmp_path.iterdir()] == []
