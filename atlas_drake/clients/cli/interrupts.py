"""Handling of Ctrl-C during a run and while files are written."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def ctrl_c(
    may_interrupt: Callable[[], bool] = lambda: False,
) -> Iterator[threading.Event]:
    """Turns Ctrl-C into a flag, so that no simulation step is interrupted.

    A second Ctrl-C interrupts at once, and so does the first if ``may_interrupt``.
    """
    asked = threading.Event()

    def notice(_number: int, _frame: FrameType | None) -> None:
        asked.set()
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if may_interrupt():
            raise KeyboardInterrupt

    with _on_ctrl_c(notice):
        yield asked


@contextmanager
def nothing_cut_off() -> Iterator[None]:
    """Delays Ctrl-C while files are written."""

    def ask_for_patience(_number: int, _frame: FrameType | None) -> None:
        # A stream of Python's may be in the middle of a line.
        os.write(sys.stderr.fileno(), b"\nStill writing; one moment.\n")

    with _on_ctrl_c(ask_for_patience):
        yield


@contextmanager
def _on_ctrl_c(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Installs a handler in the main thread, which alone receives signals."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
