"""A log in the cockpit: its states, jumps in time, plots, and what is refused."""

import base64

import msgpack
import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import AtlasSimulation, Behavior, InvalidMessageError, read_log
from atlas_drake.cockpit.log_playback import PAST_POINTS, LogPlayback
from atlas_drake.cockpit.log_state import REFUSAL, card_of_log, state_of_log
from atlas_drake.cockpit.observe import Observer
from atlas_drake.cockpit.operator import Operator
from atlas_drake.cockpit.orders import Order
from atlas_drake.cockpit.page.chart import charts
from atlas_drake.cockpit.page.history import History
from atlas_drake.cockpit.page.panels.scrubber import band
from atlas_drake.cockpit.recording_controls import ANIMATION, MESSAGE
from atlas_drake.cockpit.state import BESIDE
from atlas_drake.visualization import FRAME_RATE
from atlas_drake.visualization.overlays import Overlays

END = 0.8
"""End of the run [s]."""
COLUMNS = ["balance.com.x", "joints.effort.l_leg_kny", "feet.left_force.z"]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The state of a run at its end, what was plotted, and the log of the run."""
    path = tmp_path_factory.mktemp("playback") / "run.mcap"
    with AtlasSimulation(log=path) as sim:
        operator = Operator(sim)
        operator.do(Order("plots.choose", {"names": COLUMNS}))
        while sim.time < END - 1e-6:
            sim.advance(0.018)  # Two control ticks.
            operator.update(sim.time)
            if sim.current_behavior == Behavior.STAND and sim.time > 0.1:
                operator.modes.request("STEP")
        state = Observer(sim, operator).read(0)
    return state, state.samples, read_log(path)


@pytest.fixture
def log(run):
    return run[2]


@pytest.fixture
def playback(log):
    return LogPlayback(log, [], Meshcat(), Overlays(["com"]))


def do(playback, control, **values):
    return playback.do(Order(control, values))


def test_a_row_shows_what_the_run_showed(run):
    state, _, log = run
    row = int(np.searchsorted(log.time, state.time - 1e-6)) - 1
    seen = state_of_log(log, row)
    assert seen.time == pytest.approx(state.time, abs=0.02)
    for name in ("behavior", "desired", "fallen", "k_effort", "gains", "steps"):
        assert getattr(seen, name) == getattr(state, name), name
    for name in ("position", "set_point", "robot", "com", "dcm", "feet"):
        near = np.allclose(getattr(seen, name), getattr(state, name), atol=0.02)
        assert near, name
    assert set(seen.refusals.values()) == {REFUSAL}


def test_chosen_columns_are_sampled_as_the_log_has_them(run):
    _, samples, log = run
    assert len(samples) > 0.5 * END / 0.02
    names = {name for _, numbers in samples for name in numbers}
    assert names == set(COLUMNS)
    times = np.array([time for time, _ in samples])
    for name in COLUMNS:
        column = np.interp(times, log.time, log[name])
        sampled = np.array([numbers[name] for _, numbers in samples])
        spread = max(np.ptp(column), 1e-3)
        assert np.median(np.abs(sampled - column)) < 0.05 * spread, name


def test_nothing_is_sampled_without_a_plot(driven):
    driven.go(0.1)
    assert driven.operator.plots.take() == ()
    driven.do("plots.choose", names=COLUMNS)
    driven.go(0.1)
    assert len(driven.operator.plots.take()) >= 4
    driven.do("plots.choose", names=[])
    driven.go(0.1)
    assert driven.operator.plots.take() == ()
    for names in (["no such"], "balance.com.x", 7, COLUMNS * 100):
        with pytest.raises(InvalidMessageError):
            driven.do("plots.choose", names=names)


def test_time_plays_pauses_and_jumps_within_the_log(playback, log):
    playback.advance(0.1)
    assert playback.time == pytest.approx(0.1)
    do(playback, "clock.pace", rate=0.5)
    playback.advance(0.1)
    assert playback.time == pytest.approx(0.15)
    do(playback, "clock.pause")
    playback.advance(0.1)
    assert playback.time == pytest.approx(0.15)
    row = playback.row
    do(playback, "clock.single_step")
    assert playback.row == row + 1
    assert do(playback, "replay.seek", time=0.5) == 0.5
    assert playback.read(0).time == 0.5
    assert do(playback, "replay.seek", time=100.0) == log.time[-1]
    assert do(playback, "clock.back") == log.time[0]
    do(playback, "replay.seek", time=100.0)
    do(playback, "clock.go_on")
    assert playback.time == log.time[0]  # From the end it plays again.
    playback.advance(100.0)
    assert playback.paused
    assert playback.time == log.time[-1]
    with pytest.raises(InvalidMessageError):
        do(playback, "replay.seek", time="soon")


def test_after_a_jump_plots_modes_and_events_are_of_the_time_before(playback, log):
    do(playback, "plots.choose", names=COLUMNS)
    do(playback, "replay.seek", time=0.7)
    history = History()
    state = playback.read(0)
    history.add(state)
    assert history.samples[0][0] == 0.0
    assert history.samples[-1][0] == pytest.approx(0.7, abs=0.01)
    assert len(history.samples) == len(history.moments) - 1  # And the present.
    assert [one.time for one in log.events if one.time <= 0.7] == [
        time for time, _, _ in history.events
    ]
    playback.advance(0.05)
    history.add(playback.read(state.event_count))
    times = [time for time, _ in history.samples]
    assert times == sorted(set(times))
    assert times[-1] == pytest.approx(0.75, abs=0.01)
    do(playback, "replay.seek", time=0.2)
    history.add(playback.read(state.event_count))
    assert max(time for time, _ in history.samples) <= 0.2 + 1e-9
    assert history.moments[-1].time == 0.2
    assert len(history.samples) <= PAST_POINTS


def test_a_log_is_not_commanded(playback):
    for control in ("modes.request", "walk.steer", "joints.share", "pushes.push"):
        with pytest.raises(InvalidMessageError, match="A log is shown"):
            do(playback, control)
    for control in ("clock.advance", "clock.do", "replay.read", "view._overlays", ""):
        with pytest.raises(InvalidMessageError, match="no control"):
            do(playback, control)
    do(playback, "view.show", overlay="dcm", on=True)
    assert playback.read(0).overlays == {"com", "dcm"}


def test_two_logs_are_plotted_side_by_side(log):
    playback = LogPlayback(log, [], Meshcat(), Overlays(), beside=log)
    do(playback, "plots.choose", names=COLUMNS[:1])
    do(playback, "replay.seek", time=0.5)
    samples = playback.read(0).samples
    names = {name for _, numbers in samples for name in numbers}
    assert names == {COLUMNS[0], COLUMNS[0] + BESIDE}
    svg = charts(samples, COLUMNS[:1], {COLUMNS[0]: "m"}, 0.0, 0.5)
    assert svg.count("<polyline") == 2
    assert svg.count("stroke-dasharray") == 1


def test_charts_have_an_axis_for_each_unit_and_gaps_without_values():
    nan = float("nan")
    samples = [
        (0.1 * i, {"a": float(i), "b": nan if i == 5 else 2.0}) for i in range(9)
    ]
    svg = charts(samples, ["a", "b"], {"a": "m", "b": "N·m"}, 0.0, 1.0)
    assert svg.count("<svg") == 2
    assert ">m<" in svg
    assert ">N·m<" in svg
    assert svg.count("<polyline") == 3
    assert "nan" not in svg
    assert charts([], ["a"], {}, 0.0, 1.0).count("<polyline") == 0


def test_the_card_of_a_log_names_its_phases_and_columns(log):
    card = card_of_log(log, 7000)
    assert (card.log.begin, card.log.end) == (log.time[0], log.time[-1])
    assert [name for _, name in card.log.phases] == ["STAND", "STEP"]
    assert card.columns["balance.com.x"] == "m"
    assert card.columns["joints.effort.l_leg_kny"] == "N·m"
    drawn = band(card.log, card.behaviors)
    assert drawn.count("<i ") == len(card.log.phases)
    assert "forces" not in card.overlays  # No log has them.


def test_a_recording_becomes_a_page(driven):
    with pytest.raises(InvalidMessageError, match="no 3D view"):
        driven.do("recording.start")
    with pytest.raises(InvalidMessageError, match="nothing is recorded"):
        driven.do("recording.stop")
    sim = AtlasSimulation(view=Meshcat())
    operator = Operator(sim)
    sim.advance(0.3)
    operator.do(Order("recording.start"))
    assert Observer(sim, operator).read(0).recording
    sim.advance(0.3)
    page = operator.do(Order("recording.stop"))
    assert not Observer(sim, operator).read(0).recording
    operator.recording.why_not = "the whole run is recorded already"
    with pytest.raises(InvalidMessageError, match="already"):
        operator.do(Order("recording.start"))
    (animation,) = [
        msgpack.unpackb(base64.b64decode(one[2]), strict_map_key=False)
        for one in MESSAGE.finditer(page)
        if one[2].startswith(ANIMATION)
    ]
    head = next(
        one for one in animation["animations"] if one["path"].endswith("atlas/head")
    )
    frames = [key["time"] for key in head["clip"]["tracks"][0]["keys"]]
    assert frames[:3] == [0, 1, 2]
    assert frames[-1] == pytest.approx(0.3 * FRAME_RATE, abs=1.5)
