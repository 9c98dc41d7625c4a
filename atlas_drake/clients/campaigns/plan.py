"""The trials of a campaign: seed and values of each, and the search for a threshold.

The campaign and the number of a trial determine seed and values. The records of earlier
trials alone determine the next ones of a search, so that a stopped one can continue.
"""

from __future__ import annotations

import itertools
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake.clients.campaigns.campaign import PARAMETERS, Campaign
from atlas_drake.clients.campaigns.distributions import draw
from atlas_drake.scenario import Scenario, with_values
from atlas_drake.scenario.scenario import LARGEST_SEED

Record = dict[str, Any]
"""The result of a trial."""
Records = dict[int, Record]
"""Records by the number of their trial."""


@dataclass(frozen=True)
class Trial:
    """One trial.

    Attributes:
        number: Number in the campaign, from 0.
        seed: Seed of the scenario and of the random values.
        values: Values that differ between trials, by path: the case, the random values,
            and the value of a threshold's search.
    """

    number: int
    seed: int
    values: dict[str, Any]

    def record(self, **result: Any) -> Record:
        """Returns the record of the trial with its result."""
        return {
            "trial": self.number,
            "seed": self.seed,
            "values": self.values,
            "success": False,
            "missed": [],
            "figures": {},
            "error": None,
            **result,
        }


def case_list(campaign: Campaign) -> list[dict[str, Any]]:
    """Returns every combination of the cases' values; one empty case without any.

    In the order of the paths' names: the file in a campaign's folder keeps no other.
    """
    paths = sorted(campaign.cases)
    combinations = itertools.product(*(campaign.cases[path] for path in paths))
    return [dict(zip(paths, values, strict=True)) for values in combinations]


def number_of_trials(campaign: Campaign) -> int | None:
    """Returns the number of all trials; None for a threshold, where results decide."""
    if campaign.threshold is not None:
        return None
    return campaign.trials * len(case_list(campaign))


def missing_trials(campaign: Campaign, records: Records) -> list[Trial]:
    """Returns the next trials: all that are missing, or a round of the searches."""
    count = number_of_trials(campaign)
    if count is None:
        cases = range(len(case_list(campaign)))
        searches = [Search(campaign, case, records) for case in cases]
        return [trial for search in searches for trial in search.next_trials]
    return [make_trial(campaign, n) for n in range(count) if n not in records]


def trial_seed(campaign: Campaign, replica: int) -> int:
    """Returns the seed of the trials with this number within their case."""
    if campaign.seeds == "counted":
        return (campaign.seed + replica) % (LARGEST_SEED + 1)
    sequence = np.random.SeedSequence(campaign.seed, spawn_key=(replica,))
    return int(sequence.generate_state(1, np.uint64)[0])


def make_trial(campaign: Campaign, number: int) -> Trial:
    """Makes the trial with this number.

    Numbers count cases first, then replicas, then levels of a threshold. The numbers of
    existing trials therefore stay the same when trials are added.
    """
    cases, threshold = case_list(campaign), campaign.threshold
    replica, case = divmod(number, len(cases))
    level = 0
    if threshold is not None:
        level, replica = divmod(replica, threshold.replicas)
    seed = trial_seed(campaign, replica)
    values = dict(cases[case])
    for path, distribution in campaign.vary.items():
        if path in values:
            continue
        # Each path has its own stream, so that other paths do not change its values.
        stream = np.random.SeedSequence(seed, spawn_key=(zlib.crc32(path.encode()),))
        values[path] = draw(distribution, np.random.default_rng(stream))
    if threshold is not None:
        values[threshold.of] = threshold.value(level)
    return Trial(number, seed, values)


def scenario_of(campaign: Campaign, trial: Trial) -> Scenario:
    """Makes the scenario of a trial."""
    values = {k: v for k, v in trial.values.items() if not k.startswith(PARAMETERS)}
    return with_values(campaign.scenario, {**values, "seed": trial.seed})


def parameters_of(campaign: Campaign, trial: Trial) -> dict[str, Any]:
    """Returns the parameters of the trial function."""
    drawn = {
        path.removeprefix(PARAMETERS): value
        for path, value in trial.values.items()
        if path.startswith(PARAMETERS)
    }
    return {**campaign.parameters, **drawn}


class Search:
    """The search for the threshold of one case, as far as the records go.

    Attributes:
        case: Values of the case by path.
        passed: Largest value under which enough trials succeeded.
        failed: Smallest value under which they did not; None if there is none so far.
        next_trials: Trials to run next; empty when the search is over.
    """

    def __init__(self, campaign: Campaign, case: int, records: Records) -> None:
        """Goes through the levels in the order of the search."""
        threshold, cases = campaign.threshold, case_list(campaign)
        assert threshold is not None
        self.case, top = cases[case], threshold.levels + 1
        passed, failed = 0, top
        asked: list[int] = []
        while failed - passed > 1 and not asked:
            climb = threshold.search == "climb"
            level = passed + 1 if climb else (passed + failed) // 2
            first = level * threshold.replicas
            # See make_trial.
            numbers = [
                (first + r) * len(cases) + case for r in range(threshold.replicas)
            ]
            done = [bool(records[n]["success"]) for n in numbers if n in records]
            if sum(done) >= threshold.passes:
                passed = level
            elif len(done) - sum(done) > threshold.replicas - threshold.passes:
                failed = level
            else:
                # As many replicas as must succeed, and the others if these differ.
                missing = [n for n in numbers if n not in records]
                few = numbers[: threshold.passes]
                asked = [n for n in missing if n in few] or missing
        self.passed = threshold.value(passed)
        self.failed = None if failed == top else threshold.value(failed)
        self.next_trials = [make_trial(campaign, number) for number in asked]
