"""Logs on the command line: --log, plot and replay."""

import base64
import math
import re
import signal
import sys

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import AtlasCommand, AtlasSimulation, Scenario, read_log
from atlas_drake.app import log as log_command
from atlas_drake.app import run as run_command
from atlas_drake.app.main import main
from atlas_drake.logs import png_page

pytestmark = pytest.mark.usefixtures("restored_loggers")


@pytest.fixture(scope="module")
def log_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "run.npz"
    with AtlasSimulation(log=path) as sim:
        sim.advance_to(0.1)
    return path


# ---- recording ---------------------------------------------------------------


def test_ctrl_c_keeps_what_was_logged(scenario, tmp_path, monkeypatch):
    pytest.importorskip("mcap")

    def interrupt(_self, _time, _behavior):
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(run_command.Progress, "update", interrupt)
    file = tmp_path / "run.mcap"
    run = ["run", scenario("duration: 60.0\n"), "--headless", "--log", str(file)]
    assert main(run) == 130
    rows = math.ceil(run_command.PIECE / Scenario().resolved().control_period)
    last = (rows - 1) * Scenario().resolved().control_period
    assert read_log(file).time[-1] == pytest.approx(last)


@pytest.mark.parametrize("error", [RuntimeError("diverged"), KeyboardInterrupt()])
def test_a_failure_keeps_what_was_logged(scenario, tmp_path, monkeypatch, error):
    advance = Simulator.AdvanceTo

    def fail(simulator, t):
        if simulator.get_context().get_time() > 0.05:
            raise error
        return advance(simulator, t)

    monkeypatch.setattr(Simulator, "AdvanceTo", fail)
    file = tmp_path / "run.npz"
    status = main(["run", scenario(), "--headless", "--log", str(file)])
    assert status == (1 if isinstance(error, RuntimeError) else 130)
    assert read_log(file).time[-1] == pytest.approx(
        0.06, abs=Scenario().resolved().control_period
    )


@pytest.mark.parametrize(
    ("name", "complaint"),
    [("run.csv", ".mcap, .npz, .parquet"), ("none/run.npz", "there is no folder")],
)
def test_a_log_that_cannot_be_written_is_noticed_before_the_run(
    name, complaint, scenario, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(run_command, "AtlasSimulation", None)  # must not be reached
    log = str(tmp_path / name)
    assert main(["run", scenario(), "--headless", "--log", log]) == 2
    assert complaint in capsys.readouterr().err


# ---- figures -----------------------------------------------------------------


@pytest.mark.slow
def test_both_figures_are_drawn_beside_the_log(log_file, capsys, monkeypatch):
    pytest.importorskip("plotly")
    monkeypatch.setattr(png_page, "DPI", 40)
    assert main(["plot", str(log_file)]) == 0
    png, html = (log_file.with_suffix(".figures" + end) for end in (".png", ".html"))
    assert png.read_bytes().startswith(b"\x89PNG")
    assert html.read_text().rstrip().endswith("</html>")
    out = capsys.readouterr().out
    for text in ("Reading", "Drawing", str(png), str(html)):
        assert text in out


@pytest.mark.slow
def test_figures_are_drawn_where_they_are_wanted(log_file, tmp_path, monkeypatch):
    monkeypatch.setattr(png_page, "DPI", 40)
    before = {*log_file.parent.iterdir()}
    assert main(["plot", str(log_file), "--output", str(tmp_path / "a.png")]) == 0
    assert [file.name for file in tmp_path.iterdir()] == ["a.png"]
    assert {*log_file.parent.iterdir()} == before


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["plot", "LOG", "--output", "TMP/figure.gif"], ".png, .html"),
        (["plot", "LOG", "--output", "TMP/none/figure.png"], "there is no folder"),
        (["plot", "TMP/none.npz"], "there is no such file"),
        (["plot", "TMP/fake.npz"], "not a .npz log file"),
        (["plot", "TMP/run.csv"], "must end in"),
        (["replay", "TMP/none.npz", "--headless", "--record", "TMP/a.html"], "no such"),
        (["replay", "LOG", "--headless"], "--record"),
        (["replay", "LOG", "--record", "TMP/none/a.html"], "there is no folder"),
        (["replay", "LOG", "--video", "TMP/none/a.mp4"], "there is no folder"),
        (["replay", "LOG", "--video", "TMP/a.avi"], ".mp4 or .gif"),
    ],
)
def test_what_cannot_be_done_exits_with_2(
    arguments, complaint, log_file, tmp_path, capsys
):
    (tmp_path / "fake.npz").write_text("no log")
    (tmp_path / "run.csv").write_text("time\n")
    line = [a.replace("TMP", str(tmp_path)) for a in arguments]
    line = [str(log_file) if a == "LOG" else a for a in line]
    assert main(line) == 2
    assert complaint in capsys.readouterr().err


