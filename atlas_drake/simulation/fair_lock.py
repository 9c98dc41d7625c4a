"""A lock for threads that share a simulation, granted in the order of requests.

A Drake Context is for one thread at a time.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable


class FairLock:
    """A fair reentrant lock, with a queue of tasks that do not wait for the lock.

    The lock is granted to waiting threads in their order, so that a thread that takes
    it repeatedly does not exclude others. Before it releases the lock, the owner runs
    the tasks that other threads left, in their order. Meanwhile no further task is
    accepted, so that a thread that leaves task after task finally has to wait, too.
    """

    def __init__(self) -> None:
        """Creates the lock without an owner and without tasks."""
        self._guard = threading.Lock()
        self._owner: int | None = None
        self._depth = 0
        self._waiting: deque[tuple[int, threading.Lock]] = deque()
        self._left: deque[Callable[[], object]] = deque()
        self._ending = False

    def leave(self, task: Callable[[], object]) -> bool:
        """Leaves a task, which must not raise an error, to the owner of the lock.

        Returns:
            False, without leaving the task, if no other thread has the lock or the
            owner is about to release it.
        """
        with self._guard:
            if self._ending or self._owner in (None, threading.get_ident()):
                return False
            self._left.append(task)
            return True

    def __enter__(self) -> None:
        """Waits for the lock."""
        me = threading.get_ident()
        with self._guard:
            if self._owner in (None, me):
                self._owner = me
                self._depth += 1
                return
            turn = threading.Lock()
            turn.acquire()
            entry = (me, turn)
            self._waiting.append(entry)
        try:
            turn.acquire()
        except BaseException:  # Ctrl-C while waiting.
            with self._guard:
                mine = entry not in self._waiting
                if not mine:
                    self._waiting.remove(entry)
            if mine:
                self.__exit__()
            raise

    def __exit__(self, *_error: object) -> None:
        """Runs the tasks that were left, and releases the lock to the next thread.

        An interrupt of a task is raised here; later tasks stay for the next owner.
        """
        try:
            while (task := self._next_left()) is not None:
                task()
        finally:
            with self._guard:
                self._let_go()

    def _next_left(self) -> Callable[[], object] | None:
        with self._guard:
            if self._depth > 1:
                return None
            self._ending = True
            return self._left.popleft() if self._left else None

    def _let_go(self) -> None:
        self._depth -= 1
        if self._depth:
            return
        self._ending = False
        self._owner = None
        if self._waiting:
            self._owner, turn = self._waiting.popleft()
            self._depth = 1
            turn.release()
