"""Logs on the command line: --log, plot, export and replay."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake import AtlasSimulation, Scenario, read_log
from atlas_drake.clients.cli import log as log_command
from atlas_drake.clients.cli.main import main
from atlas_drake.clients.logs.header import Header
from atlas_drake.clients.logs.mcap_writer import McapWriter

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


@pytest.mark.parametrize(
    ("command", "name"),
    [
        pytest.param("plot", "run.png", marks=pytest.mark.slow),
        ("plot --channels balance", "run.png"),
        ("export", "run.parquet"),
    ],
)
def test_a_file_is_made_beside_the_log(command, name, log_file, capsys):
    assert main([command.split()[0], str(log_file), *command.split()[1:]]) == 0
    file = log_file.with_name(name)
    assert file.stat().st_size > 1000
    assert str(file) in capsys.readouterr().out
    file.unlink()


def test_channels_are_listed_and_drawn(log_file, tmp_path, capsys):
    assert main(["plot", str(log_file), "--channels"]) == 0
    lines = capsys.readouterr().out.splitlines()
    units = [
        f"{name} [{unit or '-'}]" for name, unit in read_log(log_file).units.items()
    ]
    assert lines == units
    svg = tmp_path / "figure.svg"
    chosen = ["--channels", "balance.dcm,*.effort.l_leg_kny", "-o", str(svg)]
    assert main(["plot", str(log_file), *chosen]) == 0
    text = svg.read_text()
    for name in ("balance.dcm.x", "balance.dcm.y", "joints.effort.l_leg_kny"):
        assert name in text


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["plot", "LOG", "--output", "TMP/figure.gif"], ".png, .svg, .pdf"),
        (["plot", "LOG", "--output", "TMP/none/figure.png"], "there is no folder"),
        (["plot", "LOG", "--channels", "nose"], "'nose'"),
        (["plot", "TMP/none.mcap"], "there is no such file"),
        (["plot", "TMP/fake.mcap"], "fake.mcap: "),
        (["plot", "TMP/README.md"], "must end in"),
        (["export", "LOG", "-o", "TMP/run.xls"], ".parquet, .csv, .npz"),
        (["replay", "TMP/none.mcap", "--record", "TMP/a.html"], "no such"),
        (["replay", "LOG", "--headless"], "--record"),
        (["replay", "LOG", "--record", "TMP/none/a.html"], "there is no folder"),
    ],
)
def test_arguments_that_cannot_be_used_are_named_in_one_line(
    arguments, complaint, log_file, tmp_path, capsys
):
    (tmp_path / "fake.mcap").write_text("no log")
    (tmp_path / "README.md").write_text("# Atlas\n")
    line = [a.replace("TMP", str(tmp_path)) for a in arguments]
    line = [str(log_file) if a == "LOG" else a for a in line]
    before = {*log_file.parent.iterdir()}
    assert main(line) == 2
    (error,) = capsys.readouterr().err.splitlines()
    assert complaint in error
    assert {*log_file.parent.iterdir()} == before


def test_a_damaged_header_is_said_and_nothing_else_is_lost(log_file, tmp_path, capsys):
    log, damaged = read_log(log_file), tmp_path / "damaged.mcap"
    writer = McapWriter(damaged)
    writer.begin(Header({**log.header.given, "model": 7}), log.schema)
    for record in log.records():
        writer.record(record)
    writer.close()
    fault = f"{damaged}: its header is damaged: model: is 7; must be a valid string"
    table = tmp_path / "columns.npz"
    assert main(["export", str(damaged), "-o", str(table)]) == 0
    assert f"! {fault}\n" in capsys.readouterr().out
    with np.load(table) as columns:
        assert len(columns["time"]) == len(log)
    page = ["--headless", "--record", str(tmp_path / "page.html")]
    for verb, *options in (["plot"], ["film"], ["replay", *page]):
        assert main([verb, str(damaged), *options]) == 2
        assert capsys.readouterr().err == f"atlas-drake: error: {fault}\n"


@pytest.mark.parametrize(
    ("command", "file", "package"),
    [
        ("plot", "run.svg", "matplotlib"),
        ("export", "run.csv", "pandas"),
        ("export", "run.parquet", "pyarrow"),
    ],
)
def test_a_missing_package_is_named_with_what_to_install(
    command, file, package, log_file, tmp_path, capsys, hide_package
):
    hide_package(
        package, "atlas_drake.clients.logs.figures", "atlas_drake.clients.logs.drawing"
    )
    file = tmp_path / file
    assert main([command, str(log_file), "--output", str(file)]) == 2
    (error,) = capsys.readouterr().err.splitlines()
    assert f'pip install "atlas-drake[{command}]"' in error
    assert not file.exists()


@pytest.mark.parametrize("command", ["plot --channels balance.com.x", "export"])
def test_a_file_that_a_full_disk_stops_is_named(
    command, log_file, tmp_path, capsys, largest_file
):
    file = tmp_path / ("a.csv" if command == "export" else "a.png")
    with largest_file(1000):
        line = [*command.split(), str(log_file), "--output", str(file)]
        assert main(line) == 3
    assert f"{file} is lost: File too large" in capsys.readouterr().out
    assert [*tmp_path.iterdir()] == []


# ---- replay ------------------------------------------------------------------


@pytest.mark.slow
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
