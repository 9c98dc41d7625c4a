"""Campaigns that run: killed, failing, on a full disk, on a cluster."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import CancelledError
from dataclasses import replace

import pytest

from atlas_drake.clients.campaigns import load_campaign, run_campaign
from atlas_drake.clients.campaigns.children import Child, Work
from atlas_drake.clients.campaigns.plan import make_trial, missing_trials
from atlas_drake.clients.campaigns.results import (
    as_line,
    read_campaign,
    read_records,
    same_result,
)
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.clients.cli.main import main

pytestmark = pytest.mark.usefixtures("restored_loggers")
WAIT = 120.0
"""Longest wait for another process [s]."""


def run_program(file, out, *options, **given):
    """Starts the command in a process of its own, from which tests can kill it."""
    command = [sys.executable, "-m", "atlas_drake", "sweep", str(file)]
    command += ["--out", str(out), "--jobs", "2", *options]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    return subprocess.Popen(command, **pipes, **given)


def numbers_in(out):
    """Numbers of the trials, in the order of their lines."""
    file = out / "trials.jsonl"
    lines = file.read_bytes().split(b"\n")[:-1] if file.exists() else []
    return [json.loads(line)["trial"] for line in lines]


def wait_until(true):
    deadline = time.monotonic() + WAIT
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def records_here(campaign, without=None):
    """Records of a campaign's trials, run in this process one after the other."""
    runner = TrialRunner(campaign)
    trials = [make_trial(campaign, number) for number in range(campaign.trials)]
    lines = [as_line(runner(t)) for t in trials if t.number != without]
    return {record["trial"]: record for record in map(json.loads, lines)}


def same(records):
    return {number: same_result(record) for number, record in records.items()}


KILLS = """
    import os
    import signal
    from pathlib import Path

    def killed_at_first(sim, parameters):
        sim.advance(0.05)
        begun = Path(parameters["folder"], str(sim.scenario.seed))
        if parameters["kill"] and sim.scenario.seed % 3 == 1 and not begun.exists():
            begun.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        sim.advance(0.05)
"""


@pytest.mark.slow
def test_kills_lose_and_double_nothing(campaign_file, tmp_path):
    folder, out = tmp_path / "begun", tmp_path / "out"
    folder.mkdir()
    more = "trial: killed_at_first\nseeds: counted\ntrials: 6\n"
    more += f"parameters: {{folder: {folder}, kill: %s}}\n"
    file = campaign_file(more % "true", KILLS)
    process = run_program(file, out)
    wait_until(lambda: len(numbers_in(out)) >= 2)
    process.send_signal(signal.SIGKILL)
    # Its output ends when its children have ended, too.
    process.communicate(timeout=WAIT)
    before = numbers_in(out)
    with (out / "trials.jsonl").open("a") as torn:
        torn.write('{"trial": 1')
    assert main(["sweep", str(file), "--out", str(out), "--jobs", "2"]) == 0
    assert len(list(folder.iterdir())) == 2
    numbers = numbers_in(out)
    assert sorted(numbers) == list(range(6))
    assert numbers[: len(before)] == before
    undisturbed = load_campaign(campaign_file(more % "false", KILLS))
    assert same(read_records(out)) == same(records_here(undisturbed))


FAILURES = """
    import ctypes
    import os
    import re
    import sys
    import time

    class Local(Exception):
        def __reduce__(self):
            raise TypeError("never pickled")

    def fail(sim, parameters):
        sim.advance(0.02)
        how = parameters["how"]
        if how == "exit":
            sys.exit(3)
        if how == "leave":
            os._exit(0)
        if how == "crash":
            ctypes.string_at(0)
        if how == "orphan":  # Leaves a process that has the pipe, too.
            if os.fork() == 0:
                time.sleep(20.0)
            os._exit(5)
        if how == "hang":
            time.sleep(600.0)
        if how == "hold":  # Holds Python's lock.
            re.match("(a*)*b", 40 * "a")
        if how == "raise":
            raise Local("no such luck")
        if how == "object":
            return {"x": object()}
        if how == "digits":
            return {"x": 10**5000}
        return {"pid": os.getpid()}
"""
ENDS = {
    "exit": "SystemExit: 3",
    "leave": "the process died (0)",
    "crash": "the process died (-11)",
    "orphan": "the process died (5)",
    "hang": "took longer than 2 s",
    "hold": "took longer than 2 s",
    "raise": "Local: no such luck",
    "object": "fail: 'x' is <object object",
    "digits": "integer string conversion",
}


