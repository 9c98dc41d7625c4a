"""The command line: printed text, written files and exit status."""

import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from pydrake.geometry import Meshcat, MeshcatParams

from atlas_drake import read_log
from atlas_drake.atomic_write import atomic_write, why_not_writable
from atlas_drake.clients.cli import run as run_command
from atlas_drake.clients.cli.main import main
from atlas_drake.clients.cli.run import AFTER_FALL, verdict
from atlas_drake.clients.view.viewer import start_meshcat
from atlas_drake.simulation.tutorial import DURATION

from .conftest import animation_in

pytestmark = pytest.mark.usefixtures("restored_loggers")

FALL = "initial_behavior: USER\nduration: 30.0\njitter: {joints: 0.6}\n"
"""All joints in the user's hands, in a pose that does not stand: down within 1 s."""


# ---- parsing -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--help"], ["demo", "run", "script", "teleop", "diagram"]),
        (["run", "--help"], ["SCENARIO.yaml", "--record", "exit status"]),
        (["script", "--help"], ["FILE.py", "-- ARGUMENT"]),
        (["--version"], ["atlas-drake", "drake"]),
    ],
)
def test_help_names_commands_and_options(arguments, words, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 0
    out = " ".join(capsys.readouterr().out.split())
    for word in words:
        assert word in out


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "COMMAND"),
        (["dance"], "'dance'"),
        (["plot", "a.mcap", "--xyz"], "--xyz"),
        (["run", "a.yaml", "b.yaml"], "b.yaml"),
        (["demo", "--realtime-rate", "-1"], "number from 0 up"),
        (["demo", "--duration", "long"], "--duration"),
        (["demo", "--port", "80"], "1024..65535"),
        (["demo", "--seed", "x"], "--seed"),
        (["teleop", "--show", "com,aura"], "no overlay 'aura'"),
        (["demo", "--video-size", "960"], "960x540"),
        (["demo", "--video-size", "10x9000"], "64..4096"),
    ],
)
def test_arguments_that_cannot_be_used_exit_with_2_and_one_line(
    arguments, complaint, capsys
):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert error.count("\n") == 1


# ---- bad input ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "field"),
    [("durration: 1.0\n", "durration"), ("jitter: {mass: -0.1}\n", "jitter.mass")],
)
def test_a_bad_scenario_is_named_by_field(text, field, scenario, capsys):
    assert main(["run", scenario(text), "--headless"]) == 2
    assert field in capsys.readouterr().err


def test_a_missing_file_is_reported_before_drake_is_loaded():
    code = """
import sys
from atlas_drake.clients.cli.main import main
for verb in ("run", "teleop", "plot", "replay"):
    assert main([verb, "none.mcap"]) == 2, verb
assert "pydrake" not in sys.modules
"""
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("none.mcap: there is no such file") == 4


VERBS = ("run", "teleop", "script", "sweep", "plot", "export", "replay", "film")


@pytest.mark.parametrize(
    "arguments",
    [
        *([verb, "PIPE"] for verb in VERBS),
        ["import", "PIPE"],
        ["demo", "--with", "PIPE"],
        ["demo", "--model", "PIPE"],
        ["demo", "--world", "PIPE"],
        ["replay", "FILE", "--beside", "PIPE"],
        ["results", "FOLDER"],
        ["compare", "FOLDER", "FOLDER"],
    ],
)
def test_no_input_is_waited_for_without_end(arguments, tmp_path, capsys):
    kind = {"import": "urdf", "demo": "yaml"}.get(arguments[0], "mcap")
    places = {"PIPE": tmp_path / f"pipe.{kind}", "FOLDER": tmp_path, "FILE": __file__}
    for path in (places["PIPE"], tmp_path / "campaign.yaml"):
        os.mkfifo(path)
    assert main([str(places.get(word, word)) for word in arguments]) == 2
    told = capsys.readouterr().err
    assert re.search(r"(no regular|there is no) file", told)


