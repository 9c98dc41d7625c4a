"""Who may open the page, and who may steer.

A page of another site must not reach the robot through the browser of somebody who
watches: every request names the host that it was sent to, a websocket the site that it
comes from, and browsers say of the others whether another site causes them. They do not
say so for addresses of other computers without encryption; headers of the answers help.
The port does not matter: a tunnel or a container gives the page another one.
"""

from __future__ import annotations

import hmac
import ipaddress
import re
import time
from collections.abc import Callable, Mapping

from aiohttp import web
from aiohttp.typedefs import Handler


class Access:
    """Checks of one address."""

    def __init__(self, host: str, token: str | None) -> None:
        """Guards an address; without a token everybody who reaches it may steer."""
        self._host, self._token = host, token

    def url(self, port: int) -> str:
        """Returns the address of the page, with the token."""
        host = "localhost" if self._host in ("0.0.0.0", "127.0.0.1") else self._host
        host = f"[{host}]" if ":" in host else host
        query = "" if self._token is None else f"?token={self._token}"
        return f"http://{host}:{port}/{query}"

    def allows(self, token: str) -> bool:
        """Returns True if a page that was opened with this token may steer."""
        return self._token is None or hmac.compare_digest(
            token.encode(errors="replace"), self._token.encode()
        )

    def admits(self, headers: Mapping[str, str], *, websocket: bool = False) -> bool:
        """Returns True if a request comes from this page, or from no page."""
        host = headers.get("Host", "")
        if not self._is_ours(host):
            return False
        origin = headers.get("Origin")
        if origin is not None:
            return origin.split("://", 1)[-1] == host
        if websocket:
            return "User-Agent" not in headers  # Browsers send the origin.
        # A typed address and a bookmark come from no site. A link of another site may
        # lead here, as from a chat or a wiki: the page then has a window of its own,
        # which that site cannot look into. In a frame the destination is no document.
        is_link = (
            headers.get("Sec-Fetch-Mode") == "navigate"
            and headers.get("Sec-Fetch-Dest") == "document"
        )
        return is_link or headers.get("Sec-Fetch-Site", "none") in OWN_SITES

    def _is_ours(self, host: str) -> bool:
        """Returns True unless a name of another site was made to point here."""
        found = HOST.fullmatch(host)
        if found is None:
            return False
        name = found["name"]
        if name in ("localhost", self._host):
            return True
        try:
            ipaddress.ip_address(name.strip("[]"))
        except ValueError:
            # A host name of this computer's, which only a token makes safe.
            return self._token is not None
        return True

    @web.middleware
    async def guard(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Refuses what is not admitted; a middleware of the server."""
        websocket = request.headers.get("Upgrade", "").lower() == "websocket"
        if not self.admits(request.headers, websocket=websocket):
            raise web.HTTPForbidden(text="not from this page")
        return await handler(request)


class Throttle:
    """Tells a browser that sends more than a hand can from others."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """Starts with the whole burst."""
        self._clock = clock
        self._left, self._at = float(BURST), clock()

    def allows_one_more(self) -> bool:
        """Counts a message; returns False for a flood."""
        now = self._clock()
        self._left = min(self._left + PER_SECOND * (now - self._at), BURST) - 1.0
        self._at = now
        return self._left >= 0.0


async def add_headers(request: web.Request, response: web.StreamResponse) -> None:
    """Tells the browser to keep an answer from other sites; a signal of the server."""
    host = request.headers.get("Host", "")
    host = host if HOST.fullmatch(host) else ""
    # Not every browser counts the websocket of the page's own host as its own.
    own_socket = f" ws://{host} wss://{host}" if host else ""
    response.headers.update(FOR_THIS_PAGE)
    response.headers["Content-Security-Policy"] = POLICY + own_socket
    response.headers.setdefault("Cache-Control", "no-cache")


HOST = re.compile(r"(?P<name>\[[0-9A-Fa-f:.]+\]|[\w.-]+)(:\d+)?", re.ASCII)
"""A host's name and perhaps a port."""
OWN_SITES = ("none", "same-origin")
"""``Sec-Fetch-Site`` of a request that no other site causes. Another port of this
computer is ``same-site``, and refused."""
POLICY = (
    "default-src 'self'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'; connect-src 'self' data: blob:"
)
"""What the page may load and run, which is what this server sends; the last part is
followed by the websocket's address. Meshcat loads parts of a mesh from within it."""
FOR_THIS_PAGE = {
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "same-origin",  # The address has the token.
    "X-Content-Type-Options": "nosniff",
}
"""Headers by which browsers keep an answer from other sites."""
PER_SECOND, BURST = 200, 1000
"""Messages of a browser that are taken per second, and at once; a hand makes fewer."""
