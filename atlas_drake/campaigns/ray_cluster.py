"""A function called with many items on the machines of a Ray cluster.

As ``processes`` does it on this one. Needs ``ray``. A machine that is lost takes no
item with it: Ray calls again, elsewhere.
"""

from __future__ import annotations

import itertools
import secrets
import socket
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.campaigns.processes import ONE_THREAD, Outcome

IN_HAND = 2
"""Calls in hand for each processor of the cluster: while one runs, the next waits."""
CONNECT_WITHIN = 5.0
"""Time for the cluster's first machine to answer [s]."""

_kept: dict[str, Callable[[Any], Any]] = {}
"""The function of a run, by the run's token, in each process of the cluster: Ray would
send it anew with each call, without what it keeps."""


class RayCluster:
    """Processors of a cluster that call one function; they are left with ``close``."""

    def __init__(
        self, function: Callable[[Any], Any], address: str, jobs: int | None = None
    ) -> None:
        """Connects to the cluster.

        Args:
            function: As for ``Processes``; this package must be installed on all
                machines of the cluster, and so must the modules of the function.
            address: Of the cluster, as ``ray.init`` takes it: ``auto``, ``HOST:PORT``.
            jobs: Calls at a time; None is as many as the cluster has processors.

        Raises:
            CampaignError: If ray is not installed, or there is no such cluster.
        """
        self._ray = _connected(address)
        self._jobs = jobs
        self._token = secrets.token_hex(8)
        self._function = self._ray.put(function)
        self._running: dict[Any, Any] = {}

    def calls(self, items: Iterable[Any]) -> Iterator[Outcome]:
        """Calls the function with each item, each on one processor.

        Args:
            items: Arguments, one per call.

        Yields:
            Outcomes in the order in which the calls end.
        """
        ray, running, waiting = self._ray, self._running, iter(items)
        call = ray.remote(num_cpus=1, max_retries=-1)(_call)
        while True:
            cpus = int(ray.cluster_resources().get("CPU", 1))
            most = self._jobs or IN_HAND * max(cpus, 1)
            # A cluster that has lost a machine has more calls in hand than it may.
            for item in itertools.islice(waiting, max(0, most - len(running))):
                running[call.remote(self._token, self._function, item)] = item
            if not running:
                return
            ended, _ = ray.wait(list(running), num_returns=1)
            for reference in ended:
                item = running.pop(reference)
                try:
                    yield Outcome(item, ray.get(reference))
                except ray.exceptions.RayError as error:
                    yield Outcome(item, None, str(error))

    def close(self) -> None:
        """Ends the calls that still run, and leaves the cluster."""
        for reference in self._running:
            self._ray.cancel(reference, force=True)
        self._running.clear()


def _call(token: str, function: Callable[[Any], Any], item: Any) -> Any:
    """In a process of the cluster."""
    return _kept.setdefault(token, function)(item)


def _connected(address: str) -> Any:
    """The module, connected to the cluster."""
    try:
        import ray
    except ImportError:
        raise CampaignError(
            "--ray", address, 'needs ray: pip install "atlas-drake[ray]"'
        ) from None
    if not ray.is_initialized():
        try:
            _reach(address)
            ray.init(
                address=address,
                log_to_driver=False,
                runtime_env={"env_vars": dict.fromkeys(ONE_THREAD, "1")},
            )
        except (OSError, ValueError, RuntimeError) as error:
            problem = f"there is no Ray cluster at {address}: {error}"
            raise CampaignError("--ray", address, problem) from error
    return ray


def _reach(address: str) -> None:
    """Misses a machine at once, for which Ray looks for minutes.

    Raises:
        OSError: If nothing listens there.
    """
    host, _, port = address.rpartition(":")
    if host and port.isdecimal() and "/" not in host:
        socket.create_connection((host, int(port)), CONNECT_WITHIN).close()
