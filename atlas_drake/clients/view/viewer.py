"""The 3D view's server: start it, wait for a browser, keep it open.

What is drawn is in ``meshcat_view``.
"""

from __future__ import annotations

import os
import sys
import time
import webbrowser
from collections.abc import Callable
from typing import Protocol

from pydrake.geometry import Meshcat, MeshcatParams

from atlas_drake.addresses import LOCALHOST, is_private
from atlas_drake.errors import ScenarioError

VIEWER_PATIENCE = 15.0
"""Longest time that the start waits for a browser [s]."""

PORTS_TRIED = 100
"""Number of ports, from the requested one on, that are tried."""


def start_meshcat(
    host: str = LOCALHOST,
    port: int | None = None,
    say: Callable[[str], object] = print,
) -> Meshcat:
    """Starts to serve an empty 3D view, by default for this computer only.

    ``host`` * stands for all addresses; of ``port``, 1024 to 65535, the next free one
    is taken. Raises ScenarioError if the address cannot be used.
    """
    try:
        private = is_private(host)
    except (OSError, ValueError) as error:  # Meshcat's own error gives no reason.
        rule = f"cannot listen on {host}: {getattr(error, 'strerror', None) or error}"
        raise ScenarioError("--host", host, rule) from error
    ports = [None] if port is None else range(port, port + PORTS_TRIED)
    for candidate in ports:
        try:
            meshcat = Meshcat(MeshcatParams(host=host, port=candidate))
        except RuntimeError as error:
            problem = error
            continue
        if candidate != port:
            say(f"Port {port} is in use; the 3D view is on {candidate}.")
        if not private:
            say(
                f"! The 3D view listens on {host} without a password: everyone with "
                f"access to port {meshcat.port()} can watch."
            )
        return meshcat
    raise ScenarioError(
        "--port", port, f"no 3D view on {host}:{port or '7000...'}: {problem}"
    ) from problem


def interactive() -> bool:
    """Returns True if a user at the terminal can press keys."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def open_on_desktop(address: str) -> bool:
    """Opens a page or picture, and returns True, where there is a graphical desktop."""
    graphical = sys.platform == "darwin" or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    # Without a graphical desktop the "browser" would take over this terminal.
    return graphical and webbrowser.open(address)


class Served(Protocol):
    """A page that browsers open: Meshcat's, or the cockpit."""

    def web_url(self) -> str:
        """Returns the address."""

    def GetNumActiveConnections(self) -> int:
        """Returns the number of open pages."""


def await_viewer(page: Served, say: Callable[[str], object] = print) -> None:
    """Prints the address, and lets a user at the terminal open it."""
    say(f"Watch at {page.web_url()}")
    if not interactive():
        return
    if not open_on_desktop(page.web_url()):
        say(f"Open that address; the run begins then, or in {VIEWER_PATIENCE:g} s.")
    give_up = time.monotonic() + VIEWER_PATIENCE
    while page.GetNumActiveConnections() == 0 and time.monotonic() < give_up:
        time.sleep(0.1)


def keep_serving(say: Callable[[str], object]) -> None:
    """Keeps the view open until the user presses Enter or Ctrl-C."""
    say("The 3D view stays open. Press Enter to quit.")
    try:
        sys.stdin.readline()
    except KeyboardInterrupt:
        say("")