def test_a_page_that_finds_no_room_takes_no_other_with_it(
    log_file, tmp_path, capsys, monkeypatch
):
    def draw(_page, path):
        if path.suffix == ".png":
            raise OSError(28, "No space left on device")
        path.write_text("whole")

    monkeypatch.setattr(log_command, "_drawing", lambda _file: draw)
    full, page = tmp_path / "full.png", tmp_path / "a.html"
    options = ["--output", str(full), "--output", str(page)]
    assert main(["plot", str(log_file), *options]) == 3
    assert f"{full} is lost: No space left on device" in capsys.readouterr().out
    assert [*tmp_path.iterdir()] == [page]


def test_a_page_that_cannot_be_drawn_leaves_nothing(log_file, tmp_path, monkeypatch):
    def fail(_page, path):
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setattr(log_command, "_drawing", lambda _file: fail)
    assert main(["plot", str(log_file), "--output", str(tmp_path / "a.png")]) == 130
    assert [*tmp_path.iterdir()] == []


@pytest.mark.slow
def test_without_plotly_one_is_told_what_to_install(
    log_file, tmp_path, capsys, monkeypatch
):
    import sys

    for name in list(sys.modules):
        if name.split(".")[0] == "plotly" or name == "atlas_drake.logs.html_page":
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "plotly", None)
    assert main(["plot", str(log_file), "--output", str(tmp_path / "a.html")]) == 2
    assert "pip install plotly" in capsys.readouterr().err
    # Without a wish there is the picture, and a hint.
    monkeypatch.setattr(png_page, "DPI", 40)
    log = tmp_path / "run.npz"
    log.write_bytes(log_file.read_bytes())
    assert main(["plot", str(log)]) == 0
    assert "Left out" in capsys.readouterr().out
    assert (tmp_path / "run.figures.png").exists()
    assert not (tmp_path / "run.figures.html").exists()


def test_where_nothing_can_be_drawn_one_is_told_what_to_install(
    log_file, tmp_path, capsys, monkeypatch
):
    for package in ("matplotlib", "plotly"):
        for name in list(sys.modules):
            if name.split(".")[0] == package:
                monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, package, None)
    for page in ("png_page", "html_page"):
        monkeypatch.delitem(sys.modules, f"atlas_drake.logs.{page}", raising=False)
    before = {*log_file.parent.iterdir()}
    assert main(["plot", str(log_file)]) == 2
    out, error = capsys.readouterr()
    assert out.count("Left out") == 2
    for package in ("matplotlib", "plotly"):
        assert f"pip install {package}" in out
    assert "pip install matplotlib" in error
    assert {*log_file.parent.iterdir()} == before


# ---- replay ------------------------------------------------------------------


def test_a_replay_is_recorded(log_file, tmp_path, capsys):
    page = tmp_path / "replay.html"
    options = ["--headless", "--record", str(page)]
    assert main(["replay", str(log_file), *options]) == 0
    assert "Replayed at 0.1 s" in capsys.readouterr().out
    assert page.read_text().rstrip().endswith("</html>")


def test_a_replay_with_view_ends_by_itself_when_nobody_sits_there(log_file, capsys):
    assert main(["replay", str(log_file), "--realtime-rate", "0"]) == 0
    assert "Watch at http://localhost" in capsys.readouterr().out