@pytest.mark.parametrize(
    ("options", "complaints"),
    [
        (["demo", "--model", "spot"], ["spot", "atlas, atlas_v3"]),
        (["demo", "--physics-step", "0.011"], ["physics_step"]),
        (["demo", "--seed", "-1"], ["seed"]),
        (["demo", "--set", "controller.gains.dcm_gian=2"], ["Did you mean 'dcm_gain'"]),
        (["teleop", "--set", "controller.gains.dcm_gian=2"], ["mean 'dcm_gain'"]),
        pytest.param(
            ["demo", "--host", "a..b"],
            ["cannot be served on a..b"],
            marks=pytest.mark.slow,
        ),
        # Addresses set aside for documentation belong to nobody.
        pytest.param(
            ["demo", "--host", "192.0.2.1"],
            ["--host", "192.0.2.1"],
            marks=pytest.mark.slow,
        ),
    ],
)
def test_options_are_checked_like_the_file(options, complaints, capsys):
    assert main(options) == 2
    error = capsys.readouterr().err
    for complaint in complaints:
        assert complaint in error


# ---- runs --------------------------------------------------------------------


@pytest.mark.slow
def test_a_run_that_stays_upright_succeeds(scenario, tmp_path, capsys, summary_keys):
    file, log, page = (tmp_path / f"run.{end}" for end in ("json", "mcap", "html"))
    arguments = ["--model", "atlas_v3", "--seed", "7", "--physics-step", "0.002"]
    arguments += ["--duration", "0.06", "--set", "seed=8"]
    arguments += ["--set", "controller.gains.dcm_gain=2.5", "--headless"]
    arguments += ["--json", str(file), "--log", str(log), "--record", str(page)]
    assert main(["run", scenario(), *arguments]) == 0
    out = capsys.readouterr().out
    assert "Success: the robot is upright after 0.1 s" in out
    assert f"atlas-drake plot {log}" in out
    summary = json.loads(file.read_text())
    assert summary.keys() >= summary_keys
    assert summary["success"] is True
    assert summary["stopped"] is None
    assert (summary["model"], summary["seed"]) == ("atlas_v3", 8)
    assert summary["physics_step"] == 0.002
    assert summary["sim_time"] == pytest.approx(0.06)
    kept = read_log(log)
    # A row at each control tick before the end.
    assert len(kept) == math.ceil(0.06 / summary["control_period"])
    assert kept.scenario.controller_config().gains.dcm_gain == 2.5
    assert b"/visualizer/atlas_v3/pelvis" in animation_in(page)


@pytest.mark.slow
def test_a_fall_fails_and_ends_the_run(scenario, tmp_path, capsys):
    file = tmp_path / "out.json"
    assert main(["run", scenario(FALL), "--headless", "--json", str(file)]) == 1
    assert "Failed: the robot fell at" in capsys.readouterr().out
    summary = json.loads(file.read_text())
    assert summary["fell"] is True
    assert summary["success"] is False
    falls = [event["time"] for event in summary["events"] if event["kind"] == "fall"]
    assert summary["sim_time"] == pytest.approx(falls[0] + AFTER_FALL, abs=0.2)


@pytest.mark.usefixtures("ctrl_c")
def test_ctrl_c_ends_a_run_and_its_files_are_complete(scenario, tmp_path, capsys):
    before = signal.getsignal(signal.SIGINT)
    file, page, log = (tmp_path / f"out.{end}" for end in ("json", "html", "mcap"))
    keep = ["--json", str(file), "--record", str(page), "--log", str(log)]
    assert main(["run", scenario("duration: 60.0\n"), "--headless", *keep]) == 130
    assert signal.getsignal(signal.SIGINT) is before
    summary = json.loads(file.read_text())
    assert summary["stopped"] == "interrupted"
    assert summary["success"] is False
    assert summary["sim_time"] == pytest.approx(run_command.PIECE)
    assert page.read_text().rstrip().endswith("</html>")
    period = summary["control_period"]
    rows = math.ceil(run_command.PIECE / period)
    assert read_log(log).time[-1] == pytest.approx((rows - 1) * period)
    assert "Stopped at 0.1 s" in capsys.readouterr().out


def test_a_recording_has_the_motion_and_the_shapes(scenario, tmp_path, capsys):
    page = tmp_path / "out.html"
    options = ["--record", str(page), "--show", "com", "--realtime-rate", "0"]
    assert main(["run", scenario(), *options]) == 0
    assert str(page) in capsys.readouterr().out
    animation = animation_in(page)
    assert b"/visualizer/atlas/pelvis" in animation
    # Shown from the very first picture on, which is hence part of the recording.
    assert b"/shapes/com_ball/" in animation
    assert b".visible" in animation


