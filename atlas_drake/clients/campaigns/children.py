"""Runs trials in child processes, whatever a trial does to its process.

One machine and the workers of a cluster use the same ``Child``, which keeps the
simulations that it has built.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import pickle
import secrets
import signal
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from threadpoolctl import threadpool_limits

from atlas_drake.clients.campaigns.campaign import Campaign
from atlas_drake.clients.campaigns.plan import Trial
from atlas_drake.clients.campaigns.results import as_line
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.config import as_plain, checked

STARTS = 2
"""When so many processes die in a trial, the trial is the cause."""
LOOK = 0.2
"""Time between two looks whether a process still lives [s]."""
_FRESH = multiprocessing.get_context("spawn")
"""Starts processes that share no lock and no memory with this one."""

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

    def runner(self) -> TrialRunner:
        """Unpacks the campaign, and finds its functions."""
        campaign = checked(Campaign, pickle.loads(self.campaign))
        if self.folder is not None:
            code = [str(Path(self.folder, Path(file).name)) for file in campaign.code]
            campaign = replace(campaign, code=code)
        return TrialRunner(campaign)


class Child:
    """A child process that runs the trials of a campaign; a dead one is replaced."""

    def __init__(self, work: Work) -> None:
        """Starts no process yet."""
        self.work = work
        self._lock = threading.Lock()
        self._process: Any = None
        self._pipe: Any = None
        self._is_ready = self._ended = False

    def run(self, trial: Trial) -> bytes:
        """Runs a trial; returns the line of its record.

        Raises:
            CancelledError: If the child has been ended.
        """
        why = ""
        for _ in range(STARTS):
            process, pipe = self._started()
            try:
                if not self._is_ready:  # What it loads is not the trial's time.
                    self._answers(process, pipe, math.inf)
                    self._is_ready = bool(pipe.recv())
                pipe.send(trial)
                if self._answers(process, pipe, self.work.limit or math.inf):
                    line: bytes = pipe.recv_bytes()
                    return line
            except (EOFError, OSError):
                why = f"the process died ({self._kill()})"
            else:
                self._kill()
                why = f"took longer than {self.work.limit:g} s"
                break
        return as_line(trial.record(error=why))

    def _started(self) -> tuple[Any, Any]:
        """Returns the process, which runs from now on, and this end of its pipe."""
        with self._lock:
            if self._ended:
                raise CancelledError
            if self._process is None:
                pipe, theirs = _FRESH.Pipe()
                arguments = (theirs, self.work)
                process = _FRESH.Process(target=_serve, args=arguments, daemon=True)
                process.start()
                theirs.close()
                self._process, self._pipe, self._is_ready = process, pipe, False
            return self._process, self._pipe

    def _answers(self, process: Any, pipe: Any, limit: float) -> bool:
        """Waits for an answer; returns False if there is none within ``limit`` [s].

        Raises:
            EOFError: If the process has ended. Its pipe may be open in processes that
                a trial has started.
        """
        end = time.monotonic() + limit
        while not pipe.poll(min(LOOK, max(end - time.monotonic(), 0.0))):
            if process.exitcode is not None and not pipe.poll(0.0):
                raise EOFError
            if time.monotonic() >= end:
                return False
        return True

    def _kill(self) -> int | None:
        """Ends the process, whatever it does; returns its exit code."""
        with self._lock:
            process, self._process = self._process, None
        if process is None:  # Another thread has ended it.
            return None
        process.kill()  # Without effect on one that has ended.
        process.join()
        code: int | None = process.exitcode
        return code

    def end(self) -> None:
        """Ends the process, whatever it does, for good."""
        with self._lock:
            self._ended = True
        self._kill()


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


def _serve(pipe: Connection, work: Work) -> None:
    """Answers each trial with the line of its record."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    # It ends with its parent, and so is a daemon, but a trial may start processes.
    process: Any = multiprocessing.current_process()
    process._config["daemon"] = False
    threadpool_limits(1)
    runner: TrialRunner | None = None
    pipe.send(True)
    while True:
        trial: Trial = pipe.recv()
        try:
            runner = runner or work.runner()
            line = as_line(runner(trial))
        except BaseException:  # A trial may even ask for the end of its process.
            line = as_line(trial.record(error=traceback.format_exc()))
        pipe.send_bytes(line)


def _end_with_parent() -> None:
    """Ends this process when its parent is gone, even by SIGKILL."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os._exit(1)
