"""Tables, reports and pictures of results, whatever figures the trials have."""

import json
import signal
import subprocess
import sys

import numpy as np
import pyarrow.parquet as pq
import pytest

from atlas_drake import ScenarioError
from atlas_drake.app.main import main
from atlas_drake.campaigns import Campaign, figures
from atlas_drake.campaigns.comparison import compare
from atlas_drake.campaigns.folder import CampaignFolder
from atlas_drake.campaigns.plan import case_list, make_trial
from atlas_drake.campaigns.report import report
from atlas_drake.campaigns.results import write_parquet, write_results
from atlas_drake.campaigns.sources import Sources

from .conftest import record

pytestmark = pytest.mark.usefixtures("restored_loggers")


@pytest.fixture
def folder(tmp_path):
    """The folder of a campaign without trials."""
    folder = CampaignFolder(tmp_path / "out")
    folder.begin(Campaign(), Sources())
    return folder


def table_of(records, tmp_path):
    path = tmp_path / "table.parquet"
    write_parquet(records, path)
    return pq.read_table(path, page_checksum_verification=True).to_pydict()


def test_each_figure_has_a_column_of_its_own(tmp_path):
    names = ["trial", "seed", "error", "missed", "success", "wall_time_s", "built_anew"]
    names += ["set model", "figure error", "tilt"]
    places = {name: place for place, name in enumerate(names)}
    machine = {"wall_time_s": 0.5}
    trial = record(5) | {"figures": places, "machine": machine}
    trial["values"] = {"model": "atlas"}
    table = table_of({5: trial}, tmp_path)
    assert len(table) == 7 + 1 + len(names)
    assert (table["trial"], table["seed"], table["error"]) == ([5], [5], [None])
    assert (table["wall_time_s"], table["set model"]) == ([0.5], ["atlas"])
    assert table["success"] == [True]
    for place, name in enumerate(names[:-1]):
        assert table[f"figure {name}"] == [place]
    assert table["tilt"] == [9]


@pytest.mark.parametrize(
    ("values", "column"),
    [
        ([1, None, -2], [1, None, -2]),
        ([1, 2**63], [1, 2**63]),
        ([-1, 2**63], [-1.0, 2.0**63]),
        ([1, 2**64], [1.0, 2.0**64]),
        ([1, 2.5], [1.0, 2.5]),
        ([True, None], [True, None]),
        ([True, 2], ["True", "2"]),
        ([[1, 2], "a"], ["[1, 2]", "a"]),
        ([None, None], [None, None]),
    ],
)
def test_a_column_holds_all_values(values, column, tmp_path):
    records = {n: record(n, seed=2**64 - 1, x=value) for n, value in enumerate(values)}
    table = table_of(records, tmp_path)
    assert table["x"] == column
    assert list(map(type, table["x"])) == list(map(type, column))
    assert table["seed"] == [2**64 - 1] * len(values)


def test_a_damaged_table_is_noticed(tmp_path):
    records = {n: record(n, tilt=0.1 * n) for n in range(50)}
    table = table_of(records, tmp_path)
    path = tmp_path / "table.parquet"
    data, random = path.read_bytes(), np.random.default_rng(0)
    length = int.from_bytes(data[-8:-4], "little")
    for place in random.integers(4, len(data) - length - 8, 40):
        damaged = bytearray(data)
        damaged[place] ^= 1 << int(random.integers(8))
        path.write_bytes(damaged)
        try:
            found = pq.read_table(path, page_checksum_verification=True)
        except (OSError, ValueError):
            continue
        assert found.to_pydict() == table


def test_figures_of_any_size_are_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr(figures, "DPI", 20)
    pairs = {
        "nearly_equal": [0.1, np.nextafter(0.1, 1.0)],
        "equal": [1e300, 1e300],
        "zero": [0, 0],
        "tiny": [5e-324, 0.0],
    }
    records = {
        n: record(n, n > 0, **{name: pair[n] for name, pair in pairs.items()})
        for n in range(2)
    }
    (written,) = figures.write_figures(Campaign(), records, tmp_path)
    assert written.name == "distributions.png"


