"""Websockets of browsers, each of which may be slow, or gone."""

from __future__ import annotations

import asyncio
import contextlib
from collections import OrderedDict
from typing import Any

from aiohttp import WSMsgType, web

HEARTBEAT = 60.0
"""Time between two questions whether a browser is still there [s]; a slow one draws for
seconds on end."""
CLOSING_PATIENCE = 2.0
"""Longest time in which a browser takes part in the end of its connection [s]."""
MOST_WAITING, MOST_BYTES_WAITING = 5000, 50_000_000
"""Messages, and bytes of them, beyond which a browser takes none."""


class Pending:
    """Messages that a browser has not taken yet, oldest first."""

    def __init__(self) -> None:
        """Starts empty."""
        self._messages: OrderedDict[Any, bytes] = OrderedDict()
        self._count = self._bytes = 0
        self._some = asyncio.Event()

    def __len__(self) -> int:
        return len(self._messages)

    def put(self, message: bytes, about: Any = None) -> None:
        """Adds a message, in place of one ``about`` the same.

        Raises asyncio.QueueFull for a browser that takes none.
        """
        if len(self._messages) >= MOST_WAITING or self._bytes > MOST_BYTES_WAITING:
            raise asyncio.QueueFull
        self._count += 1
        key = self._count if about is None else about
        self._bytes += len(message) - len(self._messages.pop(key, b""))
        self._messages[key] = message
        self._some.set()

    async def take(self) -> bytes:
        """Waits for a message."""
        while not self._messages:
            self._some.clear()
            await self._some.wait()
        message = self._messages.popitem(last=False)[1]
        self._bytes -= len(message)
        return message


async def opened(request: web.Request, most_bytes: int) -> web.WebSocketResponse:
    """Opens a websocket, which messages of more bytes end."""
    browser = web.WebSocketResponse(
        heartbeat=HEARTBEAT, compress=False, max_msg_size=most_bytes
    )
    await browser.prepare(request)
    return browser


async def send(
    browser: web.WebSocketResponse,
    pending: Pending,
    kind: WSMsgType = WSMsgType.BINARY,
) -> None:
    """Sends what is pending, as fast as a browser takes it."""
    with contextlib.suppress(ConnectionError):
        while True:
            await browser.send_frame(await pending.take(), kind)


async def first_of(*ways: Any) -> None:
    """Goes several ways at once, until the first one ends."""
    tasks = [asyncio.ensure_future(way) for way in ways]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def close(
    browser: web.WebSocketResponse, request: web.Request, code: int = 1000
) -> None:
    """Ends a connection, whether or not its browser takes part."""
    with contextlib.suppress(TimeoutError, ConnectionError):
        async with asyncio.timeout(CLOSING_PATIENCE):
            await browser.close(code=code)
    if request.transport is not None:
        request.transport.abort()
