"""The web server of the page: one port for page, 3D view and commands."""

from __future__ import annotations

import asyncio
import logging
import os
import secrets
import socket
import threading
from pathlib import Path

from nicegui import app, ui

from atlas_drake.addresses import ANYWHERE, is_private
from atlas_drake.cockpit.link import Link
from atlas_drake.cockpit.orders import Reply
from atlas_drake.cockpit.page import relay
from atlas_drake.cockpit.page.access import Access
from atlas_drake.cockpit.page.desk import Desk, Viewer
from atlas_drake.cockpit.page.layout import build_page

FIRST_PORT, PORTS_TRIED = 8080, 100
"""First port that is tried, and how many are."""
STATIC = Path(__file__).parent / "static"


def serve(descriptor: int, host: str, port: int) -> None:
    """Serves the page until the line is closed."""
    link = Link.at(descriptor)
    try:
        token = None if is_private(host) else secrets.token_urlsafe(16)
        host = "0.0.0.0" if host == ANYWHERE else host
        port = free_port(host, port or FIRST_PORT)
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or str(error)
        link.send(Reply(0, problem=problem))
        return
    access = Access(host, port, token)
    desk = Desk(link)
    app.add_middleware(access.middleware)
    app.add_static_files("/assets", STATIC)
    relay.add_routes(app, desk)

    @ui.page("/", title="atlas_drake", response_timeout=30.0)
    def page(token: str = "") -> None:
        build_page(desk, Viewer(may_steer=access.allows(token)))

    async def announce() -> None:
        loop = asyncio.get_running_loop()
        threading.Thread(target=_read, args=(link, desk, loop), daemon=True).start()
        while True:
            try:
                _, writer = await asyncio.open_connection(host, port)
            except OSError:
                await asyncio.sleep(0.02)
                continue
            writer.close()
            break
        link.send(access.url)

    os.environ.pop("PYTEST_CURRENT_TEST", None)  # NiceGUI would serve its own tests.
    _log_in_one_line()
    app.on_startup(lambda: asyncio.ensure_future(announce()))
    ui.run(
        host=host,
        port=port,
        show=False,
        reload=False,
        show_welcome_message=False,
        reconnect_timeout=SLOWEST_ANSWER,
        favicon="🤖",
        dark=None,
        uvicorn_logging_level="critical",
        ws_max_size=MOST_BYTES,
        gzip_middleware_factory=None,
        tailwind=False,
    )


SLOWEST_ANSWER = 60.0
"""Time that a browser has to come back before its page is built anew [s]; a slow one
draws for seconds on end."""
MOST_BYTES = 100_000
"""Size of a browser's message beyond which its connection is closed."""


def _read(link: Link, desk: Desk, loop: asyncio.AbstractEventLoop) -> None:
    """Hands what comes over the line to the desk; ends the process with the line."""
    try:
        while True:
            loop.call_soon_threadsafe(desk.take, link.receive())
    except EOFError:
        os._exit(0)  # Nothing is left to show or to keep.


class _OneLine(logging.Formatter):
    """Leaves tracebacks out: what a browser sends may cause any number of them."""

    def format(self, record: logging.LogRecord) -> str:
        """Returns the error in one line."""
        error = record.exc_info[1] if record.exc_info else record.getMessage()
        kind = f"{type(error).__name__}: " if isinstance(error, Exception) else ""
        return f"! The page dropped an input: {kind}{error}"[:LONGEST_LINE]


LONGEST_LINE = 200
"""Letters of a line about an input that was dropped."""


def _log_in_one_line() -> None:
    handler = logging.StreamHandler()
    handler.setFormatter(_OneLine())
    for name in ("nicegui", "asyncio"):
        log = logging.getLogger(name)
        log.handlers, log.propagate = [handler], False


def free_port(host: str, first: int) -> int:
    """Returns the first free port from ``first`` on."""
    problem = OSError(f"no free port from {first} on")
    for port in range(first, first + PORTS_TRIED):
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((host, port))
                return port
            except OSError as error:
                problem = error
    raise problem
