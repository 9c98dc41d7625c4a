"""Runs the missing trials of a campaign, on this machine or on a cluster.

Results do not depend on the number of processes or machines.
"""

from __future__ import annotations

import functools
import logging
import multiprocessing
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import as_completed
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from atlas_drake.clients.campaigns.campaign import Campaign
from atlas_drake.clients.campaigns.plan import Record, Records, Trial, missing_trials
from atlas_drake.clients.campaigns.results import Results
from atlas_drake.clients.campaigns.table import check_packages
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.errors import AtlasError, ScenarioError

if TYPE_CHECKING:
    from atlas_drake.clients.campaigns.children import Submit, Work

CONNECT_WITHIN = 10.0
"""Time for the scheduler of a cluster to answer [s]."""


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
    from atlas_drake.clients.campaigns.children import Work, local_children

    TrialRunner(campaign)  # Finds every function, or names one that is missing.
    workers = local_children(Work.of(campaign), jobs)
    if cluster is not None:
        workers = _cluster_workers(cluster, Work.of(campaign), campaign.code)
    with Results(Path(out), campaign) as results, workers as submit:
        while missing := missing_trials(campaign, results.records):
            futures = [submit(trial) for trial in missing]
            total = len(results.records) + len(missing)
            for future in as_completed(futures):
                try:
                    line = future.result()
                except AtlasError:
                    raise
                except Exception as error:
                    if cluster is None:
                        raise
                    problem = f"failed: {error!r}; the same command goes on from there"
                    raise ScenarioError("--cluster", cluster, problem) from error
                record = results.add(line)
                if on_trial is not None:
                    on_trial(record, len(results.records), total)
    return results.records


@contextmanager
def _cluster_workers(address: str, work: Work, code: list[str]) -> Iterator[Submit]:
    """Yields what runs trials on the workers of a Dask cluster.

    Dask gives the trials of a worker or a machine that is lost to others.
    """
    try:
        from distributed import Client  # Takes a second to load.
        from distributed.comm import get_address_host_port
    except ImportError:
        problem = 'needs Dask: pip install "atlas-drake[cluster]"'
        raise ScenarioError("--cluster", address, problem) from None
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # An error is raised.
    try:
        get_address_host_port(address, strict=True)  # The client would fail later.
        client = Client(address, timeout=CONNECT_WITHIN, set_as_default=False)
    except (OSError, ValueError) as error:
        problem = f"no Dask scheduler at {address}: {error}"
        raise ScenarioError("--cluster", address, problem) from error
    with client:
        for file in code:
            client.upload_file(file, load=False)
        executor = client.get_executor(pure=False)
        try:
            yield functools.partial(executor.submit, run_on_worker, work)
        finally:
            executor.shutdown(wait=False)


_own = threading.local()
"""In each thread of a worker: its ``child``."""


def run_on_worker(work: Work, trial: Trial) -> bytes:
    """Runs a trial in a child of this worker, so that no trial ends the worker."""
    from distributed import get_worker

    from atlas_drake.clients.campaigns.children import Child

    worker = get_worker()
    if multiprocessing.current_process().daemon:
        problem = "may have no child processes: start the workers with --no-nanny"
        raise ScenarioError("--cluster", worker.address, problem)
    work = replace(work, folder=worker.local_directory)
    child: Child | None = getattr(_own, "child", None)
    if child is None or child.work != work:
        if child is not None:
            child.end()
        child = _own.child = Child(work)
    return child.run(trial)
