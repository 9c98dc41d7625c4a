"""Hands trials out to the workers of a Dask cluster.

Each worker runs a trial as one machine does, in a child of its own, so that no trial
ends a worker. Dask gives the trials of a worker or a machine that is lost to others.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.children import Submit, Work, run_trial
from atlas_drake.campaigns.plan import Trial
from atlas_drake.errors import ScenarioError

CONNECT_WITHIN = 10.0
"""Time for the scheduler to answer [s]."""


@contextmanager
def cluster_workers(address: str, campaign: Campaign) -> Iterator[Submit]:
    """Yields what runs trials on the workers, which have the files of the campaign.

    Raises:
        ScenarioError: If Dask is not installed, or no scheduler answers.
    """
    try:
        from distributed import Client  # Takes a second to load.
    except ImportError:
        problem = 'needs Dask: pip install "atlas-drake[cluster]"'
        raise ScenarioError("--cluster", address, problem) from None
    try:
        client = Client(address, timeout=CONNECT_WITHIN, set_as_default=False)
    except (OSError, ValueError) as error:
        problem = f"no Dask scheduler at {address}: {error}"
        raise ScenarioError("--cluster", address, problem) from error
    with client:
        for file in campaign.code:
            client.upload_file(file, load=False)
        executor = client.get_executor(pure=False)
        try:
            yield lambda work, trial: executor.submit(run_on_worker, work, trial)
        finally:
            executor.shutdown(wait=False)


def run_on_worker(work: Work, trial: Trial) -> bytes:
    """Runs a trial in a child of this worker; returns the line of its record.

    Raises:
        ScenarioError: If the worker may have no children.
    """
    from distributed import get_worker

    worker = get_worker()
    if multiprocessing.current_process().daemon:
        problem = "may have no child processes: start the workers with --no-nanny"
        raise ScenarioError("--cluster", worker.address, problem)
    return run_trial(replace(work, folder=worker.local_directory), trial)
