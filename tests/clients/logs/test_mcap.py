"""What was written is read, as far as a file goes; all other files are refused."""

import json
import re
from contextlib import suppress
from functools import partial

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

from atlas_drake import AtlasSimulation, LogError, read_log
from atlas_drake.clients.film.replay import make_replay
from atlas_drake.clients.logs import mcap_writer
from atlas_drake.clients.logs.figures import draw_page
from atlas_drake.clients.logs.log import Part
from atlas_drake.clients.logs.mcap_writer import HEADER, METADATA, McapWriter
from atlas_drake.frozen import replace
from atlas_drake.messages.event import RunEvent
from atlas_drake.records.column import Names
from atlas_drake.systems.sensor_noise import NOISE_MODELS

from .conftest import PERIOD, TICKS, assert_beginning_of, with_header

CHUNK = 30_000
"""Size of a chunk [byte], so that a short file has several."""
SEVERAL = settings(max_examples=25, deadline=None)


def test_the_log_knows_its_scenario_and_robot(log):
    assert log.scenario.name == "recorded"
    assert log.scenario.noise == NOISE_MODELS["reference"]
    assert log.robot.name == "atlas"


def test_records_are_what_the_run_had(recorded):
    sim, log, records = recorded
    # The listener hears of the last one a tick later.
    last = replace(sim.record, paths=log.record(-1 + TICKS).paths)
    assert [*log.records()] == [*records, last]
    assert len(log) == TICKS
    assert sum(record.paths is not None for record in records) > 2


# ---- files that are cut off or damaged ---------------------------------------


@pytest.fixture
def small_chunks(monkeypatch):
    monkeypatch.setattr(mcap_writer, "Writer", partial(Writer, chunk_size=CHUNK))


@pytest.mark.slow
def test_a_log_is_read_as_far_as_it_was_written(small_chunks, log, writer):
    for record in log.records():
        writer.record(record)
    assert assert_beginning_of(log, read_log(writer.path)) > 0.5 * TICKS
    writer.close()
    assert assert_beginning_of(log, read_log(writer.path)) == TICKS
    writer.record(log.record(0))  # Too late: it is not in the file.
    assert len(read_log(writer.path)) == TICKS
    whole, records = writer.path.read_bytes(), [*log.records()]

    @SEVERAL
    @given(st.floats(0.0, 1.0))
    def cut_off(share):
        writer.path.write_bytes(whole[: int(share * len(whole))])
        try:
            found = read_log(writer.path)
        except LogError:
            assert share < 0.2, "the first chunk was there"
            return
        # What is lost is at most a chunk; the index at the end is not needed.
        assert assert_beginning_of(log, found) / TICKS > share - 0.25
        assert [*found.records()] == records[: len(found)]

    @SEVERAL
    @given(st.floats(0.0, 1.0), st.binary(min_size=1, max_size=60))
    def damaged(place, noise):
        begin = int(place * len(whole))
        writer.path.write_bytes(whole[:begin] + noise + whole[begin + len(noise) :])
        with suppress(LogError):
            assert_beginning_of(log, read_log(writer.path))

    cut_off()
    damaged()


# ---- other programs ----------------------------------------------------------


