"""Folder, table, statistics, report and figures, whatever the trials have found."""

import json
import math
import sys
from dataclasses import replace

import pyarrow.parquet as pq
import pytest

from atlas_drake import PlannedPush, Scenario, ScenarioError
from atlas_drake.clients.campaigns import Campaign, Threshold
from atlas_drake.clients.campaigns.children import as_line
from atlas_drake.clients.campaigns.comparison import compare
from atlas_drake.clients.campaigns.plan import (
    Search,
    Trial,
    case_list,
    make_trial,
    missing_trials,
)
from atlas_drake.clients.campaigns.report import report, write_results
from atlas_drake.clients.campaigns.results import Results, read_campaign, read_records
from atlas_drake.clients.campaigns.table import mcnemar, mean_interval, share_interval


def record(number, success=True, seed=None, values=None, **found):
    """The record of a trial."""
    trial = Trial(number, number if seed is None else seed, values or {})
    return trial.record(success=success, figures=found)


def write(folder, campaign, records):
    with Results(folder, campaign) as results:
        for one in records:
            results.add(as_line(one))


# ---- the folder --------------------------------------------------------------


def test_a_folder_holds_one_campaign(campaign, tmp_path):
    first = campaign("cases: {parameters.z: [1, 2], model: [atlas, atlas_v3]}", "X = 1")
    write(tmp_path, first, [])
    # What changes no result may change; so may the place of the user's code.
    moved = replace(first, trials=7, goal=0.5, code=["elsewhere/own.py"])
    write(tmp_path, moved, [record(0)])
    jitter = replace(first.scenario.jitter, mass=0.1)
    for field, other in (
        ("scenario.jitter.mass", replace(first.scenario, jitter=jitter)),
        ("code", ["another.py"]),
    ):
        changed = replace(first, **{field.partition(".")[0]: other})
        with pytest.raises(ScenarioError, match=field):
            Results(tmp_path, changed)
    again = read_campaign(tmp_path)
    assert again == moved
    assert case_list(again) == case_list(first)
    assert make_trial(again, 2) == make_trial(first, 2)
    assert list(read_records(tmp_path)) == [0]
    with Results(tmp_path, first), pytest.raises(ScenarioError, match="program"):
        Results(tmp_path, first)
    with pytest.raises(ScenarioError, match="folder"):
        read_campaign(tmp_path / "nothing")


def test_a_torn_last_line_is_cut_off(tmp_path):
    campaign, file = Campaign(), tmp_path / "trials.jsonl"
    write(tmp_path, campaign, [record(0), record(1)])
    whole = file.read_bytes()
    for length in (len(whole) - 1, len(whole) - 9):
        file.write_bytes(whole[:length])
        assert list(read_records(tmp_path)) == [0]
        write(tmp_path, campaign, [record(1)])
        assert file.read_bytes() == whole


@pytest.mark.parametrize("text", ["null", "[]", "{}", "{", "", '{"trial": null}'])
def test_a_line_that_is_no_record_is_named(text, tmp_path):
    write(tmp_path, Campaign(), [record(0)])
    with (tmp_path / "trials.jsonl").open("a") as file:
        file.write(f"{text}\n{json.dumps(record(1))}\n")
    with pytest.raises(ScenarioError, match=r"line 2 of .*trials\.jsonl"):
        read_records(tmp_path)


# ---- statistics --------------------------------------------------------------


def test_share_intervals_match_published_values():
    # R. G. Newcombe, Statistics in Medicine 17 (1998), table I, method 3.
    assert share_interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert share_interval(15, 148) == pytest.approx((0.0624, 0.1605), abs=1e-4)
    assert share_interval(0, 20) == pytest.approx((0.0, 0.1611), abs=1e-4)
    assert share_interval(29, 29) == pytest.approx((0.8830, 1.0), abs=1e-4)


def test_intervals_of_means_are_students():
    # The quantile 0.975 for four degrees of freedom is 2.7764.
    half = 2.7764 * math.sqrt(2.5 / 5)
    assert mean_interval([1, 2, 3, 4, 5]) == pytest.approx((3 - half, 3 + half), 1e-4)
    assert mean_interval([0.3]) is None
    assert mean_interval(3 * [0.5]) == pytest.approx((0.5, 0.5))


