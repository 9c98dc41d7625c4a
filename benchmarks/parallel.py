"""Runs in separate processes, a few at a time, with results as they arrive.

Independent of robots. A run that crashes does not affect the others.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Any

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that keep numpy from starting threads that compete for the cores."""


@dataclass(frozen=True)
class Outcome:
    """Outcome of one run.

    Attributes:
        item: Argument of the run.
        result: Return value; None if the run failed.
        error: Error of a failed run; None otherwise.
    """

    item: Any
    result: Any
    error: str | None = None


def run_in_processes(
    function: Callable[[Any], Any], items: Sequence[Any], jobs: int
) -> Iterator[Outcome]:
    """Calls ``function`` with each item, each in a fresh process.

    Args:
        function: Defined at the top level of a module, so that it can be sent.
        items: Arguments, one per run.
        jobs: Processes at a time.

    Yields:
        Outcomes in the order in which the runs end. When the caller stops reading or
        is interrupted, the processes that still run are ended.
    """
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")
    spawn = multiprocessing.get_context("spawn")
    waiting = list(items)
    running: dict[Any, tuple[Any, Any]] = {}
    # Ctrl-C goes to all processes of a terminal, but only this one should act on it.
    # A process inherits that a signal is ignored.
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                item = waiting.pop(0)
                receiver, sender = spawn.Pipe(duplex=False)
                process = spawn.Process(
                    target=_call, args=(sender, function, item), daemon=True
                )
                before = signal.signal(signal.SIGINT, signal.SIG_IGN)
                try:
                    process.start()
                finally:
                    signal.signal(signal.SIGINT, before)
                sender.close()
                running[receiver] = (process, item)
            for receiver in wait(list(running)):
                process, item = running.pop(receiver)
                try:
                    result, error = receiver.recv()
                except EOFError:
                    process.join()
                    result, error = None, f"process died ({process.exitcode})"
                process.join()
                yield Outcome(item, result, error)
    finally:
        for process, _ in running.values():
            process.terminate()
            process.join()


def _call(sender: Any, function: Callable[[Any], Any], item: Any) -> None:
    try:
        message = (function(item), None)
    except Exception as error:
        traceback.print_exc()
        message = (None, f"{type(error).__name__}: {error}")
    sender.send(message)
