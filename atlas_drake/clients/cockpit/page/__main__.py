"""The page's process: serves until the line to the simulation is closed."""

from __future__ import annotations

import asyncio
import logging
import queue
import secrets
import sys
import threading
from collections import Counter
from typing import Any

from atlas_drake.addresses import ANYWHERE, is_private
from atlas_drake.clients.cockpit.link import Link
from atlas_drake.clients.cockpit.page.access import Access
from atlas_drake.clients.cockpit.page.server import FIRST_PORT, Server, serving
from atlas_drake.clients.cockpit.page.session import Session
from atlas_drake.clients.cockpit.wire import Answer
from atlas_drake.errors import printable

LONGEST_LINE = 200
"""Letters of a line about an input that was dropped."""


async def serve(link: Link, host: str, port: int) -> None:
    """Serves the page until the line is closed."""
    try:
        token = None if is_private(host) else secrets.token_urlsafe(16)
        host = "0.0.0.0" if host == ANYWHERE else host
        access, outgoing = Access(host, token), queue.SimpleQueue[Any]()
        server = Server(access, outgoing.put, Session())
        async with serving(server, host, port or FIRST_PORT) as port:
            link.send(access.url(port))
            threading.Thread(target=_write, args=(link, outgoing), daemon=True).start()
            loop = asyncio.get_running_loop()
            while True:
                message = await asyncio.to_thread(link.receive)
                # The page goes on after a fault, which the loop logs.
                loop.call_soon(server.take, message)
    except EOFError:
        pass  # Nothing is left to show.
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or str(error)
        link.send(Answer(0, problem=problem))


def _write(link: Link, outgoing: queue.SimpleQueue[Any]) -> None:
    """Sends what the server, which never waits for the simulation, has put out."""
    while True:
        link.send(outgoing.get())


class Rarely(logging.Filter):
    """Lets the first error of each place in the code pass, then the 10th, 100th ..."""

    def __init__(self) -> None:
        """Has counted nothing yet."""
        super().__init__()
        self._counts = Counter[tuple[str, int]]()

    def filter(self, record: logging.LogRecord) -> bool:
        """Counts an error, and returns True if it is to be said."""
        place = record.pathname, record.lineno
        self._counts[place] += 1
        times = vars(record)["times"] = self._counts[place]
        return str(times).rstrip("0") == "1"


class OneLine(logging.Formatter):
    """Leaves tracebacks out: what a browser sends may cause any number of them."""

    def format(self, record: logging.LogRecord) -> str:
        """Returns the error in one line, and how often there was one like it."""
        error = record.exc_info[1] if record.exc_info else record.getMessage()
        kind = f"{type(error).__name__}: " if isinstance(error, Exception) else ""
        text = f"! The page dropped an input: {kind}{error}"
        times = getattr(record, "times", 1)
        often = f" ({times} like it so far)" if times > 1 else ""
        return printable(text)[: LONGEST_LINE - len(often)] + often


if __name__ == "__main__":
    descriptor, host, port = sys.argv[1:]
    handler = logging.StreamHandler()
    handler.setFormatter(OneLine())
    handler.addFilter(Rarely())
    logging.basicConfig(handlers=[handler])
    asyncio.run(serve(Link(int(descriptor)), host, int(port)))
