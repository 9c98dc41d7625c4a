"""Runs the missing trials of a campaign, on this machine or a cluster.

Results do not depend on the number of processes or machines.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.campaigns.folder import CampaignFolder
from atlas_drake.campaigns.plan import Trial, case_list, make_trial, number_of_trials
from atlas_drake.campaigns.processes import Outcome, Processes
from atlas_drake.campaigns.sources import Sources, joined
from atlas_drake.campaigns.threshold import Search
from atlas_drake.campaigns.trial_runner import TrialRunner, failed
from atlas_drake.errors import shown

if TYPE_CHECKING:
    from atlas_drake.campaigns.ray_cluster import RayCluster

Records = dict[int, dict[str, Any]]


@dataclass(frozen=True)
class Shard:
    """A part of a campaign's trials.

    Attributes:
        index: Number of the part, from 1.
        count: Number of parts.
    """

    index: int = 1
    count: int = 1

    def __post_init__(self) -> None:
        """Check the numbers.

        Raises:
            CampaignError: If there is no such part.
        """
        if not 1 <= self.index <= self.count:
            raise CampaignError(
                "--shard", str(self), f"is {self}; must be from 1/n to n/n"
            )

    def __str__(self) -> str:
        """Return the form of the command line, such as ``1/4``."""
        return f"{self.index}/{self.count}"

    def has(self, number: int) -> bool:
        """Return True if a number from 0 belongs to the part."""
        return number % self.count == self.index - 1


def run_campaign(
    campaign: Campaign,
    out: str | Path,
    *,
    trials: int | None = None,
    jobs: int = 1,
    ray: str | None = None,
    shard: Shard | None = None,
    files: Iterable[str | Path] = (),
    functions: Mapping[str, Callable[..., Any]] | None = None,
    parts: Mapping[str, Any] | None = None,
    on_trial: Callable[[dict[str, Any], int, int], None] | None = None,
) -> Records:
    """Runs all trials of a campaign that are missing.

    If a campaign was stopped in any way, another call with the same folder continues
    it: no trial runs twice.

    Args:
        campaign: The campaign.
        out: Folder of the results.
        trials: Number of trials of each case; None for the campaign's number.
        jobs: Processes at a time; with ``ray``, calls at a time, and 0 for as many as
            the cluster has processors.
        ray: Address of a Ray cluster to run on; None runs on this machine.
        shard: Part to run; None for all trials.
        files: Python files with functions and parts, beside the campaign's ``code``.
        functions: Functions that the campaign names, from a module that other processes
            can import.
        parts: Arguments of ``AtlasSimulation``, from such a module.
        on_trial: Called after each trial with its record, the number of finished
            trials, and the number of all trials known so far.

    Returns:
        Records by the number of their trial, with those of earlier calls.

    Raises:
        ScenarioError: If the campaign cannot be run, or the folder holds another.
    """
    campaign = campaign.validate()
    if jobs < (0 if ray is not None else 1):
        raise CampaignError("--jobs", jobs, f"is {shown(jobs)}; must be 1 or more")
    if trials is not None:
        if trials < 1:
            problem = f"is {shown(trials)}; must be 1 or more"
            raise CampaignError("--trials", trials, problem)
        campaign = replace(campaign, trials=trials)
    shard = shard or Shard()
    sources = Sources(joined(campaign.code, files), functions or {}, parts or {})
    trial_runner = TrialRunner(campaign, sources)
    folder = CampaignFolder(Path(out))
    folder.begin(campaign, sources)
    with (
        folder.only_one(str(shard).replace("/", "-of-")),
        closing(_workers(trial_runner, campaign.trial_timeout, jobs, ray)) as workers,
    ):
        records = folder.records()
        while missing := missing_trials(campaign, records, shard):
            left = len(missing)
            for outcome in workers.calls(missing):
                record = _record(outcome)
                folder.write(record)
                records[record["trial"]] = record
                left -= 1
                if on_trial is not None:
                    on_trial(record, len(records), len(records) + left)
    return records


def missing_trials(campaign: Campaign, records: Records, shard: Shard) -> list[Trial]:
    """Returns the next trials: all that are missing, or a round of the searches."""
    count = number_of_trials(campaign)
    if count is None:
        cases = len(case_list(campaign))
        searches = [Search(campaign, c) for c in range(cases) if shard.has(c)]
        return [trial for search in searches for trial in search.next_trials(records)]
    return [
        make_trial(campaign, number)
        for number in range(count)
        if shard.has(number) and number not in records
    ]


def _workers(
    trial_runner: TrialRunner, limit: float, jobs: int, ray: str | None
) -> Processes | RayCluster:
    """Returns what runs trials: processes, or a cluster."""
    if ray is None:
        return Processes(pickle.dumps(trial_runner), jobs, limit)
    # Ray loads only if it is used.
    from atlas_drake.campaigns.ray_cluster import RayCluster

    return RayCluster(trial_runner, limit, ray, jobs or None)


def _record(outcome: Outcome) -> dict[str, Any]:
    if outcome.error is None:
        record: dict[str, Any] = outcome.result
        return record
    trial: Trial = outcome.item
    record = {"trial": trial.number, "seed": trial.seed, "values": trial.values}
    return record | failed(outcome.error)
