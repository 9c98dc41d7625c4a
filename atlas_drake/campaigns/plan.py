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

from atlas_drake.campaigns.campaign import PARAMETERS, Campaign
from atlas_drake.campaigns.distributions import draw
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
        searches = [Search(campaign, case) for case in range(len(case_list(campaign)))]
        return [trial for search in searches for trial in search.next_trials(records)]
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


@dataclass(frozen=True)
class Found:
    """The state of the search of one case."""

    case: dict[str, Any]
    """Values of the case by path."""
    passed: float
    """Largest value under which enough trials succeeded."""
    failed: float | None
    """Smallest value under which they did not; None if there is none so far."""
    ended: bool


class Search:
    """The search for the threshold of one case."""

    def __init__(self, campaign: Campaign, case: int) -> None:
        """Searches in the case with this number."""
        assert campaign.threshold is not None
        self._campaign, self._case = campaign, case
        self._threshold = campaign.threshold
        self._cases = case_list(campaign)

    def next_trials(self, records: Records) -> list[Trial]:
        """Returns the trials to run next; empty when the search is over.

        The first round has as many replicas as must succeed; a second round has the
        others, if the first does not decide.
        """
        level = self._state(records)[2]
        if level is None:
            return []
        numbers = self._numbers(level)
        for needed in (numbers[: self._threshold.passes], numbers):
            missing = [number for number in needed if number not in records]
            if missing:
                break
        return [make_trial(self._campaign, number) for number in missing]

    def found(self, records: Records) -> Found:
        """Returns the state of the search after these records."""
        passed, failed, level = self._state(records)
        upper = None if failed is None else self._threshold.value(failed)
        lower = self._threshold.value(passed)
        return Found(self._cases[self._case], lower, upper, level is None)

    def _state(self, records: Records) -> tuple[int, int | None, int | None]:
        """Returns the levels passed and failed, and the level to try next."""
        passed, failed = 0, None
        while True:
            above = self._threshold.levels + 1 if failed is None else failed
            if above - passed <= 1:
                return passed, failed, None
            if self._threshold.search == "climb":
                level = passed + 1
            else:
                level = (passed + above) // 2
            verdict = self._verdict(level, records)
            if verdict is None:
                return passed, failed, level
            if verdict:
                passed = level
            else:
                failed = level

    def _verdict(self, level: int, records: Records) -> bool | None:
        """Returns whether a level passes; None if missing trials still decide."""
        threshold = self._threshold
        done = [records[n] for n in self._numbers(level) if n in records]
        passes = sum(bool(record["success"]) for record in done)
        if passes >= threshold.passes:
            return True
        if len(done) - passes > threshold.replicas - threshold.passes:
            return False
        return None

    def _numbers(self, level: int) -> list[int]:
        """Returns the numbers of the trials of a level, see ``make_trial``."""
        replicas, cases = self._threshold.replicas, len(self._cases)
        first = level * replicas
        return [(first + r) * cases + self._case for r in range(replicas)]
