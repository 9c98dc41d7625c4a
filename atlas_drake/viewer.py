"""The 3D view from the command line's side: serve it, wait for it, keep it open.

What it shows is in ``visualization``.
"""

from __future__ import annotations

import os
import sys
import time
import webbrowser

from pydrake.geometry import Meshcat, MeshcatParams

from atlas_drake.errors import ScenarioError
from atlas_drake.progress import Progress

VIEWER_PATIENCE = 15.0
"""How long the start waits for a browser [s]."""


def start_meshcat(host: str, port: int | None) -> Meshcat:
    """Starts to serve an empty 3D view.

    Args:
        host: Address to listen on; ``*`` stands for all.
        port: Port to listen on; None takes the first free one from 7000.

    Raises:
        ScenarioError: If that address cannot be had.
    """
    try:
        return Meshcat(MeshcatParams(host=host, port=port))
    except RuntimeError as error:
        raise ScenarioError(
            "--port", port, f"no 3D view on {host}:{port or '7000...'}: {error}"
        ) from error


def interactive() -> bool:
    """Whether somebody sits there who can press keys."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def open_browser(meshcat: Meshcat) -> bool:
    """Opens the browser where there is a graphical desktop; says whether it did."""
    graphical = sys.platform == "darwin" or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    # Without a graphical desktop the "browser" would take over this terminal.
    return graphical and webbrowser.open(meshcat.web_url())


def await_viewer(meshcat: Meshcat, progress: Progress) -> None:
    """Opens the browser, and gives it the time to show the start."""
    if not open_browser(meshcat):
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
