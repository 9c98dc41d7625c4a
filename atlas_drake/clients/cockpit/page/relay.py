"""Passes Meshcat on: its script, its meshes, and its pictures.

Nothing of what a browser sends reaches Meshcat. Pictures that a browser is too slow for
are replaced by later ones: of the pose of an object only the latest counts.
"""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections import OrderedDict
from collections.abc import AsyncIterator
from typing import Any

import msgpack
from aiohttp import ClientError, ClientSession, TCPConnector, web

from atlas_drake.clients.cockpit.page.sockets import (
    Pending,
    close,
    first_of,
    opened,
    send,
)

SCRIPT = re.compile(rb'src="cas-v1/([0-9a-f]+)"')
"""Where Meshcat's page names its script."""
FILE = re.compile(rb"cas-v1/([0-9a-f]{1,128})")
"""Where a message names a file, by its content."""
ATTEMPTS, PAUSE = 3, 0.5
"""How often a file is asked for, and the time after each attempt [s]."""
AT_A_TIME = 6
"""Files that are fetched at a time."""
MOST_FILES = 200
"""Files that are kept; a robot and its world have about 30."""
MOST_PICTURES = 40
"""3D views that are open at a time."""
MOST_BYTES_IGNORED = 1000
"""Size of a message to the pictures' websocket beyond which it is closed."""
BY_CONTENT = {"Cache-Control": "public, max-age=31536000, immutable"}
"""Headers of a file whose address is that of its content."""
LATEST_COUNTS = {"set_transform": ("path",), "set_property": ("path", "property")}
"""Messages of which the latest replaces those before, and what they are about."""


class Relay:
    """Meshcat as browsers see it.

    A file is fetched once, as soon as Meshcat names it: it forgets files together with
    the objects that use them, when a browser that is slow has yet to ask for them.
    """

    def __init__(self) -> None:
        """Knows no Meshcat yet."""
        self._port = 0
        self._is_known = asyncio.Event()
        self._slots = asyncio.Semaphore(AT_A_TIME)
        self._files: OrderedDict[str, asyncio.Task[bytes | None]] = OrderedDict()
        self._browsers = 0

    def add_to(self, app: web.Application) -> None:
        """Adds ``/meshcat.js``, ``/cas-v1`` and the websocket ``/meshcat``."""
        app.cleanup_ctx.append(self._session_of)
        app.router.add_get("/meshcat.js", self._script)
        app.router.add_get("/cas-v1/{name}", self._file)
        app.router.add_get("/meshcat", self._pictures)

    def show(self, port: int) -> None:
        """Passes the Meshcat at a port on from now on."""
        self._port = port
        self._is_known.set()

    async def _session_of(self, _app: web.Application) -> AsyncIterator[None]:
        # Meshcat closes idle connections, at times the one that the next file would
        # take.
        connector = TCPConnector(limit=0, force_close=True)
        async with ClientSession(connector=connector) as self._meshcat:
            yield
            for task in self._files.values():
                task.cancel()

    # ---- files ---------------------------------------------------------------

    async def _script(self, _request: web.Request) -> web.Response:
        await self._is_known.wait()
        found = SCRIPT.search(await self._fetch("") or b"")
        if found is None:
            raise web.HTTPBadGateway(text="Meshcat's page names no script")
        body = await self._kept(found[1].decode())
        kind = "text/javascript"
        return web.Response(body=body, content_type=kind, charset="utf-8")

    async def _file(self, request: web.Request) -> web.Response:
        name = request.match_info["name"]
        if name not in self._files:  # Meshcat has not named it.
            raise web.HTTPNotFound(text="no such file")
        return web.Response(body=await self._kept(name), headers=BY_CONTENT)

    async def _kept(self, name: str) -> bytes:
        """Returns a file of Meshcat's."""
        self._keep(name)
        file = await self._files[name]
        if file is None:
            raise web.HTTPBadGateway(text="Meshcat does not send this file")
        return file

    def _keep(self, name: str) -> None:
        """Begins to fetch a file, unless it is here already."""
        task = self._files.get(name)
        if task is None or (task.done() and task.result() is None):
            task = asyncio.create_task(self._fetch(f"cas-v1/{name}"))
            self._files[name] = task
        self._files.move_to_end(name)
        while len(self._files) > MOST_FILES:
            self._files.popitem(last=False)

    async def _fetch(self, path: str) -> bytes | None:
        """Fetches a file of Meshcat's; None if it does not send it."""
        url = f"http://localhost:{self._port}/{path}"
        for _ in range(ATTEMPTS):
            with contextlib.suppress(ClientError, TimeoutError, OSError):
                async with self._slots, self._meshcat.get(url) as answer:
                    if answer.ok:
                        return await answer.read()
            await asyncio.sleep(PAUSE)
        return None

    # ---- pictures ------------------------------------------------------------

    async def _pictures(self, request: web.Request) -> web.StreamResponse:
        await self._is_known.wait()
        if self._browsers >= MOST_PICTURES:
            raise web.HTTPServiceUnavailable(text="too many 3D views are open")
        browser = await opened(request, MOST_BYTES_IGNORED)
        pending = Pending()
        self._browsers += 1
        try:
            await first_of(
                self._receive(pending), send(browser, pending), _ignore(browser)
            )
        finally:
            self._browsers -= 1
        await close(browser, request)
        return browser

    async def _receive(self, pending: Pending) -> None:
        """Takes all that Meshcat sends at once, so that no browser holds it up."""
        url = f"http://localhost:{self._port}/"
        with contextlib.suppress(ClientError, OSError, asyncio.QueueFull):
            async with self._meshcat.ws_connect(url, max_msg_size=0) as meshcat:
                async for message in meshcat:
                    if isinstance(message.data, bytes):
                        for name in FILE.findall(message.data):
                            self._keep(name.decode())
                        pending.put(message.data, subject_of(message.data))


def subject_of(message: bytes) -> Any:
    """Returns what a message is about, if a later one replaces it, or else None."""
    try:
        content = msgpack.unpackb(message, strict_map_key=False)
    except (ValueError, msgpack.UnpackException):
        return None
    kind = content.get("type") if isinstance(content, dict) else None
    about = LATEST_COUNTS.get(kind or "")
    return None if about is None else (kind, *map(content.get, about))


async def _ignore(browser: web.WebSocketResponse) -> None:
    """Drops what a browser sends, until it goes."""
    async for _message in browser:
        pass
