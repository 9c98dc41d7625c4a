"""Logs on the command line: --log, plot and replay."""

import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import AtlasSimulation, Scenario, read_log
from atlas_drake.app import log as log_command
from atlas_drake.app.main import main
from atlas_drake.logs import png_page

from .conftest import animation_in

pytestmark = pytest.mark.usefixtures("restored_loggers")


@pytest.fixture(scope="module")
def log_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    with AtlasSimulation(log=path) as sim:
        sim.advance_to(0.1)
    return path


def test_a_log_is_complete_up_to_a_failure(scenario, tmp_path, monkeypatch):
    advance = Simulator.AdvanceTo

    def fail(simulator, t):
        if simulator.get_context().get_time() > 0.05:
            raise RuntimeError("diverged")
        return advance(simulator, t)

    monkeypatch.setattr(Simulator, "AdvanceTo", fail)
    file = tmp_path / "run.mcap"
    assert main(["run", scenario(), "--headless", "--log", str(file)]) == 1
    assert read_log(file).time[-1] == pytest.approx(
        0.06, abs=Scenario().resolved().control_period
    )


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


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["plot", "LOG", "--output", "TMP/figure.gif"], ".png, .html"),
        (["plot", "LOG", "--output", "TMP/none/figure.png"], "there is no folder"),
        (["plot", "TMP/none.mcap"], "there is no such file"),
        (["plot", "TMP/fake.mcap"], "it is not a log"),
        (["plot", "TMP/run.csv"], "must end in"),
        (
            ["replay", "TMP/none.mcap", "--headless", "--record", "TMP/a.html"],
            "no such",
        ),
        (["replay", "LOG", "--headless"], "--record"),
        (["replay", "LOG", "--record", "TMP/none/a.html"], "there is no folder"),
    ],
)
def test_arguments_of_plot_and_replay_that_cannot_be_used_exit_with_2(
    arguments, complaint, log_file, tmp_path, capsys
):
    (tmp_path / "fake.mcap").write_text("no log")
    (tmp_path / "run.csv").write_text("time\n")
    line = [a.replace("TMP", str(tmp_path)) for a in arguments]
    line = [str(log_file) if a == "LOG" else a for a in line]
    assert main(line) == 2
    assert complaint in capsys.readouterr().err


def test_a_page_that_a_full_disk_stops_leaves_the_others(
    log_file, tmp_path, capsys, monkeypatch
):
    def draw(_page, path):
        if path.suffix == ".png":
            raise OSError(28, "No space left on device")
        path.write_text("whole")

    monkeypatch.setattr(log_command, "_drawing", lambda _file: draw)
    before = {*log_file.parent.iterdir()}
    full, page = tmp_path / "full.png", tmp_path / "a.html"
    options = ["--output", str(full), "--output", str(page)]
    assert main(["plot", str(log_file), *options]) == 3
    assert f"{full} is lost: No space left on device" in capsys.readouterr().out
    assert [*tmp_path.iterdir()] == [page]
    assert {*log_file.parent.iterdir()} == before


def test_a_page_that_cannot_be_drawn_leaves_nothing(log_file, tmp_path, monkeypatch):
    def fail(_page, path):
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setattr(log_command, "_drawing", lambda _file: fail)
    assert main(["plot", str(log_file), "--output", str(tmp_path / "a.png")]) == 130
    assert [*tmp_path.iterdir()] == []


@pytest.mark.slow
def test_a_missing_plotly_is_named_with_what_to_install(
    log_file, tmp_path, capsys, monkeypatch, hide_package
):
    hide_package("plotly", "atlas_drake.logs.html_page")
    assert main(["plot", str(log_file), "--output", str(tmp_path / "a.html")]) == 2
    assert "pip install plotly" in capsys.readouterr().err
    # Without --output there is the picture, and a hint.
    monkeypatch.setattr(png_page, "DPI", 40)
    log = tmp_path / "run.mcap"
    log.write_bytes(log_file.read_bytes())
    assert main(["plot", str(log)]) == 0
    assert "Left out" in capsys.readouterr().out
    assert (tmp_path / "run.figures.png").exists()
    assert not (tmp_path / "run.figures.html").exists()


def test_plot_without_any_package_names_what_to_install(log_file, capsys, hide_package):
    hide_package("matplotlib", "atlas_drake.logs.png_page")
    hide_package("plotly", "atlas_drake.logs.html_page")
    before = {*log_file.parent.iterdir()}
    assert main(["plot", str(log_file)]) == 2
    out, error = capsys.readouterr()
    assert out.count("Left out") == 2
    for package in ("matplotlib", "plotly"):
        assert f"pip install {package}" in out
    assert "pip install matplotlib" in error
    assert {*log_file.parent.iterdir()} == before


def test_a_replay_with_view_ends_by_itself_without_a_terminal(log_file, capsys):
    assert main(["replay", str(log_file), "--realtime-rate", "0"]) == 0
    assert "Watch at http://localhost" in capsys.readouterr().out


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_stops_a_replay_and_keeps_its_recording(
    log_file, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(log_command, "PIECE", 0.02)
    page = tmp_path / "replay.html"
    options = ["--headless", "--record", str(page)]
    assert main(["replay", str(log_file), *options]) == 130
    assert "Stopped at 0.0 s" in capsys.readouterr().out
    assert page.exists()


def test_a_replay_is_recorded_with_the_overlays_of_show(log_file, tmp_path, capsys):
    page = tmp_path / "replay.html"
    options = ["--headless", "--record", str(page), "--show", "com,cop"]
    assert main(["replay", str(log_file), *options]) == 0
    assert "Replayed at 0.1 s" in capsys.readouterr().out
    assert page.read_text().rstrip().endswith("</html>")
    animation = animation_in(page)
    assert b"/visualizer/atlas/pelvis" in animation
    assert b"/shapes/com_ball" in animation
    assert b"/shapes/cop" in animation
    assert b"/shapes/dcm" not in animation


def test_replay_names_overlays_that_a_log_lacks_and_shows_the_others(
    log_file, tmp_path, capsys
):
    page = tmp_path / "replay.html"
    options = ["--headless", "--record", str(page), "--show", "com,forces"]
    assert main(["replay", str(log_file), *options]) == 0
    out = capsys.readouterr().out
    assert "forces" in out
    assert "--set log.contacts=true" in out
    animation = animation_in(page)
    assert b"/shapes/com_ball" in animation
    assert b"/shapes/forces" not in animation
