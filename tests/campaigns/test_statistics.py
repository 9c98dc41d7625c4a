"""Intervals, paired comparison, and the search for a threshold."""

import math

import pytest

from atlas_drake import PlannedPush, Scenario, ScenarioError
from atlas_drake.campaigns import Campaign, Shard, Threshold
from atlas_drake.campaigns.comparison import compare, mcnemar, mean_interval
from atlas_drake.campaigns.folder import CampaignFolder
from atlas_drake.campaigns.report import report, share_interval
from atlas_drake.campaigns.results import write_results
from atlas_drake.campaigns.runner import missing_trials
from atlas_drake.campaigns.sources import Sources
from atlas_drake.campaigns.threshold import Search, level_of

from .conftest import record


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
    # As many pairs as a large campaign has.
    tail = sum(math.comb(2000, count) for count in range(901))
    assert mcnemar(1100, 900) == pytest.approx(2 * tail / 2**2000)


def test_a_report_counts_the_missed_conditions():
    campaign = Campaign(success=("walk_ended", "tilt <= 0.3", "awy_m <= 0.05"))
    missed = record(0, success=False, walk_ended=True, tilt=0.4)
    missed["missed"] = ["tilt <= 0.3", "awy_m <= 0.05"]
    met = record(1, success=False, walk_ended=True, tilt=0.2)
    met["missed"] = ["awy_m <= 0.05"]
    lines = report(campaign, {0: missed, 1: met}).splitlines()
    assert "- `tilt <= 0.3` missed in 1 of 2" in lines
    # A misspelt figure shows.
    unknown = "- `awy_m <= 0.05` missed in 2 of 2; no trial has a figure `awy_m`"
    assert unknown in lines
    assert not any("walk_ended` missed" in line for line in lines)


def test_two_campaigns_are_compared_pair_by_pair():
    first = {n: record(n, n > 2, tilt=0.1 * n) for n in range(10)}
    second = {n: record(n, True, tilt=0.1 * n + 0.5) for n in range(8)}
    text = compare(first, second, ("a", "b"))
    assert "8 paired trials" in text
    assert "only b in 3: p = 0.25" in text
    assert "+0.5 (+0.5 to +0.5)" in text
    alone = compare(first, {3: record(3, tilt="steep"), 4: second[4]}, ("a", "b"))
    assert "| tilt | 0.4 | 0.9 | +0.5 (one pair only) |" in alone
    second[3] = record(3, seed=77)
    with pytest.raises(ScenarioError, match="seed 77"):
        compare(first, second, ("a", "b"))


@pytest.mark.parametrize("search", ["bisect", "climb"])
@pytest.mark.parametrize(
    ("bears", "borne", "too_much"),
    [(0.0, 0.0, 10.0), (34.0, 30.0, 40.0), (85.0, 80.0, 90.0), (200.0, 90.0, None)],
)
def test_a_threshold_is_found_from_either_side(search, bears, borne, too_much):
    threshold = Threshold("pushes[0].impulse", 0.0, 90.0, 10.0, 3, 2, search)
    campaign = Campaign(threshold=threshold, cases={"parameters.weak": [False, True]})
    found = []
    for case in (0, 1):
        search, records, rounds = Search(campaign, case), {}, []
        while trials := search.next_trials(records):
            rounds.append(len(trials))
            for trial in trials:
                level = level_of(campaign, trial.number)
                value = trial.values["pushes[0].impulse"]
                assert value == threshold.value(level)
                # Replica 0 fails always: two of three are enough.
                replica = trial.number // 2 % 3
                good = value <= bears and not case and replica > 0
                records[trial.number] = record(trial.number, good, trial.seed)
        found.append(search.found(records))
        # Two failures decide; one needs the third replica.
        ends = [1] if bears >= 10.0 and not case else []
        assert set(rounds) <= {2, *ends}
        assert len(rounds) > 1 or not ends
        if threshold.search == "bisect":
            assert len(records) <= 3 * 4
    assert [f.ended for f in found] == [True, True]
    assert (found[0].borne, found[0].too_much) == (borne, too_much)
    assert (found[1].borne, found[1].too_much) == (0.0, 10.0)
    assert found[1].case == {"parameters.weak": True}


def test_an_unfinished_search_asks_for_the_missing_trials():
    threshold = Threshold("jitter.mass", 0.0, 0.4, 0.1, 2, 2)
    search = Search(Campaign(threshold=threshold), 0)
    assert not search.found({}).ended
    numbers = [trial.number for trial in search.next_trials({})]
    half = {numbers[0]: record(numbers[0])}
    assert [trial.number for trial in search.next_trials(half)] == numbers[1:]


@pytest.mark.slow
def test_a_threshold_over_directions_has_a_report_and_pictures(tmp_path):
    campaign = Campaign(
        scenario=Scenario(pushes=[PlannedPush(time=1.0)]),
        threshold=Threshold("pushes[0].impulse", 0.0, 40.0, 10.0, 2, 2),
        cases={"pushes[0].direction": [0.0, 1.57, 3.14, 4.71]},
        metrics=["tilt"],
    ).validate()
    folder = CampaignFolder(tmp_path)
    folder.begin(campaign, Sources())
    # Before the first trial there is little to tell, and no picture.
    text, written = write_results(folder)
    assert "0 trials" in text
    assert [path.name for path in written] == ["results.parquet", "report.md"]
    while trials := missing_trials(campaign, folder.records(), Shard()):
        for trial in trials:
            direction = trial.values["pushes[0].direction"]
            good = trial.values["pushes[0].impulse"] <= 15.0 + 5.0 * direction
            folder.write(
                record(trial.number, good, trial.seed, tilt=0.1)
                | {"values": trial.values, "error": None if good else "E: fell\n"}
            )
    text, written = write_results(folder)
    assert "| pushes[0].direction = 0 | 10 | 20 |" in text
    assert "| pushes[0].direction = 4.71 | 30 | 40 |" in text
    assert "| pushes[0].impulse = 20 |" in text
    assert "first in trial" in text
    assert {path.name for path in written} >= {"success_by_direction.png"}
    found = folder.campaign()
    assert found.threshold == campaign.threshold
    assert found.cases == campaign.cases
