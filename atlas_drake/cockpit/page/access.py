"""Who may open the page, and who may steer.

A page of another site must not reach the robot through the browser of somebody who
watches: every request names the host that it was sent to, a websocket the site that it
comes from, and browsers say of the others whether another site causes them. They do not
say so for addresses of other computers without encryption; headers of the answers help.
"""

from __future__ import annotations

import hmac
import ipaddress
import time
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any

Asgi = Callable[[dict[str, Any], Any, Any], Awaitable[None]]


class Access:
    """Checks of one address."""

    def __init__(self, host: str, port: int, token: str | None) -> None:
        """Guards an address."""
        self._host, self._port, self._token = host, port, token

    @property
    def url(self) -> str:
        """Address of the page, with the token."""
        host = "localhost" if self._host in ("0.0.0.0", "127.0.0.1") else self._host
        host = f"[{host}]" if ":" in host else host
        query = "" if self._token is None else f"?token={self._token}"
        return f"http://{host}:{self._port}/{query}"

    def allows(self, token: str) -> bool:
        """Returns True if a page that was opened with this token may steer."""
        return self._token is None or hmac.compare_digest(
            token.encode(), self._token.encode()
        )

    def middleware(self, inner: Asgi) -> Asgi:
        """Returns the application ``inner`` with this guard before it."""

        async def guarded(scope: dict[str, Any], receive: Any, send: Any) -> None:
            if scope["type"] in ("http", "websocket") and not self.admits(scope):
                await _refuse(scope["type"], send)
                return
            if scope["type"] == "websocket":
                receive = Throttled(receive)
            await inner(scope, receive, partial(_send_to_this_page, send))

        return guarded

    def admits(self, scope: dict[str, Any]) -> bool:
        """Returns True if a request comes from this page, or from no page."""
        headers = {
            name.decode("latin-1"): value.decode("latin-1")
            for name, value in scope["headers"]
        }
        host = headers.get("host", "")
        if not self._is_ours(host):
            return False
        origin = headers.get("origin")
        if origin is not None:
            return origin.split("://", 1)[-1] == host
        if scope["type"] == "websocket":
            return "user-agent" not in headers  # Browsers send the origin.
        # A typed address and a bookmark come from no site. A link of another site may
        # lead here, as from a chat or a wiki: the page then has a window of its own,
        # which that site cannot look into. In a frame the destination is no document.
        is_link = (
            headers.get("sec-fetch-mode") == "navigate"
            and headers.get("sec-fetch-dest") == "document"
        )
        return is_link or headers.get("sec-fetch-site", "none") in OWN_SITES

    def _is_ours(self, host: str) -> bool:
        """Returns True unless a name of another site was made to point here."""
        name, _, port = host.rpartition(":")
        if port != str(self._port):
            return False
        if name in ("localhost", self._host):
            return True
        try:
            ipaddress.ip_address(name.strip("[]"))
        except ValueError:
            # A host name of this computer's, which only a token makes safe.
            return self._token is not None
        return True


class Throttled:
    """Receives from a websocket, and ends one that floods the page."""

    def __init__(self, receive: Any) -> None:
        """Receives from ``receive``."""
        self._receive = receive
        self._left, self._at = float(BURST), time.monotonic()

    async def __call__(self) -> Any:
        """Waits for a message; a flood ends the connection, as if the browser had."""
        message = await self._receive()
        now = time.monotonic()
        self._left = min(self._left + PER_SECOND * (now - self._at), BURST) - 1.0
        self._at = now
        if self._left < 0.0:
            return {"type": "websocket.disconnect", "code": 1008}
        return message


OWN_SITES = ("none", "same-origin")
"""``Sec-Fetch-Site`` of a request that no other site causes. Another port of this
computer is ``same-site``, and refused."""
FOR_THIS_PAGE = (
    (b"content-security-policy", b"frame-ancestors 'none'"),
    (b"cross-origin-resource-policy", b"same-origin"),
)
"""Headers by which browsers keep an answer from other sites."""
PER_SECOND, BURST = 200, 1000
"""Messages of a browser that are taken per second, and at once; a hand makes fewer."""


async def _send_to_this_page(send: Any, message: dict[str, Any]) -> None:
    if message["type"] == "http.response.start":
        message = {**message, "headers": [*message.get("headers", ()), *FOR_THIS_PAGE]}
    await send(message)


async def _refuse(kind: str, send: Any) -> None:
    if kind == "websocket":
        await send({"type": "websocket.close", "code": 1008})
        return
    await send({"type": "http.response.start", "status": 403, "headers": []})
    await send({"type": "http.response.body", "body": b"not from this page"})
