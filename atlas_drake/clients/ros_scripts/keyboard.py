"""Standard input of a program, and its module ``select``: waiting lets time pass.

Without them the robot would stand still until the next key.
"""

from __future__ import annotations

import codecs
import math
import os
import select
import sys
from collections.abc import Iterable, Iterator
from typing import Any, TextIO

from atlas_drake.clients.ros_scripts.clock import Clock, RunEnded


class InputEnded(RunEnded, KeyboardInterrupt):
    """Ends a wait for input when the run has ended, as Ctrl-C does."""


class Keyboard:
    """``sys.stdin`` of a program; what it does not define is that of the stream."""

    def __init__(self, clock: Clock, stream: TextIO) -> None:
        """Reads the stream's file, past its buffer."""
        self._clock, self._stream = clock, stream
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self._text = ""

    def read(self, size: int = -1) -> str:
        """Waits for so many characters; for all until the end if negative."""
        everything = size < 0
        while (everything or len(self._text) < size) and self._fill():
            pass
        return self._take(len(self._text) if everything else size)

    def readline(self, _size: int = -1) -> str:
        """Waits for a line."""
        while "\n" not in self._text and self._fill():
            pass
        return self._take(self._text.find("\n") + 1 or len(self._text))

    def input(self, prompt: object = "") -> str:
        """The builtin ``input``."""
        sys.stdout.write(str(prompt))
        sys.stdout.flush()
        line = self.readline()
        if not line:
            raise EOFError
        return line.removesuffix("\n")

    def select(
        self,
        readers: Iterable[Any],
        writers: Iterable[Any],
        others: Iterable[Any],
        timeout: float | None = None,
    ) -> tuple[list[Any], ...]:
        """The function ``select.select``, with a timeout in simulated time [s]."""
        lists = (list(readers), list(writers), list(others))
        found: tuple[list[Any], ...] = ([], [], [])

        def ready() -> bool:
            nonlocal found
            if self in lists[0] and self._text:
                found = ([self], [], [])
            else:
                found = select.select(*lists, 0)
            return any(found)

        if timeout == 0 and not ready():
            self._clock.count_query()
        else:
            self._clock.wait_for(ready, math.inf if timeout is None else timeout)
        return found

    def _fill(self) -> bool:
        """Waits for input and takes it; returns False at its end."""
        try:
            self.select([self._stream], [], [])
        except RunEnded:
            raise InputEnded from None
        got = os.read(self._stream.fileno(), 4096)
        self._text += self._decoder.decode(got)
        return bool(got)

    def _take(self, count: int) -> str:
        taken, self._text = self._text[:count], self._text[count:]
        return taken

    def __iter__(self) -> Iterator[str]:
        """Yields lines."""
        return iter(self.readline, "")

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)