@pytest.mark.slow
def test_a_trial_that_fails_in_any_way_is_a_line_of_its_own(
    campaign_file, tmp_path, capsys
):
    hows = ["no", *ENDS, "not"]
    more = f"trial: fail\ncases: {{parameters.how: {hows}}}\ntrial_timeout: 2\n"
    out = tmp_path / "out"
    arguments = [str(campaign_file(more, FAILURES)), "--out", str(out)]
    arguments += ["--trials", "1", "--jobs", "2"]
    assert main(["sweep", *arguments]) == 1
    said = capsys.readouterr().out
    assert "! 9 of 11 trials ended with an error, the first of them trial 1" in said
    records = read_records(out)
    for record, how in zip(map(records.get, range(11)), hows, strict=True):
        if how in ENDS:
            last = record["error"].strip().splitlines()[-1]
            assert ENDS[how] in last, how
        else:
            assert record["error"] is None
    # They are done: the same command runs none of them again.
    assert missing_trials(read_campaign(out), records) == []


@pytest.mark.slow
def test_a_child_that_is_killed_while_it_waits_is_replaced(campaign_file):
    more = "trial: fail\nparameters: {how: well}\n"
    campaign = load_campaign(campaign_file(more, FAILURES))
    child, pids = Child(Work.of(campaign)), []
    for number, pause in enumerate((0.0, 0.5, 0.0)):
        found = json.loads(child.run(make_trial(campaign, number)))
        pids.append(found["figures"]["pid"])
        os.kill(pids[-1], signal.SIGKILL)
        time.sleep(pause)
    assert len(set(pids)) == 3
    child.end()
    with pytest.raises(CancelledError):
        child.run(make_trial(campaign, 3))


@pytest.mark.slow
def test_a_full_disk_ends_with_one_sentence(
    campaign_file, tmp_path, capsys, largest_file
):
    out = tmp_path / "out"
    command = ["sweep", str(campaign_file("trials: 10\n")), "--out", str(out)]
    with largest_file(4096):
        assert main([*command, "--jobs", "1"]) == 1
    said = "".join(capsys.readouterr())
    assert f"! {out} cannot be written: File too" in said
    assert "Traceback" not in said
    kept = list(read_records(out))
    assert 1 <= len(kept) < 10


CLUSTER = """
    import os
    import signal
    from pathlib import Path

    def loses_its_worker(sim, parameters):
        sim.advance(0.05)
        begun = Path(parameters["folder"], "begun")
        if sim.scenario.seed == 3 and parameters["kill"] and not begun.exists():
            begun.write_text(str(os.getpid()))
            os.kill(os.getppid(), signal.SIGKILL)
            signal.pause()
        if sim.scenario.seed == 5:
            os._exit(7)
        sim.advance(0.05)
"""


@pytest.fixture
def dask(tmp_path):
    """Starts a scheduler and workers; gives a function that starts one of the two."""
    processes = []
    file = tmp_path / "scheduler.json"

    def start(kind, *options):
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *options]
        command += ["--scheduler-file", str(file), "--no-dashboard"]
        quiet = subprocess.DEVNULL
        process = subprocess.Popen(command, stdout=quiet, stderr=quiet)
        processes.append(process)
        return process

    start("scheduler", "--port", "0", "--host", "127.0.0.1")
    wait_until(file.exists)
    yield start, json.loads(file.read_text())["address"]
    for process in processes:
        process.kill()
        process.wait()


