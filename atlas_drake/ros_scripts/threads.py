"""The modules ``threading`` and ``time`` of a program: turns, and simulated time.

The turns are in ``clock``. As one thread runs at a time, a lock is a flag. Only the
program gets these modules; Drake and all other code keep Python's.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import ModuleType
from typing import Any, ClassVar

from atlas_drake.ros_scripts.clock import ENDED, Clock, RunEnded, Turn


class _OnClock:
    """Has the clock of the run as an attribute of the class."""

    _clock: ClassVar[Clock]

    def _wait(self, ready: Callable[[], object], timeout: float | None) -> None:
        """Waits until ``ready()``, at most ``timeout`` [s]; None or -1 for no limit."""
        if timeout is None or timeout < 0:
            timeout = math.inf
        self._clock.wait_until(ready, self._clock.sim.time + timeout)


class Thread(_OnClock, threading.Thread):
    """``threading.Thread``: runs in turn with the program's other threads."""

    _has_ended = False

    def start(self) -> None:
        """Starts the thread; it runs when the present thread waits."""
        clock, run, turn = self._clock, self.run, Turn(lambda: True)

        def run_in_turn() -> None:
            clock.take(turn)
            try:
                with suppress(*ENDED):
                    run()
            finally:
                self._has_ended = True
                clock.pass_on()

        self.run = run_in_turn  # type: ignore[method-assign]
        clock.threads.append(self)
        super().start()
        clock.queue(turn)

    def is_alive(self) -> bool:
        """Tells whether the thread has started and not ended."""
        return super().is_alive() and not self._has_ended

    def join(self, timeout: float | None = None) -> None:
        """Waits until the thread has ended."""
        super().join(0.0)  # Refuses a thread that has not started.
        self._wait(lambda: self._has_ended, timeout)


class Lock(_OnClock):
    """``threading.Lock``."""

    _locked = False

    def locked(self) -> bool:
        """Tells whether a thread has the lock."""
        return self._locked

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Takes the lock; returns whether it was free in time."""
        if blocking:
            self._wait(lambda: not self._locked, timeout)
        if self._locked:
            return False
        self._locked = True
        return True

    def release(self) -> None:
        """Gives the lock back.

        Raises:
            RuntimeError: If no thread has it.
        """
        if not self._locked:
            raise RuntimeError("release unlocked lock")
        self._locked = False

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_error: object) -> None:
        self.release()


class RLock(Lock):
    """``threading.RLock``: its owner can take it several times."""

    _owner, _times = 0, 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Takes the lock; returns whether it was free in time."""
        if self._owner != threading.get_ident():
            if not super().acquire(blocking, timeout):
                return False
            self._owner = threading.get_ident()
        self._times += 1
        return True

    def release(self) -> None:
        """Gives the lock back, as often as it was taken.

        Raises:
            RuntimeError: If the present thread does not have it.
        """
        if self._owner != threading.get_ident():
            raise RuntimeError("cannot release un-acquired lock")
        self._times -= 1
        if self._times == 0:
            self._owner = 0
            super().release()


class Event(_OnClock, threading.Event):
    """``threading.Event``."""

    def wait(self, timeout: float | None = None) -> bool:
        """Waits until the event is set; returns whether it is."""
        self._wait(self.is_set, timeout)
        return self.is_set()


def threading_names(clock: Clock) -> dict[str, Any]:
    """Return the contents of the module."""
    kept = ("current_thread", "get_ident", "local", "main_thread", "ThreadError")
    return {name: getattr(threading, name) for name in kept} | {
        kind.__name__: type(kind.__name__, (kind,), {"_clock": clock})
        for kind in (Thread, Lock, RLock, Event)
    }


def start_callbacks(clock: Clock, loop: Callable[[], object]) -> None:
    """Runs a loop of callbacks in a thread of its own; an error there ends the run."""

    def run() -> None:
        try:
            loop()
        except BaseException as error:
            clock.shut_down(error)

    kind = threading_names(clock)["Thread"]
    kind(target=run, daemon=True).start()


def simulated_time(clock: Clock) -> ModuleType:
    """Return the module; its clocks are simulated time and start at 0 s."""

    def now() -> float:
        return clock.now

    def now_ns() -> int:
        return round(clock.now * 1e9)

    def sleep(seconds: float) -> None:
        if seconds < 0:
            raise ValueError("sleep length must be non-negative")
        if not clock.advance_to(clock.sim.time + seconds):
            raise RunEnded

    module = ModuleType("time", time.__doc__)
    vars(module).update(vars(time))
    vars(module).update(
        dict.fromkeys(("time", "monotonic", "perf_counter", "clock"), now)
        | dict.fromkeys(("time_ns", "monotonic_ns", "perf_counter_ns"), now_ns)
        | {"sleep": sleep}
    )
    return module
