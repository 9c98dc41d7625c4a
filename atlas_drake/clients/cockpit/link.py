"""The line between the simulation and the page's process, which never blocks either."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from multiprocessing.connection import Connection
from typing import Any


class Link:
    """One end of the line; values are pickled, between two processes of one user."""

    def __init__(self, descriptor: int) -> None:
        """Takes over the end that a process was given."""
        self._connection = Connection(descriptor)
        self.is_open = True

    def send(self, value: Any) -> None:
        """Sends a value; does nothing once the other end is gone."""
        try:
            self._connection.send(value)
        except OSError:
            self.is_open = False

    def take(self, most: int, timeout: float = 0.0) -> list[Any]:
        """Returns what has come, at most ``most`` values."""
        values: list[Any] = []
        try:
            while len(values) < most and self._connection.poll(timeout):
                values.append(self._connection.recv())
                timeout = 0.0
        except (OSError, EOFError):
            self.is_open = False
        return values

    def receive(self) -> Any:
        """Waits for a value; raises EOFError or OSError once the other end is gone."""
        return self._connection.recv()

    def close(self) -> None:
        """Closes this end."""
        self.is_open = False
        self._connection.close()


def start_process(module: str, *arguments: str) -> tuple[Link, subprocess.Popen[bytes]]:
    """Starts a module as a process of its own, with the number of its end first.

    It is not in the terminal's group, so that Ctrl-C reaches the simulation alone; it
    ends with the line.
    """
    ours, theirs = socket.socketpair()
    process = subprocess.Popen(
        [sys.executable, "-m", module, str(theirs.fileno()), *arguments],
        pass_fds=[theirs.fileno()],
        stdin=subprocess.DEVNULL,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )
    theirs.close()
    return Link(ours.detach()), process