def test_instead_of_a_port_in_use_the_next_free_one_is_taken(scenario, capsys):
    # Meshcat itself, as only it knows which of localhost's addresses it listens on.
    taken = Meshcat(MeshcatParams(host="localhost"))
    port = taken.port()
    options = ["--port", str(port), "--realtime-rate", "0"]
    assert main(["run", scenario(), *options]) == 0
    out = capsys.readouterr().out
    found = re.search(rf"Port {port} is in use; the 3D view is on (\d+)\.", out)
    assert int(found[1]) > port
    assert f"Watch at http://localhost:{found[1]}" in out


def test_a_view_that_others_can_reach_says_so():
    said = []
    assert start_meshcat("127.0.0.1", say=said.append)
    assert said == []
    everywhere = start_meshcat("*", say=said.append)
    assert f"everyone with access to port {everywhere.port()}" in said.pop()


def test_a_name_that_no_file_can_have_is_bad_input(scenario, tmp_path, capsys):
    loop = tmp_path / "loop.json"
    loop.symlink_to(loop)
    long = str(tmp_path / f"{'a' * 300}.json")
    for arguments in (
        ["run", long],
        ["run", scenario(), "--headless", "--json", long],
        ["run", scenario(), "--headless", "--json", str(loop)],
        ["run", scenario(), "--headless", "--log", long.replace("json", "mcap")],
    ):
        assert main(arguments) == 2
        assert "atlas-drake: error: " in capsys.readouterr().err


def test_a_file_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    path, flushed = tmp_path / f"{'a' * 250}.json", []

    def flush(number):
        flushed.append((path.exists(), os.fstat(number).st_size))

    monkeypatch.setattr(os, "fsync", flush)
    assert why_not_writable(path) is None
    with atomic_write(path) as unfinished:
        unfinished.write_text("whole")
    assert flushed == [(False, 5)]
    assert [*tmp_path.iterdir()] == [path]
    assert path.read_text() == "whole"


@pytest.mark.parametrize(
    ("options", "schedule"), [([], "tutorial"), (["--literal"], "tutorial_literal")]
)
def test_the_demo_is_the_tutorial(options, schedule, monkeypatch):
    asked = []
    monkeypatch.setattr(run_command, "run_scenario", lambda *run: asked.append(run))
    main(["demo", "--headless", "--physics-step", "0.002", *options])
    scenario, given = asked[0]
    assert (scenario.schedule, scenario.duration) == (schedule, DURATION)
    assert given.physics_step == 0.002