@pytest.mark.parametrize(
    "writer", ["pyarrow.parquet.write_table", "matplotlib.figure.Figure.savefig"]
)
def test_a_program_killed_while_it_writes_leaves_nothing_for_good(
    writer, folder, monkeypatch
):
    monkeypatch.setattr(figures, "DPI", 20)
    for number in range(2):
        folder.write(record(number, tilt=1.0))
    module, _, name = writer.rpartition(".")
    killed = f"""if True:
        import os, pkgutil, signal, sys
        from pathlib import Path
        from atlas_drake.campaigns.folder import CampaignFolder
        from atlas_drake.campaigns.results import write_results

        def die(*given, **named):
            os.kill(os.getpid(), signal.SIGKILL)

        setattr(pkgutil.resolve_name({module!r}), {name!r}, die)
        write_results(CampaignFolder(Path(sys.argv[1])))
    """
    ended = subprocess.run(
        [sys.executable, "-c", killed, str(folder.path)], check=False
    )
    assert ended.returncode == -signal.SIGKILL
    assert list(folder.path.rglob(".*unfinished*"))
    write_results(folder)
    assert not list(folder.path.rglob(".*unfinished*"))


def test_text_that_is_no_unicode_is_kept_readable(folder, capsys, monkeypatch):
    monkeypatch.setattr(figures, "DPI", 20)
    trial = record(0, **{"wo\udcffrd": "na\udcffme"})
    trial |= {"error": "lost \udcff", "values": {"parameters.x": "\ud800"}}
    folder.write(trial)
    assert folder.records()[0]["figures"] == {"wo?rd": "na?me"}
    assert main(["results", str(folder.path)]) == 0
    assert "lost ?" in capsys.readouterr().out


def test_cases_may_be_mappings_and_lists(tmp_path, monkeypatch):
    monkeypatch.setattr(figures, "DPI", 20)
    cases = [{"a": 1, "b": [2]}, {"b": [2]}, [1, 2], 3, "word"]
    campaign = Campaign(cases={"parameters.x": cases})
    folder = CampaignFolder(tmp_path / "out")
    folder.begin(campaign, Sources())
    for number in range(2 * len(cases)):
        values = {"parameters.x": cases[number % len(cases)]}
        folder.write(record(number, number > 0, tilt=1.0) | {"values": values})
    text, _ = write_results(folder)
    assert "parameters.x = {'a': 1, 'b': [2]} | 1 of 2" in text
    for name in ("3", "[1, 2]", "word", "{'b': [2]}"):
        assert f"parameters.x = {name} | 2 of 2" in text


def test_a_folder_has_the_cases_of_its_campaign_in_their_order(tmp_path):
    cases = {"parameters.z": [1, 2], "model": ["atlas", "atlas_v3"]}
    campaign = Campaign(cases=cases)
    folder = CampaignFolder(tmp_path / "out")
    folder.begin(campaign, Sources())
    assert case_list(folder.campaign()) == case_list(campaign)
    trials = [make_trial(one, 2) for one in (campaign, folder.campaign())]
    assert trials[0] == trials[1]


def test_the_report_counts_what_happened_first_in_failures():
    campaign = Campaign(cases={"model": ["atlas", "atlas_v3"]})
    first = [("sole slid", "left"), ("QP unsolved", None), ("sole slid", "left")]
    rows = {}
    for number in range(8):
        kind, place = first[number % 3]
        figures = {"first_failure": kind, "first_failure_at": place}
        model = {"model": campaign.cases["model"][number % 2]}
        rows[number] = record(number, number < 2, **figures) | {"values": model}
    del rows[7]["figures"]["first_failure"]
    lines = [line for line in report(campaign, rows).splitlines() if " of 4" in line]
    assert [line for line in lines if "sole" in line or "QP" in line] == [
        "| model = atlas | sole slid left | 2 of 4 |",
        "| model = atlas | QP unsolved | 1 of 4 |",
        "| model = atlas_v3 | sole slid left | 2 of 4 |",
    ]
    assert "first failure" not in report(campaign, {0: record(0, False)})


@pytest.mark.parametrize("package", ["matplotlib", "pyarrow", "scipy"])
def test_a_missing_package_is_named(package, folder, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    records = {0: record(0)}
    for use in (
        lambda: write_results(folder),
        lambda: compare(records, records, ("a", "b")),
    ):
        with pytest.raises(ScenarioError, match=rf"{package} .*atlas-drake\[sweep\]"):
            use()


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("null", "it is None"),
        ("[]", r"it is \[\]"),
        ("{}", "it has no trial"),
        ("{", "Expecting property name"),
        ("", "Expecting value"),
        (json.dumps(record(3)), "its trial is 3"),
        (json.dumps(record(0) | {"figures": None}), "its figures is None"),
    ],
)
def test_a_file_that_is_no_record_is_named(text, complaint, folder):
    folder.file_of(0).write_text(text)
    message = rf"000000\.json .*: {complaint}.*; delete it"
    with pytest.raises(ScenarioError, match=message):
        folder.records()