def test_other_programs_find_topics_schemas_and_an_index(log):
    with log.path.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        messages = [*reader.iter_messages()]
    channels = summary.channels.values()
    schemas = {one.topic: summary.schemas[one.schema_id] for one in channels}
    assert {one.message_encoding for one in channels} == {"json"}
    assert {schema.encoding for schema in schemas.values()} == {"jsonschema"}
    assert schemas["/tf"].name == "foxglove.FrameTransforms"
    assert schemas["/joint_states"].name == "foxglove.JointStates"
    assert schemas["/events"].name == "foxglove.Log"
    plain = {topic: json.loads(schema.data) for topic, schema in schemas.items()}
    dcm = plain["/balance"]["properties"]["dcm"]
    assert dcm["properties"].keys() == {"x", "y"}
    assert dcm["description"].endswith("[m]")
    checks = {
        topic: jsonschema.Draft202012Validator(one) for topic, one in plain.items()
    }
    latest = {}
    for _, channel, message in messages:
        content = json.loads(message.data)
        checks[channel.topic].validate(without_null(content))
        latest[channel.topic] = message.log_time, content
    stamp, joints = latest["/joints"]
    assert stamp == round(1e9 * log.time[-1])
    assert joints["position"]["l_leg_kny"] == log["joints.position.l_leg_kny"][-1]
    states = {one["name"]: one for one in latest["/joint_states"][1]["joints"]}
    assert states["l_leg_kny"]["effort"] in log["joints.effort.l_leg_kny"]
    pelvis, left, right = latest["/tf"][1]["transforms"]
    for frame, name, column in (
        (pelvis, "pelvis", "pelvis.position"),
        (left, "left_sole", "feet.left_position"),
        (right, "right_sole", "feet.right_position"),
    ):
        assert frame["child_frame_id"] == name
        position = [frame["translation"][axis] for axis in "xyz"]
        assert position in log[column].tolist()
    # What changes seldom is written seldom.
    counts = {
        summary.channels[key].topic: count
        for key, count in summary.statistics.channel_message_counts.items()
    }
    assert counts["/joints"] == counts["/time"] == len(log)
    assert counts["/gains"] == 2
    assert counts["/atlas_command"] == counts["/atlas_sim_interface_command"] == 1
    assert 1 < counts["/walk"] < len(log)


def without_null(plain):
    """The values that are there; null stands for a number that is missing."""
    if isinstance(plain, dict):
        kept = {name: without_null(value) for name, value in plain.items()}
        return {name: value for name, value in kept.items() if value is not None}
    return [*map(without_null, plain)] if isinstance(plain, list) else plain


# ---- files that are refused --------------------------------------------------


@pytest.mark.parametrize("content", [b"", b"no log at all", b"\x89MCAP0\r\n" * 2, None])
def test_a_file_that_is_no_log_is_refused(content, tmp_path):
    path = tmp_path / "fake.mcap"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(LogError, match=r"fake\.mcap: "):
        read_log(path)


def test_a_file_with_another_ending_is_named(log, tmp_path):
    for act in (read_log, McapWriter):
        for name in ("run.npz", "run.macp"):
            with pytest.raises(LogError, match=rf"{name}: .*\.mcap"):
                act(tmp_path / name)


NAMES = {one.value: [] for one in Names}


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({}, "no records"),
        ({"version": 99}, "version 99"),
        ({"version": None}, "version None"),
        (
            {"schema": {"names": {}, "groups": []}},
            r"schema\.names: is \[\]; must be jo",
        ),
        ({"schema": {"names": NAMES, "groups": ["mood"]}}, r"groups\[0\]: is 'mood'"),
        ({"schema": {"names": NAMES, "groups": 7}}, r"schema\.groups: is 7; must be a"),
        ({"schema": None}, "schema: is None; must be"),
        (None, "not of this program"),
    ],
)
def test_a_header_that_does_not_fit_is_refused(changes, complaint, log, tmp_path):
    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        if changes is not None:
            header = json.loads(log.header.to_json(log.schema)) | changes
            writer.add_metadata(METADATA, {HEADER: json.dumps(header)})
        writer.finish()
    with pytest.raises(LogError, match=rf"other\.mcap: .*{complaint}"):
        read_log(path)


@pytest.mark.parametrize(
    ("topic", "message", "complaint"),
    [
        ("time", {"time": None}, "/time: a record has no time"),
        ("time", {"time": "soon"}, "could not convert string to float: 'soon'"),
        ("time", [], "no log that can be read"),
        (
            "gains",
            {"kp_position": {"a": 1}},
            "/gains: kp_position has not the elements of its schema",
        ),
        ("gains", {}, "no log that can be read"),
    ],
)
def test_damaged_records_are_refused(topic, message, complaint, log, tmp_path):
    path = tmp_path / "other.mcap"
    messages = {"gains": {}, "time": {"time": 0.0}, topic: message}
    header = json.loads(log.header.to_json(log.schema))
    header["schema"]["groups"] = ["gains"]
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_metadata(METADATA, {HEADER: json.dumps(header)})
        for name, content in messages.items():
            channel = writer.register_channel(f"/{name}", "json", 0)
            writer.add_message(channel, 0, json.dumps(content).encode(), 0, 0)
        writer.finish()
    with pytest.raises(LogError, match=rf"other\.mcap: .*{complaint}"):
        read_log(path)