@pytest.mark.slow
def test_the_demo_succeeds_also_as_published(tmp_path):
    file = tmp_path / "out.json"
    assert main(["demo", "--literal", "--headless", "--json", str(file)]) == 0
    summary = json.loads(file.read_text())
    assert [step["foot"] for step in summary["footsteps"]] == [0, 1, 0, 1]
    assert all(step["error_m"] < 0.02 for step in summary["footsteps"])


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (["--log", "a.mcap", "--json", "a.mcap"], "--log"),
        (["--record", "a.html", "--json", "./a.html"], "--record"),
        (["--json", "scenario.yaml"], "already the file of the scenario"),
        (["--record", "a.txt"], "must end in .html"),
        (["--json", "no/file"], "--json"),
        (["--video", "."], "is a folder"),
        (["--log", "run.csv"], ".mcap"),
        (["--log", "no/run.mcap"], "there is no folder"),
    ],
)
def test_a_file_that_cannot_be_written_is_noticed_before_the_run(
    options, word, scenario, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(run_command, "AtlasSimulation", None)  # must not be reached
    monkeypatch.chdir(tmp_path)
    text = Path(scenario()).read_text()
    assert main(["run", "scenario.yaml", "--headless", *options]) == 2
    assert word in capsys.readouterr().err
    assert Path("scenario.yaml").read_text() == text


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full disk here")
@pytest.mark.parametrize("full", ["--json", "--video", "--log"])
def test_a_full_disk_loses_one_file_and_no_other(full, scenario, tmp_path, capsys):
    pytest.importorskip("av", reason='needs pip install "atlas-drake[video]"')
    names = {"--json": "a.json", "--record": "a.html", "--video": "a.gif"}
    files = {option: tmp_path / name for option, name in names.items()}
    files["--log"] = tmp_path / "a.mcap"
    options = ["--headless", "--physics-step", "0.002", "--video-size", "64x64"]
    for option, file in files.items():
        options += [option, str(file)]
    lost = files.pop(full)
    lost.symlink_to("/dev/full")
    assert main(["run", scenario(), *options]) == 3
    out = capsys.readouterr().out
    assert f"{lost} is lost: No space left on device" in out
    assert "Success: the robot is upright after 0.1 s" in out
    if full == "--log":  # A film is made of the log.
        assert f"{files.pop('--video')} is lost" in out
    assert all(file.stat().st_size > 1000 for file in files.values())
    if full == "--log":  # Which is noticed, and told, while the run goes on.
        told = f"{lost}: cannot be written: No space left on device; the run"
        events = json.loads(files["--json"].read_text())["events"]
        assert [told in e["text"] for e in events if e["kind"] == "warning"] == [True]


def test_a_second_ctrl_c_cuts_off_nothing_that_is_written(
    scenario, tmp_path, capfd, ctrl_c, monkeypatch
):
    close = run_command.AtlasSimulation.close
    monkeypatch.setattr(
        run_command.AtlasSimulation,
        "close",
        lambda sim: (ctrl_c(), close(sim)),
    )
    file, log = tmp_path / "out.json", tmp_path / "out.mcap"
    keep = ["--json", str(file), "--log", str(log)]
    assert main(["run", scenario("duration: 60.0\n"), "--headless", *keep]) == 130
    assert json.loads(file.read_text())["stopped"] == "interrupted"
    assert log.is_file()
    assert "Still writing" in capfd.readouterr().err


# ---- verdicts ----------------------------------------------------------------


def test_each_outcome_of_a_run_has_its_verdict():
    ended = {
        "success": True,
        "fell": False,
        "upright": True,
        "stopped": None,
        "sim_time": 17.0,
        "real_time_factor": 1.5,
        "footsteps": [{"error_m": 0.004, "error_rad": 0.0}],
        "events": [],
    }
    assert "upright after 17.0 s, 1 step" in verdict(ended)
    far = [{"error_m": 0.834, "error_rad": 0.0}]
    for changes, words in (
        ({"fell": True, "events": [_event("fall")]}, "fell at 3.2 s: why"),
        ({"events": [_event("refusal")]}, "did not execute a command: why"),
        ({"events": [_event("steps left")]}, "is upright, but why"),
        ({"upright": False}, "did not end upright"),
        ({"footsteps": far}, "is upright, but a foot landed 0.83 m from"),
        ({"footsteps": far, "upright": False}, "did not end upright"),
        ({"stopped": "diverged"}, "diverged"),
    ):
        assert words in verdict(ended | {"success": False} | changes)


def _event(kind):
    return {"time": 3.2, "kind": kind, "text": "why"}


# ---- teleoperation -----------------------------------------------------------


@pytest.mark.slow
def test_teleop_prints_its_address_and_ends_after_its_duration(capsys):
    assert main(["teleop", "--duration", "0.2", "--show", "all"]) == 0
    out = capsys.readouterr().out
    assert "http://" in out
    assert "Stopped at 0.2 s" in out


# ---- the diagram's picture ---------------------------------------------------


def test_the_diagram_is_drawn_by_drake(tmp_path, monkeypatch):
    calls = []
    monkeypatch.setattr(shutil, "which", lambda name: name)
    monkeypatch.setattr(subprocess, "run", lambda *a, **options: calls.append(options))
    assert main(["diagram", str(tmp_path / "diagram.svg")]) == 0
    assert main(["diagram", str(tmp_path / "diagram.dot")]) == 0
    source = (tmp_path / "diagram.dot").read_text()
    for name in ("scheduler", "station", "controller", "plant", "robot_sensors"):
        assert f"name={name}\n" in source
        assert f"name={name}\n" in calls[0]["input"]


def test_a_picture_that_cannot_be_drawn_is_bad_input(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    for name, word in {
        "diagram.png": "install graphviz",
        "diagram.gif": ".svg",
        "missing/diagram.dot": "cannot be written",
    }.items():
        assert main(["diagram", str(tmp_path / name)]) == 2
        assert word in capsys.readouterr().err
    assert [*tmp_path.iterdir()] == []