def test_mcnemars_test_is_exact():
    assert mcnemar(0, 0) == 1.0
    assert mcnemar(1, 9) == pytest.approx(22 / 1024)
    assert mcnemar(5, 5) == 1.0


def test_two_campaigns_are_compared_pair_by_pair():
    first = {n: record(n, n > 2, tilt=0.1 * n) for n in range(10)}
    second = {n: record(n, True, tilt=0.1 * n + 0.5) for n in range(8)}
    text = compare(first, second, ("a", "b"))
    assert "8 paired trials" in text
    assert "only b in 3: p = 0.25" in text
    assert "| tilt | 0.35 | 0.85 | +0.5 (+0.5 to +0.5) |" in text
    alone = compare(first, {3: record(3, tilt=None), 4: second[4]}, ("a", "b"))
    assert "| tilt | 0.4 | 0.9 | +0.5 (one pair only) |" in alone
    second[3] = record(3, seed=77)
    with pytest.raises(ScenarioError, match="seed 77"):
        compare(first, second, ("a", "b"))


@pytest.mark.parametrize("search", ["bisect", "climb"])
@pytest.mark.parametrize(
    ("bears", "passed", "failed"),
    [(0.0, 0.0, 10.0), (34.0, 30.0, 40.0), (85.0, 80.0, 90.0), (200.0, 90.0, None)],
)
def test_a_threshold_is_found_from_either_side(search, bears, passed, failed):
    threshold = Threshold("pushes[0].impulse", 0.0, 90.0, 10.0, 3, 2, search)
    campaign = Campaign(threshold=threshold, cases={"parameters.weak": [False, True]})
    records, rounds = {}, 0
    while trials := missing_trials(campaign, records):
        rounds += 1
        for trial in trials:
            value, weak = trial.values["pushes[0].impulse"], trial.number % 2
            # Replica 0 fails always: two of three are enough.
            replica = trial.number // 2 % 3
            good = value <= bears and not weak and replica > 0
            records[trial.number] = trial.record(success=good)
        # A search that was stopped in a round asks for the rest of it.
        half = dict(list(records.items())[:-1])
        assert records.keys() - half.keys() <= {
            trial.number for trial in missing_trials(campaign, half)
        }
    strong, weak = (Search(campaign, case, records) for case in (0, 1))
    assert (strong.passed, strong.failed) == (passed, failed)
    assert (weak.passed, weak.failed) == (0.0, 10.0)
    assert weak.case == {"parameters.weak": True}
    # Two failures decide; where only one of two failed, the third replica runs.
    replicas = [{n // 2 % 3 for n in records if n % 2 == case} for case in (0, 1)]
    assert replicas == [{0, 1, 2} if passed else {0, 1}, {0, 1}]
    if search == "bisect":
        assert rounds <= 2 * 4


# ---- table, report and figures -----------------------------------------------


@pytest.mark.slow
def test_cases_and_figures_of_all_types_have_table_report_and_figures(tmp_path):
    cases = [{"a": 1, "b": [2]}, {"b": [2]}, [1, 2], 3, "word"]
    campaign = Campaign(cases={"parameters.x": cases})
    found = {
        "whole": 2,
        "large": 2**63,
        "mixed": 2.5,
        "flag": True,
        "error": "na\udcffme",
        "nothing": None,
        "equal": 1e300,
        "tiny": 5e-324,
    }
    records = [
        record(n, n > 0, 2**64 - 1, {"parameters.x": cases[n % 5]}, **found)
        for n in range(10)
    ]
    records[3]["figures"] |= {"mixed": "word", "whole": None, "nearly": 0.1}
    records[4]["figures"]["nearly"] = math.nextafter(0.1, 1.0)
    write(tmp_path, campaign, records)
    text, written = write_results(tmp_path)
    assert "parameters.x = {'a': 1, 'b': [2]} | 1 of 2" in text
    for name in ("3", "[1, 2]", "word", "{'b': [2]}"):
        assert f"parameters.x = {name} | 2 of 2" in text
    assert "![distributions](distributions.png)" in text
    assert all(path.stat().st_size > 100 for path in written)
    table = pq.read_table(tmp_path / "results.parquet").to_pydict()
    assert table["trial"] == list(range(10))
    assert table["seed"] == 10 * [2**64 - 1]
    assert table["success"] == [False] + 9 * [True]
    assert table["values.parameters.x"][:3] == [str(case) for case in cases[:3]]
    assert table["figures.whole"] == [2, 2, 2, None, 2, 2, 2, 2, 2, 2]
    assert table["figures.large"] == 10 * [2**63]
    assert table["figures.mixed"][2:4] == ["2.5", "word"]
    assert table["figures.flag"] == 10 * [True]
    assert table["figures.error"] == 10 * ["na?me"]


def test_the_report_counts_failures_conditions_and_errors():
    campaign = Campaign(
        cases={"model": ["atlas", "atlas_v3"]}, success=["tilt <= 0.3", "awy <= 0.05"]
    )
    first = [("sole slid", "left"), ("QP unsolved", None), ("sole slid", "left")]
    rows = {}
    for number in range(8):
        kind, place = first[number % 3]
        values = {"model": campaign.cases["model"][number % 2]}
        found = {"tilt": 0.4, "first_failure": kind, "first_failure_at": place}
        rows[number] = record(number, number < 2, values=values, **found)
    rows[6]["missed"] = ["tilt <= 0.3", "awy <= 0.05"]
    rows[7] |= {"figures": {}, "error": "Traceback\nRuntimeError: gone\n"}
    text = report(campaign, rows)
    for line in (
        "| all | 2 of 8 | 25.0 % (7.1 to 59.1 %) |",
        "| model = atlas_v3 | 1 of 4 | 25.0 % (4.6 to 69.9 %) |",
        "| model = atlas | sole slid left | 2 of 4 |",
        "| model = atlas | QP unsolved | 1 of 4 |",
        "| model = atlas_v3 | sole slid left | 2 of 4 |",
        "| tilt | 0.4 | 0.4 | 0.4 | 0.4 | 0.4 |",
        "- `tilt <= 0.3` missed in 1 of 8",
        # A misspelt figure shows.
        "- `awy <= 0.05` missed in 1 of 8; no trial has a figure `awy`",
        "Trials that failed: 2, 3, 4, 5, 6, 7.",
        "Raised in 1, first in trial 7: RuntimeError: gone",
    ):
        assert line in text.splitlines()
    assert "first failure" not in report(campaign, {0: record(0, values=values)})


@pytest.mark.slow
def test_a_threshold_over_directions_has_a_report_and_figures(tmp_path):
    campaign = Campaign(
        scenario=Scenario(pushes=[PlannedPush(time=1.0)]),
        threshold=Threshold("pushes[0].impulse", 0.0, 40.0, 10.0, 2, 2),
        cases={"pushes[0].direction": [0.0, 1.57, 3.14, 4.71]},
    ).validate()
    write(tmp_path, campaign, [])
    # Before the first trial there is little to tell, and no figure.
    text, written = write_results(tmp_path)
    assert "0 trials" in text
    assert [path.name for path in written] == ["results.parquet", "report.md"]
    while trials := missing_trials(campaign, read_records(tmp_path)):
        records = []
        for trial in trials:
            direction = trial.values["pushes[0].direction"]
            good = trial.values["pushes[0].impulse"] <= 15.0 + 5.0 * direction
            records.append(trial.record(success=good, figures={"tilt": 0.1}))
        write(tmp_path, campaign, records)
    text, written = write_results(tmp_path)
    assert "| pushes[0].direction = 0 | 10 | 20 |" in text
    assert "| pushes[0].direction = 4.71 | 30 | 40 |" in text
    assert "| pushes[0].impulse = 20 |" in text
    assert {path.stem for path in written} == {
        "results",
        "report",
        "success_by_value",
        "success_by_direction",
        "distributions",
    }


@pytest.mark.parametrize("package", ["matplotlib", "pandas", "scipy"])
def test_a_missing_package_is_named(package, tmp_path, monkeypatch):
    write(tmp_path, Campaign(), [])
    monkeypatch.setitem(sys.modules, package, None)
    records = {0: record(0)}
    for use in (
        lambda: write_results(tmp_path),
        lambda: compare(records, records, ("a", "b")),
    ):
        with pytest.raises(ScenarioError, match=rf"{package} .*atlas-drake\[sweep\]"):
            use()
