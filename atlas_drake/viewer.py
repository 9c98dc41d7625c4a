"""The 3D view from the command line's side: serve it, wait for it, keep it open.

What it shows is in ``visualization``.
"""

from __future__ import annotations

import os
import socket
import sys
import time
import webbrowser

from pydrake.geometry import Meshcat, MeshcatParams

from atlas_drake.errors import ScenarioError
from atlas_drake.progress import Progress

VIEWER_PATIENCE = 15.0
"""How long the start waits for a browser [s]."""


ANYWHERE = "*"
"""The host that stands for all addresses of this computer."""
PORTS_TRIED = 100
"""How many ports from the one asked for on may be in use."""
LAST_PORT = 65535


def start_meshcat(host: str, port: int | None, progress: Progress) -> Meshcat:
    """Starts to serve an empty 3D view.

    Args:
        host: Address to listen on; ``*`` stands for all.
        port: Port to listen on; if it is in use the next free one is taken. None
            takes the first free one from 7000.
        progress: Is told when it is another port than the one asked for.

    Raises:
        ScenarioError: If that address cannot be had.
    """
    if host != ANYWHERE:
        _check_host(host)
    if port is None:
        candidates: list[int | None] = [None]
    else:
        candidates = [*range(port, min(port + PORTS_TRIED, LAST_PORT + 1))]
    for candidate in candidates:
        try:
            meshcat = Meshcat(MeshcatParams(host=host, port=candidate))
        except RuntimeError as error:
            problem = error
            continue
        if candidate != port:
            progress.say(f"Port {port} is in use; the 3D view is on {candidate}.")
        return meshcat
    raise ScenarioError(
        "--port", port, f"no 3D view on {host}:{port or '7000...'}: {problem}"
    ) from problem


def interactive() -> bool:
    """Whether somebody sits there who can press keys."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def _check_host(host: str) -> None:
    """Refuses an address that is not this computer's; Meshcat does not say why."""
    try:
        family, kind, _, _, address = socket.getaddrinfo(
            host, 0, type=socket.SOCK_STREAM
        )[0]
        with socket.socket(family, kind) as probe:
            probe.bind(address)
    except OSError as error:
        raise ScenarioError(
            "--host", host, f"cannot listen on {host}: {error.strerror}"
        ) from error


def open_on_desktop(address: str) -> bool:
    """Opens a page or picture where there is a graphical desktop to show it.

    Returns:
        Whether it was opened.
    """
    graphical = sys.platform == "darwin" or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    # Without a graphical desktop the "browser" would take over this terminal.
    return graphical and webbrowser.open(address)


def await_viewer(meshcat: Meshcat, progress: Progress) -> None:
    """Opens the browser, and gives it the time to show the start."""
    if not open_on_desktop(meshcat.web_url()):
        progress.say(
            f"Open that address; the run begins then, or in {VIEWER_PATIENCE:g} s."
        )
    give_up = time.monotonic() + VIEWER_PATIENCE
    while meshcat.GetNumActiveConnections() == 0 and time.monotonic() < give_up:
        time.sleep(0.1)


def keep_serving(progress: Progress) -> None:
    """Leaves the view open until somebody presses Enter or Ctrl-C."""
    progress.say("The 3D view stays open. Press Enter to quit.")
    try:
        sys.stdin.readline()
    except KeyboardInterrupt:
        progress.say("")
