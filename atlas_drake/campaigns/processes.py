"""Calls a function with many items in processes of their own, several at a time.

Knows nothing of robots. A process serves call after call, so that the function can keep
what is expensive to make. When a process dies, no other process and no item is lost.
"""

from __future__ import annotations

import faulthandler
import multiprocessing
import os
import pickle
import signal
import tempfile
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables for one thread of linear algebra per process; numpy reads them
when it loads."""
CALLS = 2
"""Largest number of calls with one item: when a second process dies during the call,
the item is the cause."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one call.

    Attributes:
        item: Argument of the call.
        result: Returned value; None if the call failed.
        error: Reason of the failure, with its traceback; None if there was none.
    """

    item: Any
    result: Any
    error: str | None = None


class _Worker:
    """A process, the parent's end of its pipe, and the call that it serves.

    Attributes:
        entry: Item and number of its calls, or None if the process is idle.
    """

    def __init__(self, pickled: bytes, limit: float) -> None:
        spawn = multiprocessing.get_context("spawn")
        self.pipe, other = spawn.Pipe()
        number, self._path = tempfile.mkstemp(prefix="atlas_drake_")
        self._trace = os.fdopen(number, errors="replace")
        arguments = (other, pickled, limit, self._path)
        self.process = spawn.Process(target=_serve, args=arguments, daemon=True)
        with _inherited():
            self.process.start()
        other.close()
        self.entry: tuple[Any, int] | None = None

    def timeout_trace(self) -> str:
        """Returns where the dead process was at its time limit, or an empty text."""
        return self._trace.read()

    def stop(self) -> None:
        """Ends the process, whatever it does."""
        self.pipe.close()
        self.process.terminate()
        self.process.join()
        self._trace.close()
        Path(self._path).unlink(missing_ok=True)


class Processes:
    """Processes that call one function until ``close``."""

    def __init__(self, pickled: bytes, jobs: int, limit: float = 0.0) -> None:
        """Starts no process yet.

        Args:
            pickled: The function, pickled.
            jobs: Largest number of processes.
            limit: Wall time after which a call is ended and fails [s]; 0 for no limit.
        """
        self._pickled, self._jobs, self._limit = pickled, jobs, limit
        self._workers: dict[Any, _Worker] = {}

    def calls(self, items: Iterable[Any]) -> Iterator[Outcome]:
        """Calls the function with each item.

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
                assert worker.entry is not None
                (item, calls), worker.entry = worker.entry, None
                try:
                    result, error = worker.pipe.recv()
                except (EOFError, OSError):
                    result, error = None, self._bury(worker)
                    if error is None and calls < CALLS:
                        waiting.appendleft((item, calls + 1))
                        continue
                    error = error or f"the process died ({worker.process.exitcode})"
                # The next call begins before the caller handles this outcome.
                self._give(waiting)
                yield Outcome(item, result, error)

    def _give(self, waiting: deque[tuple[Any, int]]) -> None:
        """Gives items to idle processes, and starts further processes."""
        idle = [worker for worker in self._workers.values() if not worker.entry]
        while waiting and (idle or len(self._workers) < self._jobs):
            if idle:
                worker = idle.pop()
            else:
                worker = _Worker(self._pickled, self._limit)
                self._workers[worker.pipe] = worker
            worker.entry = waiting.popleft()
            # If the process has died, ``recv`` reports it.
            with suppress(OSError):
                worker.pipe.send(worker.entry[0])

    def _bury(self, worker: _Worker) -> str | None:
        """Removes a dead process; returns the error if its time limit ended it."""
        del self._workers[worker.pipe]
        worker.process.join()
        trace = worker.timeout_trace()
        worker.stop()
        return f"{trace}took longer than {self._limit:g} s" if trace else None

    def close(self) -> None:
        """Ends the processes, whatever they do."""
        for worker in self._workers.values():
            worker.stop()
        self._workers.clear()


def run_in_processes(
    function: Callable[[Any], Any], items: Iterable[Any], jobs: int, limit: float = 0.0
) -> Iterator[Outcome]:
    """Calls a function with each item in ``Processes``, and ends them.

    Args:
        function: Picklable: defined at the top level of a module, or an instance of a
            class that is.
        items: Arguments, one per call.
        jobs: Largest number of processes.
        limit: Wall time after which a call is ended and fails [s]; 0 for no limit.

    Yields:
        Outcomes in the order in which the calls end.
    """
    with closing(Processes(pickle.dumps(function), jobs, limit)) as processes:
        yield from processes.calls(items)


@contextmanager
def _inherited() -> Iterator[None]:
    """Prepares what a new process inherits: one thread for numpy, Ctrl-C ignored.

    Ctrl-C reaches all processes of a terminal, but only the first one may act on it.
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


def _serve(pipe: Connection, pickled: bytes, limit: float, trace: str) -> None:
    """Answers calls until the parent closes the pipe.

    A call beyond the limit ends this process, and writes to the file ``trace`` where it
    was. The thread that does so needs no Python, so that no call can block it.
    """
    threading.Thread(target=_end_with_parent, daemon=True).start()
    function = None
    with open(trace, "w") as file:
        # The parent has the file open: even if both are killed, nothing remains.
        os.unlink(trace)
        while True:
            try:
                item = pipe.recv()
            except (EOFError, OSError):
                return
            result, error = None, None
            try:
                function = function or pickle.loads(pickled)
                if limit:
                    faulthandler.dump_traceback_later(limit, exit=True, file=file)
                result = function(item)
            except Exception:
                error = traceback.format_exc()
            finally:
                faulthandler.cancel_dump_traceback_later()
            pipe.send((result, error))


def _end_with_parent() -> None:
    """Ends this process when its parent is gone, even by SIGKILL."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