@pytest.mark.parametrize("message", [None, [], {}, {"paths": "x"}, {"paths": {"a": 1}}])
def test_a_damaged_part_of_a_record_is_named(message, log):
    parts = {**log.parts, "paths": Part([0], [message])}
    with pytest.raises(LogError, match=r"run\.mcap: a message on /paths is damaged"):
        [*replace(log, parts=parts).records()]


BOW = {"name": "BOW", "number": 100, "color": "#7cb342", "description": ""}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "value", "complaint"),
    [
        ("model", 7, "model: is 7; must be a valid string"),
        ("model", None, "model: is None"),
        ("scenario", ["world"], r"scenario: is \['world'\]; must be"),
        ("scenario", "b: {", "scenario: file: cannot be read: line 1"),
        ("scenario", "- world", "scenario: file: must have fields"),
        ("control_period", "often", "control_period: is 'often'; must be a"),
        ("control_period", float("nan"), "control_period: is nan"),
        ("behaviors", "BOW", "behaviors: is 'BOW'; must be"),
        ("behaviors", [BOW | {"number": "x"}], r"behaviors\[0\]\.number: is 'x'"),
        ("behaviors", [BOW, BOW], "behaviors: .* registered already"),
    ],
)
def test_a_damaged_header_stops_only_who_needs_it(
    field, value, complaint, log, tmp_path
):
    damaged = with_header(log, **{field: value})
    (fault,) = damaged.header.faults()
    assert fault.startswith(f"{log.path}: its header is damaged: ")
    assert re.search(complaint, fault)
    with pytest.raises(LogError, match=complaint):
        draw_page(damaged)
    damaged.to_npz(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz") as columns:
        np.testing.assert_array_equal(columns["balance.com"], log["balance.com"])
    with suppress(LogError):
        make_replay(damaged)


@pytest.mark.parametrize(
    "model", ["/tmp/spot", "a\0.yaml", 5000 * "a" + ".yaml", "~no-one/a.yaml"]
)
def test_a_log_of_an_unknown_robot_is_refused(model, log):
    with pytest.raises(LogError, match=r"cannot be loaded: .*there is no"):
        _ = with_header(log, model=model).robot


# ---- files that cannot be written --------------------------------------------


def test_a_file_that_cannot_be_written_is_named_before_the_run(tmp_path):
    (tmp_path / "folder.mcap").mkdir()
    for path in (tmp_path / "missing" / "run.mcap", tmp_path / "folder.mcap"):
        with pytest.raises(LogError, match=f"{path.parent}"):
            AtlasSimulation(log=path)
    assert [*tmp_path.iterdir()] == [tmp_path / "folder.mcap"]


def test_what_never_ran_leaves_an_earlier_file(log, tmp_path):
    path = tmp_path / "run.mcap"
    path.write_text("before")
    for name in ("run.mcap", "new.mcap"):
        writer = McapWriter(tmp_path / name)
        writer.event(RunEvent(0.0, "start", "nothing comes of it"))
        writer.close()
        with pytest.raises(ZeroDivisionError):
            AtlasSimulation(extend=lambda *_parts: 1 / 0, log=tmp_path / name)
    assert path.read_text() == "before"
    assert [*tmp_path.iterdir()] == [path]


@pytest.mark.usefixtures("small_chunks")
def test_a_run_goes_on_without_a_log_on_a_full_disk(tmp_path, largest_file):
    path = tmp_path / "run.mcap"
    with largest_file(2 * CHUNK):
        sim = AtlasSimulation(log=path)
        sim.advance_to(TICKS * PERIOD)
    assert sim.time == pytest.approx(TICKS * PERIOD)
    (warning,) = [event for event in sim.events if event.kind == "warning"]
    assert f"{path}: cannot be written: File too large" in warning.text
    with pytest.raises(LogError, match="File too large"):
        sim.close()
    # What was written can be read.
    assert 0 < len(read_log(path)) < TICKS