@pytest.mark.slow
def test_a_cluster_finds_the_same_though_a_worker_is_killed(
    dask, campaign_file, tmp_path, capsys
):
    start, address = dask
    more = "trial: loses_its_worker\nseeds: counted\ntrials: 6\n"
    more += f"parameters: {{folder: {tmp_path}, kill: %s}}\n"
    # A worker that may have no children is named.
    daemon = start("worker", "--nthreads", "1")
    file = campaign_file(more % "true", CLUSTER)
    command = ["sweep", str(file), "--cluster", address, "--out", str(tmp_path / "out")]
    assert main(command) == 2
    assert "--no-nanny" in capsys.readouterr().err
    daemon.terminate()
    daemon.wait(WAIT)
    workers = [start("worker", "--nthreads", "1", "--no-nanny") for _ in range(2)]
    assert main(command) == 1
    assert sorted(numbers_in(tmp_path / "out")) == list(range(6))
    assert [worker.poll() for worker in workers].count(-signal.SIGKILL) == 1
    # The child has ended with its worker.
    child = int((tmp_path / "begun").read_text())
    wait_until(lambda: not os.path.exists(f"/proc/{child}"))
    here = load_campaign(campaign_file(more % "false", CLUSTER))
    records = read_records(tmp_path / "out")
    assert records[5]["error"] == "the process died (7)"
    del records[5]  # It would end this process, too.
    assert same(records) == same(records_here(here, without=5))


# ---- the command line --------------------------------------------------------


@pytest.mark.slow
def test_a_campaign_runs_resumes_and_shows_one_trial(campaign_file, tmp_path, capsys):
    out = tmp_path / "out"
    more = "vary: {ground_friction: {uniform: [0.5, 0.9]}}\ngoal: 1.0\n"
    file = campaign_file(more)
    run_campaign(replace(load_campaign(file), trials=1), out)
    first = (out / "trials.jsonl").read_bytes()
    command = ["sweep", str(file), "--out", str(out)]
    assert main([*command, "--trials", "2", "--jobs", "1"]) == 0
    assert "Goal: 100 % succeed, met." in capsys.readouterr().out
    assert (out / "trials.jsonl").read_bytes().startswith(first)
    assert numbers_in(out) == [0, 1]
    report = (out / "report.md").read_text()
    assert "| all | 2 of 2 | 100.0 % (34.2 to 100.0 %) |" in report
    capsys.readouterr()
    log = tmp_path / "one.mcap"
    assert main([*command, "--only", "1", "--log", str(log)]) == 0
    assert f"The same as in {out}." in capsys.readouterr().out
    assert log.exists()
    assert numbers_in(out) == [0, 1]
    assert main([*command, "--seed", "9"]) == 2
    assert "seed is 9" in capsys.readouterr().err
    assert main(["compare", str(out), str(out)]) == 0
    assert "2 paired trials" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (["--trials", "0"], "trials"),
        (["--jobs", "0"], "--jobs"),
        (["--log", "x.mcap"], "--log"),
        (["--only", "-1"], "--only"),
        (["--only", "3", "--trials", "3"], "--only"),
        (["--set", "jitter.mas=1"], "jitter.mas"),
        (["--with", "nothing.py"], "nothing.py"),
        (["--cluster", "tcp://127.0.0.1:1"], "--cluster"),
        (["--cluster", "nonsense"], "--cluster"),
        (["--out", "/dev/null/out"], "--out"),
    ],
)
def test_arguments_of_sweep_that_cannot_be_used_exit_with_2(
    arguments, field, campaign_file, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr("atlas_drake.clients.campaigns.runner.CONNECT_WITHIN", 0.5)
    out = ["--out", str(tmp_path / "out")]
    assert main(["sweep", str(campaign_file()), *out, *arguments]) == 2
    assert field in capsys.readouterr().err
    assert not (tmp_path / "out" / "trials.jsonl").exists() or field == "--cluster"


@pytest.mark.parametrize("verb", ["run", "teleop"])
def test_a_campaign_is_sent_to_its_own_command(verb, campaign_file, capsys):
    file = campaign_file()
    assert main([verb, str(file)]) == 2
    assert f"use `atlas-drake sweep {file}`" in capsys.readouterr().err
