"""Campaigns in processes and on the command line: resume, kill, tables, pictures."""

import os
import shutil
import signal
import subprocess
import sys
import time

import pyarrow.parquet as pq
import pytest

from atlas_drake.app.main import main
from atlas_drake.campaigns.folder import CampaignFolder, same_result
from atlas_drake.campaigns.processes import run_in_processes

pytestmark = pytest.mark.usefixtures("restored_loggers")


def deadly(item):
    """Dies, exits, hangs, raises or answers."""
    if item == "die":
        os.abort()
    if item == "exit":
        sys.exit(3)
    if item == "hang":
        time.sleep(600.0)
    if item == "raise":
        raise ValueError("no")
    return item, os.environ["OMP_NUM_THREADS"], os.getpid()


@pytest.mark.slow
def test_the_other_items_are_done_when_a_process_dies():
    items = ["die", "exit", "hang", "raise", 1, 2, 3]
    outcomes = {o.item: o for o in run_in_processes(deadly, items, 1, limit=0.5)}
    assert set(outcomes) == set(items)
    assert outcomes["die"].error == "the process died (-6)"
    assert outcomes["exit"].error == "the process died (3)"
    assert "in deadly\n" in outcomes["hang"].error
    assert outcomes["hang"].error.endswith("\ntook longer than 0.5 s")
    assert outcomes["raise"].error.endswith("ValueError: no\n")
    assert [outcomes[n].result[:2] for n in (1, 2, 3)] == [(n, "1") for n in (1, 2, 3)]
    assert len({outcomes[n].result[2] for n in (1, 2, 3)}) == 1


OWN = """
    import time
    from pathlib import Path

    def last_gets_lost(sim, parameters):
        if sim.scenario.seed == 4:
            raise RuntimeError(f"gone with {parameters['whom']}")
        sim.advance(0.1)
        if sim.scenario.seed == 3 and not Path(__file__).with_name("resumed").exists():
            time.sleep(600.0)
"""
LINES = """
trial: last_gets_lost
parameters: {whom: the wind}
seeds: counted
goal: 0.9
"""


