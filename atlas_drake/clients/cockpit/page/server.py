"""The web server of the page: one port for page, 3D view and commands."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import orjson
from aiohttp import WSMessage, WSMsgType, web
from pydantic import BaseModel, ConfigDict, Field

from atlas_drake.clients.cockpit.page.access import Access, Throttle, add_headers
from atlas_drake.clients.cockpit.page.actions import Actions, Refused
from atlas_drake.clients.cockpit.page.relay import Relay
from atlas_drake.clients.cockpit.page.session import Session, Viewer, as_json
from atlas_drake.clients.cockpit.page.sockets import close, first_of, opened, send
from atlas_drake.clients.cockpit.wire import (
    ACKNOWLEDGED,
    Answer,
    Frame,
    Notice,
    Run,
    Settings,
)
from atlas_drake.errors import AtlasError

FIRST_PORT, PORTS_TRIED = 8080, 100
"""First port that is tried, and how many are."""
STATIC = Path(__file__).parent / "static"
ASSETS = frozenset(path.name for path in STATIC.iterdir() if path.is_file())
MOST_BYTES, MOST_BYTES_WATCHING = 1_000_000, 10_000
"""Size of a browser's message, and of one that has no control, beyond which its
connection is closed."""
PERIOD = 0.02
"""Time between two set-points of a joint that moves, and between two looks at whether
who has control is silent [s]."""
_log = logging.getLogger(__package__)


class Server:
    """The page of one line: what comes over it goes to browsers, and back."""

    def __init__(
        self, access: Access, send: Callable[[Any], object], session: Session
    ) -> None:
        """Serves viewers, who ask the run by ``send``."""
        self._access, self._send, self._session = access, send, session
        self._actions = Actions(send, session)
        self._relay = Relay()

    def app(self) -> web.Application:
        """Returns the application to serve."""
        app = web.Application(middlewares=[self._access.guard])
        app.on_response_prepare.append(add_headers)
        app.cleanup_ctx.append(self._as_time_goes_on)
        app.router.add_get("/", self._index)
        app.router.add_get("/socket", self._socket)
        app.router.add_get("/assets/{name}", self._asset)
        self._relay.add_to(app)
        return app

    def take(self, message: Any) -> None:
        """Takes what comes over the line."""
        session, actions = self._session, self._actions
        if isinstance(message, Frame):
            self._send(ACKNOWLEDGED)
            actions.see(message)
            session.show_frame(message, **actions.beside)
        elif isinstance(message, Answer):
            actions.take(message)
        elif isinstance(message, Run):
            actions.join(message)
            self._relay.show(message.meshcat_port)
            session.show_run(message)
        elif isinstance(message, Settings):
            session.show_settings(message)
        elif isinstance(message, Notice):
            session.show_notice(message)

    async def _as_time_goes_on(self, _app: web.Application) -> AsyncIterator[None]:
        task = asyncio.create_task(self._go_on())
        yield
        task.cancel()

    async def _go_on(self) -> None:
        while True:
            await asyncio.sleep(PERIOD)
            self._actions.move(PERIOD)
            self._session.pass_on()

    async def _index(self, _request: web.Request) -> web.FileResponse:
        return web.FileResponse(STATIC / "index.html")

    async def _asset(self, request: web.Request) -> web.FileResponse:
        # Only the names of files that are there reach the file system.
        name = request.match_info["name"]
        if name not in ASSETS:
            raise web.HTTPNotFound(text="no such file")
        return web.FileResponse(STATIC / name)

    # ---- one browser ---------------------------------------------------------

    async def _socket(self, request: web.Request) -> web.WebSocketResponse:
        """Serves the page of one viewer, as long as it is open."""
        socket = await opened(request, MOST_BYTES)
        may_steer = self._access.allows(request.query.get("token", ""))
        if not self._session.has_room(may_steer=may_steer):
            text = "Too many pages are open: close one, and load this one anew"
            await socket.send_str(as_json("notice", text=text, lasting=True).decode())
            await close(socket, request, code=1013)
            return socket
        viewer = Viewer(may_steer)
        sending = asyncio.create_task(send(socket, viewer.pending, WSMsgType.TEXT))
        viewer.drop = sending.cancel
        self._session.join(viewer)
        self._send(len(self._session.viewers))
        try:
            await first_of(sending, self._receive(socket, viewer))
        finally:
            if self._session.leave(viewer):
                self._actions.end_walk()
            self._send(len(self._session.viewers))
        await close(socket, request)
        return socket

    async def _receive(self, socket: web.WebSocketResponse, viewer: Viewer) -> None:
        """Takes what a browser sends, until it goes or must go."""
        throttle = Throttle()
        answering: set[asyncio.Task[None]] = set()
        async for message in socket:
            fault = self._fault_of(message, viewer, throttle)
            if fault:
                _complain(viewer, fault)
                return
            try:
                asked = Asked.model_validate(orjson.loads(message.data))
            except ValueError as error:
                _complain(viewer, f"a message that is no request: {error}")
                continue
            task = asyncio.create_task(self._answer(viewer, asked))
            answering.add(task)
            task.add_done_callback(answering.discard)

    async def _answer(self, viewer: Viewer, asked: Asked) -> None:
        """Does what a viewer asks for, and tells it what became of it."""
        try:
            value = await self._actions.do(viewer, asked.do, asked.values)
            viewer.tell("answer", number=asked.number, value=value)
            return
        except (Refused, AtlasError, ValueError) as error:
            problem = str(error)
        except Exception as error:  # Of this program's: the page goes on.
            problem = f"{type(error).__name__}: {error}"
            _complain(viewer, problem)
        viewer.tell("answer", number=asked.number, problem=problem)

    def _fault_of(self, message: WSMessage, viewer: Viewer, throttle: Throttle) -> str:
        """Returns why a message ends its connection; empty if it does not."""
        if message.type is WSMsgType.ERROR:
            return f"a message of more than {MOST_BYTES} bytes, or a broken one"
        if not throttle.allows_one_more():
            return "a flood of messages"
        is_watching = viewer is not self._session.holder
        if is_watching and len(message.data) > MOST_BYTES_WATCHING:
            return f"a message of more than {MOST_BYTES_WATCHING} bytes from a watcher"
        return ""


class Asked(BaseModel):
    """What a browser asks for."""

    model_config = ConfigDict(strict=True)
    number: int = 0
    do: str
    values: dict[str, Any] = Field(default={}, alias="with")


def _complain(viewer: Viewer, fault: str) -> None:
    """Says at the terminal what is wrong with a connection, once."""
    if not viewer.has_erred:
        viewer.has_erred = True
        _log.warning("%s", fault)


@contextlib.asynccontextmanager
async def serving(server: Server, host: str, first: int) -> AsyncIterator[int]:
    """Serves at the first free port from ``first`` on, which it gives."""
    runner = web.AppRunner(server.app(), access_log=None, shutdown_timeout=0.1)
    await runner.setup()
    try:
        for port in range(first, first + PORTS_TRIED):
            try:
                await web.TCPSite(runner, host, port).start()
                break
            except OSError:
                if port == first + PORTS_TRIED - 1:
                    raise
        yield port
    finally:
        await runner.cleanup()
