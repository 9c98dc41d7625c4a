"""Which trials a campaign has, and what each is drawn from.

Everything follows from the campaign and the number of the trial; for a threshold also
from the results before it, see ``threshold``.
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
        number: In the campaign, from 0.
        seed: Of the scenario, and of what is drawn for it.
        values: Everything that differs between trials, by path: the case, what was
            drawn, and the value that a threshold is searched for.
    """

    number: int
    seed: int
    values: dict[str, Any]


def case_list(campaign: Campaign) -> list[dict[str, Any]]:
    """Every combination of the cases' values; one empty case where there are none."""
    combinations = itertools.product(*campaign.cases.values())
    return [dict(zip(campaign.cases, values, strict=True)) for values in combinations]


def number_of_trials(campaign: Campaign, trials: int | None = None) -> int | None:
    """How many trials there are in all; None for a threshold, whose results decide.

    Args:
        campaign: The campaign.
        trials: How many, of each case; None is the campaign's number.
    """
    if campaign.threshold is not None:
        return None
    return (campaign.trials if trials is None else trials) * len(case_list(campaign))


def trial_seed(campaign: Campaign, replica: int) -> int:
    """The seed of the trials with this number within their case."""
    if campaign.seeds == "counted":
        return (campaign.seed + replica) % (LARGEST_SEED + 1)
    sequence = np.random.SeedSequence(campaign.seed, spawn_key=(replica,))
    return int(sequence.generate_state(1, np.uint64)[0])


def make_trial(campaign: Campaign, number: int, level: int | None = None) -> Trial:
    """The trial of this number.

    Numbers go through the cases first, so that more trials leave them as they are; in
    a threshold then through the replicas, and then through the levels.

    Args:
        campaign: The campaign.
        number: Of the trial.
        level: Of a threshold's grid; None without threshold.
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
        # A stream for each path: what else varies changes nothing.
        stream = np.random.SeedSequence(seed, spawn_key=(zlib.crc32(path.encode()),))
        values[path] = draw(distribution, np.random.default_rng(stream))
    if campaign.threshold is not None and level is not None:
        values[campaign.threshold.of] = campaign.threshold.value(level)
    return Trial(number, seed, values)


def scenario_of(campaign: Campaign, trial: Trial) -> Scenario:
    """The scenario of a trial.

    Raises:
        ScenarioError: If what was drawn is not allowed.
    """
    values = {k: v for k, v in trial.values.items() if not k.startswith(PARAMETERS)}
    try:
        return with_values(campaign.scenario, {**values, "seed": trial.seed})
    except ScenarioError as error:
        problem = f"{error.problem} (drawn for trial {trial.number})"
        raise ScenarioError(error.field, error.value, problem) from None


def parameters_of(campaign: Campaign, trial: Trial) -> dict[str, Any]:
    """What the trial function is given."""
    drawn = {
        path.removeprefix(PARAMETERS): value
        for path, value in trial.values.items()
        if path.startswith(PARAMETERS)
    }
    return {**campaign.parameters, **drawn}
