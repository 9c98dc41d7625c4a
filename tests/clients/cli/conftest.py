"""What the tests of the command line share."""

import base64
import re
import signal
import sys

import pytest

from atlas_drake.clients.cli.progress import Progress

COMMAND = [sys.executable, "-m", "atlas_drake"]


@pytest.fixture
def ctrl_c(monkeypatch):
    """Presses Ctrl-C in each piece of a run or replay."""

    def interrupt(*_arguments):
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Progress, "update", interrupt)
    return interrupt


@pytest.fixture
def hide_package(monkeypatch):
    """Makes imports of a package fail, and of the named modules that use it."""

    def hide(package, *users):
        for name in list(sys.modules):
            if name.split(".")[0] == package or name in users:
                monkeypatch.delitem(sys.modules, name)
        monkeypatch.setitem(sys.modules, package, None)

    return hide


def animation_in(page):
    """The animation in a recorded page."""
    blobs = re.findall(r"base64,([A-Za-z0-9+/=]+)", page.read_text())
    messages = [base64.b64decode(blob) for blob in blobs]
    (animation,) = [message for message in messages if b"set_animation" in message]
    return animation
