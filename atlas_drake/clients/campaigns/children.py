"""Runs trials in child processes, whatever a trial does to its process.

One machine and the workers of a cluster use the same ``Child``: a pebble pool of one
process, which keeps the simulations that it has built. As no two children share a pool,
none can die with a lock that another one waits for.
"""

from __future__ import annotations

import faulthandler
import functools
import multiprocessing
import os
import pickle
import secrets
import signal
import tempfile
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing import resource_tracker
from multiprocessing.connection import wait
from multiprocessing.context import SpawnContext
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from pebble import ProcessExpired, ProcessPool
from threadpoolctl import threadpool_limits

from atlas_drake.clients.campaigns.campaign import Campaign
from atlas_drake.clients.campaigns.plan import Trial
from atlas_drake.clients.campaigns.results import as_line
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.config import as_plain, checked

STARTS = 2
"""When so many processes die in a trial, the trial is the cause."""
GRACE = 0.5
"""Time after the limit for the child to write where it is [s]."""

Submit = Callable[[Trial], Future[bytes]]
"""Starts a trial elsewhere; the result is the line of its record."""


@dataclass(frozen=True)
class Work:
    """What a child needs to know of a campaign; can be pickled.

    Attributes:
        campaign: The campaign's fields, pickled: Drake's configurations cannot be.
        limit: Wall time after which a trial is ended and has failed [s]; 0 for none.
        run: Name of the run: in the next one the user's files may have changed.
        folder: Folder of the campaign's ``code``; None if the files have its paths.
    """

    campaign: bytes
    limit: float
    run: str
    folder: str | None = None

    @classmethod
    def of(cls, campaign: Campaign) -> Work:
        """Packs a campaign."""
        fields = pickle.dumps(as_plain(campaign))
        return cls(fields, campaign.trial_timeout, secrets.token_hex(8))


# ---- in the parent -----------------------------------------------------------


class _OneProcess(SpawnContext):
    """A context of one process, with which a pool ends when its process does.

    Of itself pebble replaces the process, and after an ``os._exit(0)`` waits for ever.
    """

    process: Any = None

    def Process(self, *given: Any, **named: Any) -> Any:  # type: ignore[override]
        """Makes the process, once."""
        if self.process is not None:
            raise OSError("the process has ended")
        self.process = super().Process(*given, **named)
        return self.process


class _Pool(ProcessPool):
    """A pool of one process, and the file for where the process was when it failed."""

    def __init__(self) -> None:
        # The child removes the file: even if both are killed, nothing remains.
        number, path = tempfile.mkstemp(prefix="atlas_drake_")
        self.trace = os.fdopen(number, errors="replace")
        self.context = _OneProcess()
        super().__init__(1, initializer=_begin, initargs=[path], context=self.context)

    def end(self) -> str:
        """Ends the process, whatever it does; returns where it was if it failed."""
        self.stop()
        self.join()
        with self.trace:
            return self.trace.read()


class Child:
    """A child process that runs the trials of a campaign; a dead one is replaced."""

    def __init__(self, work: Work) -> None:
        """Starts no process yet."""
        self.work = work
        self._lock = threading.Lock()
        self._pool: _Pool | None = None
        self._running: Any = None
        self._ended = False

    def run(self, trial: Trial) -> bytes:
        """Runs a trial; returns the line of its record."""
        limit, why = self.work.limit, ""
        for _ in range(STARTS):
            pool = self._start(trial)
            try:
                line: bytes = self._running.result()
            except TimeoutError:
                why = f"{self._bury()}took longer than {limit:g} s"
                break
            except (ProcessExpired, BrokenProcessPool):
                code = pool.context.process.exitcode
                why = f"{self._bury()}the process died ({code})"
            else:
                return line
        return as_line(trial.record(error=why))

    def _start(self, trial: Trial) -> _Pool:
        limit = self.work.limit + GRACE if self.work.limit else None
        with self._lock:
            if self._ended:
                raise CancelledError
            if self._pool is not None and not self._pool.active:  # Killed while idle.
                self._pool.end()
                self._pool = None
            self._pool = self._pool or _Pool()
            self._running = self._pool.schedule(_call, (self.work, trial), {}, limit)
            return self._pool

    def _bury(self) -> str:
        with self._lock:
            pool, self._pool = self._pool, None
        return pool.end() if pool is not None else ""

    def end(self) -> None:
        """Ends the process, whatever it does, for good."""
        with self._lock:
            self._ended = True
        if self._running is not None:
            self._running.cancel()
        self._bury()


@contextmanager
def local_children(work: Work, jobs: int) -> Iterator[Submit]:
    """Yields what runs trials in so many children of this process."""
    # Ctrl-C reaches all processes of a terminal, but only the main one may act on it:
    # a child inherits the blocked signal of the thread that starts it. Starting the
    # tracker there would unblock it.
    resource_tracker.ensure_running()
    block = (signal.SIG_BLOCK, {signal.SIGINT})
    threads = ThreadPoolExecutor(jobs, "trial", signal.pthread_sigmask, block)
    children = [Child(work) for _ in range(jobs)]
    idle: SimpleQueue[Child] = SimpleQueue()
    for child in children:
        idle.put(child)

    def run(trial: Trial) -> bytes:
        child = idle.get()
        try:
            return child.run(trial)
        finally:
            idle.put(child)

    try:
        yield lambda trial: threads.submit(run, trial)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        for child in children:
            child.end()
        threads.shutdown()


# ---- in the child ------------------------------------------------------------

_trace: int
"""File descriptor for where the process was when it crashed, or at its time limit."""


def _begin(trace: str) -> None:
    """Prepares the process."""
    global _trace  # noqa: PLW0603
    threading.Thread(target=_end_with_parent, daemon=True).start()
    threadpool_limits(1)
    _trace = os.open(trace, os.O_WRONLY)
    os.unlink(trace)
    faulthandler.enable(_trace)


def _end_with_parent() -> None:
    """Ends this process when its parent is gone, even by SIGKILL."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)


def _call(work: Work, trial: Trial) -> bytes:
    """Runs a trial; at the limit a thread that needs no Python writes where it is."""
    if work.limit:
        faulthandler.dump_traceback_later(work.limit, file=_trace)
    try:
        return as_line(_runner(work)(trial))
    except BaseException:
        return as_line(trial.record(error=traceback.format_exc()))
    finally:
        faulthandler.cancel_dump_traceback_later()


@functools.lru_cache(maxsize=1)
def _runner(work: Work) -> TrialRunner:
    campaign = checked(Campaign, pickle.loads(work.campaign))
    if work.folder is not None:
        code = [str(Path(work.folder, Path(file).name)) for file in campaign.code]
        campaign = replace(campaign, code=code)
    return TrialRunner(campaign)
