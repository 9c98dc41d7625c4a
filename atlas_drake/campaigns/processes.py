"""A function called with many items in processes of their own, a few at a time.

Knows nothing of robots. A process serves call after call, so that the function may keep
what is dear to make; one that dies takes no other with it, and no item.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that keep numpy from starting threads that fight over the cores; read when
numpy is loaded, and so set before."""
CALLS = 2
"""Times that an item is tried whose process dies: a second process that dies with it
tells that the item is the reason."""


@dataclass(frozen=True)
class Outcome:
    """What became of one call.

    Attributes:
        item: What the function was called with.
        result: What it returned; None if it failed.
        error: Why it failed, with its traceback; None if it did not.
    """

    item: Any
    result: Any
    error: str | None = None


class _Worker:
    """A process and the two ends of its pipe."""

    def __init__(self, function: Callable[[Any], Any]) -> None:
        spawn = multiprocessing.get_context("spawn")
        self.pipe, other = spawn.Pipe()
        self.process = spawn.Process(target=_serve, args=(other, function), daemon=True)
        with _inherited():
            self.process.start()
        other.close()
        self.entry: Any = None

    def stop(self) -> None:
        """Ends the process, whatever it does."""
        self.pipe.close()
        self.process.terminate()
        self.process.join()


class Processes:
    """Processes that call one function; they end with ``close``."""

    def __init__(self, function: Callable[[Any], Any], jobs: int) -> None:
        """Starts nothing yet.

        Args:
            function: That can be sent to a process: defined at the top level of a
                module, or an instance of a class that is.
            jobs: Processes at a time.
        """
        self._function, self._jobs = function, jobs
        self._workers: dict[Any, _Worker] = {}

    def calls(self, items: Iterable[Any]) -> Iterator[Outcome]:
        """Calls the function with each item.

        Args:
            items: Arguments, one per call.

        Yields:
            Outcomes in the order in which the calls end.
        """
        waiting = deque((item, 1) for item in items)
        while True:
            self._give(waiting)
            busy = [pipe for pipe, worker in self._workers.items() if worker.entry]
            if not busy:
                return
            for pipe in wait(busy):
                worker = self._workers[pipe]
                (item, calls), worker.entry = worker.entry, None
                try:
                    result, error = worker.pipe.recv()
                except (EOFError, OSError):
                    del self._workers[pipe]
                    worker.process.join()
                    worker.stop()
                    if calls < CALLS:
                        waiting.appendleft((item, calls + 1))
                        continue
                    code = worker.process.exitcode
                    result, error = None, f"the process died ({code})"
                # The next call begins before this one's outcome is dealt with.
                self._give(waiting)
                yield Outcome(item, result, error)

    def _give(self, waiting: deque[tuple[Any, int]]) -> None:
        """Gives items to processes that have none, and starts more of them."""
        idle = [worker for worker in self._workers.values() if not worker.entry]
        while waiting and (idle or len(self._workers) < self._jobs):
            if idle:
                worker = idle.pop()
            else:
                worker = _Worker(self._function)
                self._workers[worker.pipe] = worker
            _send(worker, waiting.popleft())

    def close(self) -> None:
        """Ends the processes, whatever they do."""
        for worker in self._workers.values():
            worker.stop()
        self._workers.clear()


def run_in_processes(
    function: Callable[[Any], Any], items: Iterable[Any], jobs: int
) -> Iterator[Outcome]:
    """Calls a function with each item, as ``Processes`` do, and ends them."""
    processes = Processes(function, jobs)
    try:
        yield from processes.calls(items)
    finally:
        processes.close()


def _send(worker: _Worker, entry: tuple[Any, int]) -> None:
    worker.entry = entry
    # Of a process that died meanwhile ``recv`` tells.
    with suppress(OSError):
        worker.pipe.send(entry[0])


@contextmanager
def _inherited() -> Iterator[None]:
    """What a process inherits: one thread for numpy, and no ear for Ctrl-C.

    Ctrl-C goes to all processes of a terminal, but only the first should act on it.
    """
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    main = threading.current_thread() is threading.main_thread()
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN) if main else None
    try:
        yield
    finally:
        if main:
            signal.signal(signal.SIGINT, handler)
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _serve(pipe: Connection, function: Callable[[Any], Any]) -> None:
    """What a process does: answers calls until nobody is left to ask."""
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            item = pipe.recv()
        except (EOFError, OSError):
            return
        result, error = None, None
        try:
            result = function(item)
        except Exception:
            error = traceback.format_exc()
        pipe.send((result, error))


def _end_with_parent() -> None:
    """Ends this process when the one that started it is gone, killed perhaps."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
