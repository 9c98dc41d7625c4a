"""The modules ``threading`` and ``time`` of a program: turns, and simulated time.

Threads and locks are Python's; what waits for them lets simulated time pass. Only the
program gets these modules; Drake and all other code keep Python's.
"""

from __future__ import annotations

import math
import threading
import time
from types import ModuleType
from typing import Any

from atlas_drake.clients.ros_scripts.clock import Clock, RunEnded
from atlas_drake.clients.ros_scripts.python2_values import with_names

_KEPT = ("current_thread", "get_ident", "local", "main_thread", "ThreadError")


def _limit(timeout: float | None) -> float:
    """Return a timeout of ``threading`` in seconds; None and -1 mean no limit."""
    return math.inf if timeout is None or timeout < 0 else timeout


def simulated_threading(clock: Clock) -> dict[str, Any]:
    """Return the contents of the module ``threading``."""

    class Thread(threading.Thread):
        """``threading.Thread``: runs in turn with the program's other threads."""

        def start(self) -> None:
            clock.start(self)

        def is_alive(self) -> bool:
            return clock.is_running(self)

        isAlive = is_alive  # Its name in Python 2.

        def join(self, timeout: float | None = None) -> None:
            clock.wait_for(lambda: not clock.is_running(self), _limit(timeout))

    class Event(threading.Event):
        """``threading.Event``."""

        def wait(self, timeout: float | None = None) -> bool:
            return clock.wait_for(self.is_set, _limit(timeout))

    class Lock:
        """``threading.Lock`` or, of another ``kind``, ``threading.RLock``."""

        def __init__(self, kind: Any = threading.Lock) -> None:
            self._lock = kind()
            self.release = self._lock.release

        def acquire(self, blocking: bool = True, timeout: float | None = None) -> bool:
            limit = _limit(timeout) if blocking else 0.0
            return clock.wait_for(lambda: self._lock.acquire(False), limit)

        def __enter__(self) -> bool:
            return self.acquire()

        def __exit__(self, *_error: object) -> None:
            self.release()

    return {name: getattr(threading, name) for name in _KEPT} | {
        "Event": Event,
        "Lock": Lock,
        "RLock": lambda: Lock(threading.RLock),
        "Thread": Thread,
    }


def simulated_time(clock: Clock) -> ModuleType:
    """Return the module ``time``; its clocks are simulated time and start at 0 s."""

    def sleep(seconds: float) -> None:
        if clock.paused:
            clock.count_query()
        elif not clock.advance_to(clock.sim.time + seconds):
            raise RunEnded

    clocks = dict.fromkeys(("clock", "time", "monotonic", "perf_counter"), clock.now)
    return with_names(time, {**clocks, "sleep": sleep})
