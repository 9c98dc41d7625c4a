"""Runs the missing trials of a campaign, on this machine or on a cluster.

Results do not depend on the number of processes or machines.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import as_completed
from pathlib import Path

from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.children import Work, local_threads
from atlas_drake.campaigns.cluster import cluster_workers
from atlas_drake.campaigns.plan import Record, Records, missing_trials
from atlas_drake.campaigns.report import check_packages
from atlas_drake.campaigns.results import Results
from atlas_drake.campaigns.trial_runner import TrialRunner
from atlas_drake.errors import AtlasError, ScenarioError


def run_campaign(
    campaign: Campaign,
    out: str | Path,
    *,
    jobs: int = 1,
    cluster: str | None = None,
    on_trial: Callable[[Record, int, int], None] | None = None,
) -> Records:
    """Runs all trials of a campaign that are missing.

    If a campaign was stopped in any way, another call with the same folder continues
    it: no trial that is in the folder runs again.

    Args:
        campaign: The campaign.
        out: Folder of the results.
        jobs: Child processes at a time, without a cluster.
        cluster: Address of a Dask scheduler, such as ``tcp://HOST:8786``; None runs on
            this machine.
        on_trial: Called after each trial with its record, the number of finished
            trials, and the number of all trials known so far.

    Returns:
        Records by the number of their trial, with those of earlier calls.

    Raises:
        ScenarioError: If the campaign cannot be run, or the folder holds another.
        OSError: If the folder cannot be written; the records in it stay.
    """
    campaign = campaign.validate()
    if jobs < 1:
        raise ScenarioError.about("--jobs", jobs, "must be 1 or more")
    check_packages()
    TrialRunner(campaign)  # Finds every function, or names one that is missing.
    workers = local_threads(jobs)
    if cluster is not None:
        workers = cluster_workers(cluster, campaign)
    work = Work.of(campaign)
    with Results(Path(out), campaign) as results, workers as submit:
        while missing := missing_trials(campaign, results.records):
            futures = [submit(work, trial) for trial in missing]
            total = len(results.records) + len(missing)
            for future in as_completed(futures):
                try:
                    line = future.result()
                except AtlasError:
                    raise
                except Exception as error:
                    if cluster is None:
                        raise
                    problem = f"{error!r}; the same command goes on from there"
                    raise ScenarioError("--cluster", cluster, problem) from error
                record = results.add(line)
                if on_trial is not None:
                    on_trial(record, len(results.records), total)
    return results.records
