"""Runs a trial in a child process, whatever the trial does to the process.

One machine and the workers of a cluster call the same function, ``run_trial``. Each
thread that calls it keeps a pebble pool of one child, and the child keeps the
simulations that it has built. A child of its own for each thread means that no child
can die with a lock that another one waits for.
"""

from __future__ import annotations

import faulthandler
import functools
import json
import multiprocessing
import os
import pickle
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
from typing import Any

from threadpoolctl import threadpool_limits

from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.plan import Record, Trial
from atlas_drake.campaigns.trial_runner import TrialRunner
from atlas_drake.config import as_plain, checked

STARTS = 2
"""When so many children die in a trial, the trial is the cause."""
GRACE = 0.5
"""Time after the limit for the child to write where it is [s]."""


@dataclass(frozen=True)
class Work:
    """What a child needs to know of a campaign; can be pickled.

    Attributes:
        campaign: The campaign's fields, pickled: Drake's configurations cannot be.
        limit: Wall time after which a trial is ended and has failed [s]; 0 for none.
        folder: Folder of the campaign's ``code``; None if the files have its paths.
    """

    campaign: bytes
    limit: float
    folder: str | None = None

    @classmethod
    def of(cls, campaign: Campaign) -> Work:
        """Packs a campaign."""
        return cls(pickle.dumps(as_plain(campaign)), campaign.trial_timeout)


Submit = Callable[[Work, Trial], Future[bytes]]
"""Starts a trial elsewhere, which becomes the line of its record."""


def as_line(record: Record) -> bytes:
    """Returns a record as JSON, with ``?`` for what no file can hold."""
    text = json.dumps(record, ensure_ascii=False, default=str)
    return text.encode(errors="replace")


# ---- in the parent -----------------------------------------------------------


class _OneChild(SpawnContext):
    """A context of one process: a pool ends with its child, however the child ends.

    Of itself pebble replaces a child, and after an ``os._exit(0)`` waits for ever.
    """

    child: Any = None

    def Process(self, *given: Any, **named: Any) -> Any:  # type: ignore[override]
        """Makes the process, once."""
        if self.child is not None:
            raise OSError("the child has ended")
        self.child = super().Process(*given, **named)
        return self.child


class _Child:
    """A child process that runs the trials of one campaign."""

    def __init__(self, work: Work) -> None:
        from pebble import ProcessPool  # Of the extra `sweep`.

        self.work = work
        self._context = _OneChild()
        # The child removes the file: even if both are killed, nothing remains.
        number, path = tempfile.mkstemp(prefix="atlas_drake_")
        self._trace = os.fdopen(number, errors="replace")
        self._pool = ProcessPool(
            1, initializer=_begin, initargs=[path], context=self._context
        )
        self._running: Any = None

    def run(self, trial: Trial) -> bytes:
        """Returns the line of the trial's record.

        Raises:
            TimeoutError: If the trial took too long.
            ProcessExpired, BrokenProcessPool: If the child died.
            CancelledError: If ``stop`` was called.
        """
        limit = self.work.limit
        self._running = self._pool.schedule(
            _call, args=[self.work, trial], timeout=limit + GRACE if limit else None
        )
        line: bytes = self._running.result()
        return line

    def stop(self) -> str:
        """Ends the process, whatever it does; returns where it was if it had failed."""
        if self._running is not None:
            self._running.cancel()
        self._pool.stop()
        self._pool.join()
        with self._trace:
            return self._trace.read()

    @property
    def exit_code(self) -> int | None:
        """Exit status of the process, or minus the number of the signal."""
        code: int | None = self._context.child.exitcode
        return code


_children: dict[threading.Thread, _Child] | None = {}
"""The child of each thread that calls ``run_trial``; None while they are ended."""
_lock = threading.Lock()
"""Guards ``_children``."""


def run_trial(work: Work, trial: Trial) -> bytes:
    """Runs a trial in the child of this thread; returns the line of its record."""
    from pebble import ProcessExpired

    why = ""
    for _ in range(STARTS):
        child = _child_for(work)
        try:
            return child.run(trial)
        except TimeoutError:
            why = f"{_bury(child)}took longer than {work.limit:g} s"
            break
        except (ProcessExpired, BrokenProcessPool):
            why = f"{_bury(child)}the process died ({child.exit_code})"
    return as_line(trial.record(error=why))


def _child_for(work: Work) -> _Child:
    """Returns the child of this thread, or a new one for another campaign."""
    thread, old = threading.current_thread(), None
    with _lock:
        if _children is None:
            raise CancelledError
        child = _children.get(thread)
        if child is None or child.work != work:
            old, child = child, _Child(work)
            _children[thread] = child
    if old is not None:
        old.stop()
    return child


def _bury(child: _Child) -> str:
    """Removes a dead child; returns where it was when it died."""
    with _lock:
        if _children is None:
            raise CancelledError
        del _children[threading.current_thread()]
    return child.stop()


@contextmanager
def local_threads(jobs: int) -> Iterator[Submit]:
    """Yields what runs trials on this machine; the children end with it."""
    global _children  # noqa: PLW0603
    # Ctrl-C reaches all processes of a terminal, but only the main one may act on it:
    # a child inherits the blocked signal of the thread that starts it. Starting the
    # tracker there would unblock it.
    resource_tracker.ensure_running()
    block = (signal.SIG_BLOCK, {signal.SIGINT})
    threads = ThreadPoolExecutor(jobs, "trial", signal.pthread_sigmask, block)
    try:
        yield lambda work, trial: threads.submit(run_trial, work, trial)
    finally:
        with _lock:
            children, _children = _children or {}, None
        threads.shutdown(wait=False, cancel_futures=True)
        for child in children.values():
            child.stop()
        threads.shutdown()
        _children = {}


# ---- in the child ------------------------------------------------------------

_trace: int
"""File for where the child was when it crashed, or at its time limit."""


def _begin(trace: str) -> None:
    """Prepares the child."""
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
