"""A browser without a window, driven through Chromium's DevTools protocol."""

import base64
import io
import itertools
import json
import os
import shutil
import subprocess
import time
import urllib.request

import numpy as np
import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless",
    "--no-sandbox",  # Root, as in most containers, cannot have one.
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "--remote-allow-origins=*",
)
OFFLINE = "--host-resolver-rules=MAP * ~NOTFOUND"
SIZE = (800, 600)
"""Of the window [pixel]."""
PATIENCE = 60.0
"""With the browser [s of wall time]."""


class Page:
    """One page in a browser of its own."""

    def __init__(self, program, folder, url, flags):
        self._browser = subprocess.Popen(
            [
                program,
                *FLAGS,
                *flags,
                f"--user-data-dir={folder}",
                f"--window-size={SIZE[0]},{SIZE[1]}",
                url,
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._socket = None
        self._numbers = itertools.count(1)
        try:
            self._connect(folder)
        except BaseException:
            self.close()
            raise

    def _connect(self, folder):
        import websocket

        told = folder / "DevToolsActivePort"
        wait_for(lambda: told.is_file() and told.read_text().count("\n"))
        port = told.read_text().split()[0]

        def pages():
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as answer:
                return [tab for tab in json.load(answer) if tab["type"] == "page"]

        wait_for(pages)
        address = pages()[0]["webSocketDebuggerUrl"]
        self._socket = websocket.create_connection(address, timeout=PATIENCE)

    def call(self, method, **params):
        """Has the browser do something; the answer."""
        number = next(self._numbers)
        self._socket.send(
            json.dumps({"id": number, "method": method, "params": params})
        )
        while True:
            message = json.loads(self._socket.recv())
            if message.get("id") == number:
                assert "error" not in message, message
                return message["result"]

    def evaluate(self, expression):
        """The value of a JavaScript expression in the page."""
        answer = self.call(
            "Runtime.evaluate",
            expression=expression,
            returnByValue=True,
            awaitPromise=True,
        )
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def press(self, code, key):
        """Presses a key and lets it go."""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, code=code, key=key)

    def drag(self, *points):
        """Moves the mouse along points [pixel], its button down from first to last."""
        left = {"button": "left", "clickCount": 1}

        def mouse(kind, point, **more):
            x, y = map(float, point)
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

        mouse("mouseMoved", points[0])
        mouse("mousePressed", points[0], buttons=1, **left)
        for point in points[1:]:
            mouse("mouseMoved", point, buttons=1)
        mouse("mouseReleased", points[-1], buttons=0, **left)

    def wait_for(self, condition, what):
        """Waits until a function says yes."""
        wait_for(condition, what)

    def wait_until(self, expression):
        """Waits until a JavaScript expression is true."""
        wait_for(lambda: self.evaluate(expression), what=expression)

    def picture(self):
        """What is seen, shape (height, width, 3)."""
        from PIL import Image

        # Two frames later all that was asked for is on the screen.
        self.evaluate(
            "new Promise(done => { viewer.set_dirty(); requestAnimationFrame("
            "() => requestAnimationFrame(() => done(true))) })"
        )
        data = base64.b64decode(self.call("Page.captureScreenshot")["data"])
        return np.array(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)

    def close(self):
        if self._socket is not None:
            self._socket.close()
        self._browser.terminate()
        self._browser.wait()


def wait_for(condition, what="the browser"):
    give_up = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < give_up, f"waited {PATIENCE:g} s for {what}"
        time.sleep(0.05)


@pytest.fixture
def open_page(tmp_path_factory):
    """A function that opens an address in a new browser, offline if asked to."""
    pytest.importorskip("websocket", reason="websocket-client is not installed")
    asked = os.environ.get("CHROMIUM")
    program = asked or next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed")
    pages = []

    def open_page(url, offline=False):
        folder = tmp_path_factory.mktemp("profile")
        pages.append(Page(program, folder, url, [OFFLINE] if offline else []))
        return pages[-1]

    yield open_page
    for page in pages:
        page.close()
