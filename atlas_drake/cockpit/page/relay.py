"""Passes Meshcat on: its script, its meshes, and its pictures.

Nothing of what a browser sends reaches Meshcat. Pictures that a browser is too slow for
are replaced by later ones: of the pose of an object only the latest counts.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import time
from collections import OrderedDict
from typing import Any

import httpx
import msgpack
from fastapi import FastAPI, Response, WebSocket, WebSocketDisconnect
from websockets.asyncio.client import connect

from atlas_drake.cockpit.page.desk import Desk

SCRIPT = re.compile(r'src="(cas-v1/[0-9a-f]+)"')
"""Where Meshcat's page names its script."""
NAME = re.compile(r"[0-9a-f]{1,128}")
MESHCAT_PATIENCE = 60.0
"""Longest wait for a file of Meshcat's [s]; a loaded computer needs many seconds."""
BEAT = 0.1
"""Time between two messages about age and robot [s]."""
LATEST_COUNTS = {"set_transform": ("path",), "set_property": ("path", "property")}
"""Messages of which the latest replaces those before, and what they are about."""


def add_routes(app: FastAPI, desk: Desk) -> None:
    """Adds ``/meshcat.js``, ``/cas-v1`` and the websocket ``/meshcat``."""
    kept: dict[str, Response] = {}
    # Meshcat closes idle connections, at times the one that the next file would take.
    meshcat = httpx.AsyncClient(
        timeout=MESHCAT_PATIENCE,
        trust_env=False,
        limits=httpx.Limits(max_connections=6, max_keepalive_connections=0),
    )

    async def fetch(path: str) -> Response:
        """Fetches a file of Meshcat's, whose name tells its content, once."""
        if path in kept:
            return kept[path]
        found = await meshcat.get(f"{_address(desk)}/{path}")
        kind = found.headers.get("content-type")
        file = Response(found.content, found.status_code, media_type=kind)
        if found.is_success:
            kept[path] = file
        return file

    @app.get("/meshcat.js")
    async def script() -> Response:
        page = await meshcat.get(_address(desk))
        found = SCRIPT.search(page.text)
        if found is None:
            return Response("Meshcat's page names no script", 502)
        return await fetch(found[1])

    @app.get("/cas-v1/{name}")
    async def file(name: str) -> Response:
        if not NAME.fullmatch(name):
            return Response("no such file", 404)
        return await fetch(f"cas-v1/{name}")

    @app.websocket("/meshcat")
    async def pictures(browser: WebSocket) -> None:
        await browser.accept()
        pending = Pending()
        tasks = [
            asyncio.create_task(one)
            for one in (
                _receive(_address(desk), pending),
                _send(browser, pending),
                _beat(desk, pending),
                _ignore(browser),
            )
        ]
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in tasks:
            task.cancel()
        with contextlib.suppress(RuntimeError):
            await browser.close()


def _address(desk: Desk) -> str:
    assert desk.card is not None
    return f"http://localhost:{desk.card.meshcat_port}"


class Pending:
    """Messages that a browser has not taken yet, oldest first."""

    def __init__(self) -> None:
        """Starts empty."""
        self._messages: OrderedDict[Any, bytes | str] = OrderedDict()
        self._count = 0
        self._some = asyncio.Event()

    def put(self, message: bytes | str, about: Any = None) -> None:
        """Adds a message, in place of one ``about`` the same."""
        self._count += 1
        key = self._count if about is None else about
        self._messages.pop(key, None)
        self._messages[key] = message
        self._some.set()

    async def take(self) -> bytes | str:
        """Waits for a message."""
        while not self._messages:
            self._some.clear()
            await self._some.wait()
        return self._messages.popitem(last=False)[1]


def subject_of(message: bytes) -> Any:
    """Returns what a message is about, if a later one replaces it, or else None."""
    try:
        content = msgpack.unpackb(message, strict_map_key=False)
    except (ValueError, msgpack.UnpackException):
        return None
    kind = content.get("type") if isinstance(content, dict) else None
    about = LATEST_COUNTS.get(kind or "")
    return None if about is None else (kind, *map(content.get, about))


async def _receive(address: str, pending: Pending) -> None:
    """Takes all that Meshcat sends at once, so that no browser holds it up."""
    url = address.replace("http:", "ws:")
    async with connect(url, max_size=None, compression=None, proxy=None) as meshcat:
        async for message in meshcat:
            if isinstance(message, bytes):
                pending.put(message, subject_of(message))


async def _send(browser: WebSocket, pending: Pending) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while True:
            message = await pending.take()
            if isinstance(message, str):
                await browser.send_text(message)
            else:
                await browser.send_bytes(message)


async def _beat(desk: Desk, pending: Pending) -> None:
    """Tells the age of the state, and where the robot is, for the camera."""
    while True:
        state = desk.state
        if state is not None:
            age = time.monotonic() - desk.received
            beat = {"sent": time.time(), "age": age}
            place = {"robot": state.robot, "ground": state.ground}
            pending.put(json.dumps(beat | place), "beat")
        await asyncio.sleep(BEAT)


async def _ignore(browser: WebSocket) -> None:
    """Drops what a browser sends, until it goes."""
    with contextlib.suppress(WebSocketDisconnect, RuntimeError, KeyError):
        while True:
            if (await browser.receive())["type"] == "websocket.disconnect":
                return