def test_ctrl_c_stops_a_replay_and_keeps_its_recording(
    log_file, tmp_path, capsys, monkeypatch
):
    def interrupt(_self, _time, _behavior):
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(log_command, "PIECE", 0.02)
    monkeypatch.setattr(log_command.Progress, "update", interrupt)
    page = tmp_path / "replay.html"
    options = ["--headless", "--record", str(page)]
    assert main(["replay", str(log_file), *options]) == 130
    assert "Stopped at 0.0 s" in capsys.readouterr().out
    assert page.exists()


@pytest.mark.slow
def test_a_replay_is_filmed_as_the_run_was(tmp_path, capsys, monkeypatch):
    pytest.importorskip("av", reason='needs pip install "atlas-drake[video]"')
    from atlas_drake.visualization.video_display import Video
    from atlas_drake.visualization.video_file import VideoFile

    pictures, add = [], VideoFile.add

    def notice(self, picture):
        pictures.append(picture)
        add(self, picture)

    # What is encoded is compared: the codec changes pictures a little.
    monkeypatch.setattr(VideoFile, "add", notice)
    log, live, again = (tmp_path / name for name in ("a.npz", "a.mp4", "b.mp4"))
    # A log has the state at control ticks, a film that at the last physics step: here
    # each picture finds both at one instant.
    scenario = Scenario(physics_step=0.002, control_period=0.004)
    with AtlasSimulation(scenario, log=log, video=Video(live, 192, 108)) as sim:
        command = AtlasCommand()
        command.k_effort = [255] + 27 * [0]
        sim.publish(command)
        sim.advance_to(0.1)
    options = ["--headless", "--video", str(again), "--video-size", "192x108"]
    assert main(["replay", str(log), *options]) == 0
    assert f"Wrote {again}, 3 pictures." in capsys.readouterr().out
    assert len(pictures) == 6
    # The first picture of a run comes before its first tick, in which the log begins.
    for filmed, replayed in zip(pictures[1:3], pictures[4:], strict=True):
        np.testing.assert_array_equal(filmed, replayed)
    assert not np.array_equal(pictures[4], pictures[5])


@pytest.mark.slow
def test_ctrl_c_stops_a_replay_and_its_film_can_be_played(
    log_file, tmp_path, capsys, monkeypatch
):
    av = pytest.importorskip("av", reason='needs pip install "atlas-drake[video]"')

    def interrupt(_self, _time, _behavior):
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(log_command, "PIECE", 0.05)
    monkeypatch.setattr(log_command.Progress, "update", interrupt)
    film = tmp_path / "replay.mp4"
    options = ["--headless", "--video", str(film), "--video-size", "64x64"]
    assert main(["replay", str(log_file), *options]) == 130
    assert "Stopped at 0.1 s" in capsys.readouterr().out
    with av.open(str(film)) as video:
        assert len(list(video.decode(video=0))) == 2


def test_a_replay_is_recorded_with_what_is_to_be_shown(log_file, tmp_path):
    page = tmp_path / "replay.html"
    options = ["--headless", "--record", str(page), "--show", "com,cop"]
    assert main(["replay", str(log_file), *options]) == 0
    blobs = re.findall(r"base64,([A-Za-z0-9+/=]+)", page.read_text())
    messages = [base64.b64decode(blob) for blob in blobs]
    (animation,) = [message for message in messages if b"set_animation" in message]
    assert b"/visualizer/atlas/pelvis" in animation
    assert b"/overlays/com_ball" in animation
    assert b"/overlays/cop" in animation
    assert b"/overlays/dcm" not in animation


def test_what_is_not_in_a_log_cannot_be_shown(log_file, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["replay", str(log_file), "--show", "com,forces"])
    assert stop.value.code == 2
    assert "is not in a log, which has com, dcm" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("demo", ["--log", ".mcap", "Foxglove"]),
        ("plot", ["--output", ".html", "exit status"]),
        ("replay", ["--record", "--realtime-rate", "--headless", "--video", "--show"]),
        ("replay", ["forces: not in a log"]),
    ],
)
def test_help_explains_logs(command, words, capsys):
    with pytest.raises(SystemExit) as stop:
        main([command, "--help"])
    assert stop.value.code == 0
    out = " ".join(capsys.readouterr().out.split())
    for word in words:
        assert word in out
