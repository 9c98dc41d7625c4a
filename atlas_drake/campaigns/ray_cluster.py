"""Calls a function with many items on the machines of a Ray cluster.

Needs ``ray``. Each call runs as on one machine, in a process of ``Processes``: errors,
deaths and the time limit have the same outcome. Calls that are lost with a machine
are repeated on another one.
"""

from __future__ import annotations

import itertools
import secrets
import socket
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.campaigns.processes import Outcome, Processes

IN_HAND = 2
"""Calls in hand for each processor of the cluster: one runs, the next waits."""
CONNECT_WITHIN = 5.0
"""Time for the cluster's first machine to answer [s]."""

_kept: dict[str, Processes] = {}
"""In each of Ray's workers: the process of the current run, by the run's token."""


class RayCluster:
    """Processors of a cluster that call one function until ``close``."""

    def __init__(
        self,
        function: Callable[[Any], Any],
        limit: float,
        address: str,
        jobs: int | None = None,
    ) -> None:
        """Connects to the cluster.

        Args:
            function: As for ``run_in_processes``; this package and the modules of the
                function must be installed on all machines of the cluster.
            limit: Wall time after which a call is ended and fails [s]; 0 for no limit.
            address: Address for ``ray.init``, such as ``auto`` or ``HOST:PORT``.
            jobs: Calls at a time; None for one per processor of the cluster.

        Raises:
            CampaignError: If ray is not installed, or there is no such cluster.
        """
        self._ray = _connected(address)
        self._jobs = jobs
        pickled = self._ray.cloudpickle.dumps(function)
        self._run = (secrets.token_hex(8), pickled, limit)
        self._running: dict[Any, Any] = {}

    def calls(self, items: Iterable[Any]) -> Iterator[Outcome]:
        """Calls the function with each item, each on one processor.

        Yields:
            Outcomes in the order in which the calls end.
        """
        ray, waiting = self._ray, iter(items)
        call = ray.remote(num_cpus=1, max_retries=-1)(_call)
        while True:
            cpus = int(ray.cluster_resources().get("CPU", 1))
            most = self._jobs or IN_HAND * max(cpus, 1)
            # A cluster that has lost a machine can have more calls in hand.
            for item in itertools.islice(waiting, max(0, most - len(self._running))):
                self._running[call.remote(*self._run, item)] = item
            if not self._running:
                return
            ended, _ = ray.wait(list(self._running), num_returns=1)
            for reference in ended:
                item = self._running.pop(reference)
                try:
                    yield ray.get(reference)
                except ray.exceptions.RayError as error:
                    yield Outcome(item, None, str(error))

    def close(self) -> None:
        """Ends the calls that still run, and leaves the cluster."""
        for reference in self._running:
            self._ray.cancel(reference, force=True)
        self._running.clear()


def _call(token: str, pickled: bytes, limit: float, item: Any) -> Outcome:
    """Calls the function on this machine of the cluster."""
    if token not in _kept:
        while _kept:
            _kept.popitem()[1].close()
        _kept[token] = Processes(pickled, 1, limit)
    (outcome,) = _kept[token].calls([item])
    return outcome


def _connected(address: str) -> Any:
    """Returns the module ``ray``, connected to the cluster."""
    try:
        import ray
    except ImportError:
        raise CampaignError(
            "--ray", address, 'needs ray: pip install "atlas-drake[ray]"'
        ) from None
    if not ray.is_initialized():
        try:
            _reach(address)
            ray.init(address=address, log_to_driver=False)
        except (OSError, ValueError, RuntimeError) as error:
            problem = f"there is no Ray cluster at {address}: {error}"
            raise CampaignError("--ray", address, problem) from error
    return ray


def _reach(address: str) -> None:
    """Checks that the machine answers; Ray itself would try for minutes.

    Raises:
        OSError: If nothing listens there.
    """
    host, _, port = address.rpartition(":")
    if host and port.isdecimal() and "/" not in host:
        socket.create_connection((host, int(port)), CONNECT_WITHIN).close()