@pytest.mark.slow
def test_a_killed_sweep_resumes_where_it_stopped(campaign_file, tmp_path, capsys):
    out = tmp_path / "out"
    campaign = str(campaign_file(LINES, OWN))
    command = ["sweep", campaign, "--trials", "5", "--out", str(out)]
    program = [sys.executable, "-m", "atlas_drake", *command, "--jobs", "2"]
    process = subprocess.Popen(program, stdout=subprocess.PIPE)
    folder = CampaignFolder(out)
    deadline = time.monotonic() + 60.0
    while len(folder.records()) < 4 and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    # Its output ends when its processes have ended, too.
    process.communicate(timeout=60.0)
    before = folder.records()
    assert sorted(before) == [0, 1, 2, 4]
    # As if it had been killed while it wrote the record of trial 3.
    (out / "trials/.000003.unfinished.json").write_text("{")
    times = {n: (out / f"trials/{n:06d}.json").stat().st_mtime_ns for n in before}
    (tmp_path / "resumed").touch()
    assert main([*command, "--jobs", "1"]) == 1
    said = capsys.readouterr().out
    assert "Raised in 1, first in trial 4: RuntimeError: gone with the wind" in said
    assert "Goal: 90 % succeed, not met." in said
    records = folder.records()
    assert sorted(records) == list(range(5))
    for number, changed in times.items():
        assert (out / f"trials/{number:06d}.json").stat().st_mtime_ns == changed
    assert not list(out.rglob(".*unfinished*"))
    # The table has it all, and pictures are there to be looked at.
    table = pq.read_table(out / "results.parquet").to_pydict()
    assert table["trial"] == list(range(5))
    assert table["seed"] == [records[n]["seed"] for n in range(5)]
    tilts = [records[n]["figures"]["tilt_max_rad"] for n in range(4)]
    assert table["tilt_max_rad"] == [*tilts, None]
    assert "own.py" in table["error"][4]
    report = (out / "report.md").read_text()
    assert "| all | 4 of 5 | 80.0 % (37.6 to 96.4 %) |" in report
    for name in ("success_by_value", "success_by_direction", "distributions"):
        assert (out / f"{name}.png").stat().st_size > 1000
    capsys.readouterr()
    # One trial alone is the same, and changes nothing.
    log = tmp_path / "three.mcap"
    assert main([*command, "--only", "3", "--log", str(log)]) == 0
    said = capsys.readouterr().out
    assert f"The same as in {out}." in said
    assert "push of" in said
    assert log.exists()
    assert folder.records() == records
    # Another campaign is not for this folder.
    assert main([*command, "--seed", "9"]) == 2
    assert "holds results of another campaign: seed is 9" in capsys.readouterr().err
    # Shards are put together.
    shards = [tmp_path / "a", tmp_path / "b"]
    for shard in shards:
        shard.mkdir()
        shutil.copy(out / "campaign.yaml", shard)
        (shard / "trials").mkdir()
    for number, record in records.items():
        CampaignFolder(shards[number % 2]).write(record)
    merged = tmp_path / "merged"
    assert main(["results", str(merged), *map(str, shards)]) == 0
    assert (merged / "report.md").read_text() == report
    capsys.readouterr()
    assert main(["compare", str(out), str(merged)]) == 0
    assert "5 paired trials" in capsys.readouterr().out
    found = {n: same_result(r) for n, r in CampaignFolder(merged).records().items()}
    assert found == {n: same_result(r) for n, r in records.items()}


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--trials", "0"], "--trials: is 0"),
        (["--jobs", "0"], "--jobs: is 0"),
        (["--shard", "3"], "--shard: is '3'"),
        (["--shard", "3/2"], "--shard: is 3/2"),
        (["--log", "x.mcap"], "--log: is for one trial"),
        (["--only", "-1"], "--only: must be 0 or more"),
        (["--only", "3", "--trials", "3"], "--only: is 3; the campaign has 3 trials"),
        (["--set", "jitter.mas=1"], "jitter.mas"),
        (["--with", "nothing.py"], "nothing.py: there is no such file"),
    ],
)
def test_arguments_of_sweep_that_cannot_be_used_exit_with_2(
    arguments, complaint, campaign_file, tmp_path, capsys
):
    out = ["--out", str(tmp_path / "out")]
    assert main(["sweep", str(campaign_file()), *out, *arguments]) == 2
    assert complaint in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("verb", ["run", "teleop"])
def test_a_campaign_is_sent_to_its_own_command(verb, campaign_file, capsys):
    file = campaign_file()
    assert main([verb, str(file)]) == 2
    assert f"use `atlas-drake sweep {file}`" in capsys.readouterr().err


def test_a_shard_without_trials_succeeds(campaign_file, tmp_path, capsys):
    out = ["--out", str(tmp_path / "out"), "--trials", "1", "--shard", "2/2"]
    assert main(["sweep", str(campaign_file("goal: 0.5")), *out]) == 0
    assert "0 trials" in capsys.readouterr().out


def test_ray_that_is_not_installed_is_named(
    campaign_file, tmp_path, capsys, monkeypatch
):
    monkeypatch.setitem(sys.modules, "ray", None)
    out = ["--out", str(tmp_path / "out")]
    assert main(["sweep", str(campaign_file()), *out, "--ray", "auto"]) == 2
    assert 'pip install "atlas-drake[ray]"' in capsys.readouterr().err


@pytest.mark.slow
def test_trials_that_raise_are_counted_and_end_with_status_1(
    campaign_file, tmp_path, capsys
):
    code = """
        import sys
        import time

        def fail(sim, parameters):
            if sim.scenario.seed == 0:
                raise ValueError("no such luck")
            if sim.scenario.seed == 1:
                sys.exit(3)
            time.sleep(600.0)
    """
    file = campaign_file("trial: fail\nseeds: counted\ntrial_timeout: 5", code)
    out = tmp_path / "out"
    arguments = ["--out", str(out), "--trials", "3", "--jobs", "2"]
    assert main(["sweep", str(file), *arguments]) == 1
    said = capsys.readouterr().out
    assert f"! 3 of 3 trials ended with an error; that of trial 0 is in {out}" in said
    records = CampaignFolder(out).records()
    for number, end in enumerate(
        ("ValueError: no such luck\n", "SystemExit: 3\n", "took longer than 5 s")
    ):
        assert records[number]["error"].endswith(end)
