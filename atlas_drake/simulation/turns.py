"""Threads that share a simulation: one at a time, in the order in which they ask.

A Drake Context is for one thread at a time. What is done with it is not decided here.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable


class Turns:
    """A lock that a thread may take again, and a list of tasks that cannot wait for it.

    Threads that wait come next when the lock is let go, so that a thread that takes it
    again and again keeps nobody out. The thread that has the lock does the tasks which
    others left, in their order, before it lets go. While it does them nothing more can
    be left: who leaves task after task must in the end wait like everybody else.
    """

    def __init__(self) -> None:
        """Nobody has the lock, and nothing is left to do."""
        self._guard = threading.Lock()
        self._owner: int | None = None
        self._depth = 0
        self._waiting: deque[tuple[int, threading.Lock]] = deque()
        self._left: deque[Callable[[], object]] = deque()
        self._ending = False

    def leave(self, task: Callable[[], object]) -> bool:
        """Leaves a task, which must not raise, to the thread that has the lock.

        Returns:
            False, with nothing left, if no other thread has it or it is about to let
            go.
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
        """Does what was left to do, and lets the next thread in.

        What interrupts a task is raised here; the tasks after it stay for the next.
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
