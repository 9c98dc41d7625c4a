"""The trials of a campaign: seed and values of each trial.

The campaign and the number of a trial determine both. In the search for a threshold the
next trials also depend on earlier results, see ``threshold``.
"""

from __future__ import annotations

import itertools
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from atlas_drake.campaigns.campaign import PARAMETERS, Campaign
from atlas_drake.campaigns.distributions import draw
from atlas_drake.errors import ScenarioError
from atlas_drake.scenario import Scenario, with_values
from atlas_drake.scenario.scenario import LARGEST_SEED


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


def case_list(campaign: Campaign) -> list[dict[str, Any]]:
    """Returns every combination of the cases' values; one empty case without any.

    In the order of the paths' names: the file in a campaign's folder keeps no other.
    """
    paths = sorted(campaign.cases)
    combinations = itertools.product(*(campaign.cases[path] for path in paths))
    return [dict(zip(paths, values, strict=True)) for values in combinations]


def number_of_trials(campaign: Campaign, trials: int | None = None) -> int | None:
    """Returns the number of all trials; None for a threshold, where results decide.

    ``trials`` is the number of each case; None is the campaign's.
    """
    if campaign.threshold is not None:
        return None
    return (campaign.trials if trials is None else trials) * len(case_list(campaign))


def trial_seed(campaign: Campaign, replica: int) -> int:
    """Returns the seed of the trials with this number within their case."""
    if campaign.seeds == "counted":
        return (campaign.seed + replica) % (LARGEST_SEED + 1)
    sequence = np.random.SeedSequence(campaign.seed, spawn_key=(replica,))
    return int(sequence.generate_state(1, np.uint64)[0])


def make_trial(campaign: Campaign, number: int, level: int | None = None) -> Trial:
    """Makes the trial with this number.

    Numbers count cases first, then replicas, then levels of a threshold. The numbers of
    existing trials therefore stay the same when trials are added. ``level`` is that in
    the grid of a threshold, None without threshold.
    """
    cases = case_list(campaign)
    replica, case = divmod(number, len(cases))
    if campaign.threshold is not None:
        replica %= campaign.threshold.replicas
    seed = trial_seed(campaign, replica)
    values = dict(cases[case])
    for path, distribution in campaign.vary.items():
        if path in values:
            continue
        # Each path has its own stream, so that other paths do not change its values.
        stream = np.random.SeedSequence(seed, spawn_key=(zlib.crc32(path.encode()),))
        values[path] = draw(distribution, np.random.default_rng(stream))
    if campaign.threshold is not None and level is not None:
        values[campaign.threshold.of] = campaign.threshold.value(level)
    return Trial(number, seed, values)


def scenario_of(campaign: Campaign, trial: Trial) -> Scenario:
    """Makes the scenario of a trial.

    Raises:
        ScenarioError: If a random value is not allowed.
    """
    values = {k: v for k, v in trial.values.items() if not k.startswith(PARAMETERS)}
    try:
        return with_values(campaign.scenario, {**values, "seed": trial.seed})
    except ScenarioError as error:
        problem = f"{error.problem} (drawn for trial {trial.number})"
        raise ScenarioError(error.field, error.value, problem) from None


def parameters_of(campaign: Campaign, trial: Trial) -> dict[str, Any]:
    """Returns the parameters of the trial function."""
    drawn = {
        path.removeprefix(PARAMETERS): value
        for path, value in trial.values.items()
        if path.startswith(PARAMETERS)
    }
    return {**campaign.parameters, **drawn}
