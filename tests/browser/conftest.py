"""A browser without a window, driven by Playwright."""

import io
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
SIZE = {"width": 800, "height": 600}
"""Of the window [pixel]."""
FAST = ("--physics-step", "0.003")
"""Leaves more of the computer to the browser."""
PATIENCE = 60.0
"""With the browser [s of wall time]."""


def wait_for(condition, what):
    """Waits until a function says yes."""
    give_up = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < give_up, f"waited {PATIENCE:g} s for {what}"
        time.sleep(0.05)


class Run:
    """``atlas-drake`` in a process of its own, as at a terminal, and its page."""

    def __init__(self, folder, *arguments):
        self._printed = folder / "printed.txt"
        self._process = subprocess.Popen(
            [sys.executable, "-m", "atlas_drake", *arguments],
            stdout=self._printed.open("w"),
            stderr=subprocess.STDOUT,
        )
        wait_for(lambda: re.search(r"http://\S+", self.printed), "the address")
        self.url = re.search(r"http://\S+", self.printed)[0]

    @property
    def printed(self):
        return self._printed.read_text()

    def end(self):
        """Ends it by Ctrl-C."""
        self._process.send_signal(signal.SIGINT)
        assert self._process.wait(PATIENCE) == 0
        assert "Traceback" not in self.printed


def drag(page, *points):
    """Moves the mouse along points [pixel], its button down from first to last."""
    page.mouse.move(*points[0])
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*point)
    page.mouse.up()


def picture(page):
    """What is seen, shape (height, width, 3)."""
    from PIL import Image

    # Two frames later all that was asked for is on the screen.
    page.evaluate(
        "new Promise(done => { viewer.set_dirty(); requestAnimationFrame("
        "() => requestAnimationFrame(() => done(true))) })"
    )
    data = io.BytesIO(page.screenshot())
    return np.array(Image.open(data).convert("RGB")).astype(int)


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed"
    )
    asked = os.environ.get("CHROMIUM")
    program = asked or next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def open_page(browser):
    """A function that opens an address in a new window, offline if asked to."""
    pages = []

    def open_page(url, offline=False):
        pages.append(browser.new_page(viewport=SIZE, offline=offline))
        pages[-1].set_default_timeout(1e3 * PATIENCE)
        pages[-1].goto(url)
        return pages[-1]

    yield open_page
    for page in pages:
        page.close()
