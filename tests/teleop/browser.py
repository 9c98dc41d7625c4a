"""Chromium without a window, driven over its DevTools protocol."""

import base64
import json
import os
import socket
import struct
import subprocess
import time
import urllib.request

OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--no-first-run",
    "--remote-debugging-port=0",
    "--remote-allow-origins=*",
    "--window-size=500,400",
)
PATIENCE = 30.0


class Browser:
    """One page, open until ``close``."""

    def __init__(self, program, url, profile):
        self._process = subprocess.Popen(
            [program, *OPTIONS, f"--user-data-dir={profile}", url],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._number = 0
        try:
            self._connect(profile / "DevToolsActivePort", url)
        except BaseException:
            self.close()
            raise

    def _connect(self, port_file, url):
        give_up = time.monotonic() + PATIENCE
        while True:
            try:
                port = int(port_file.read_text().split()[0])
                tabs = json.load(
                    urllib.request.urlopen(f"http://127.0.0.1:{port}/json")
                )
                (page,) = [t for t in tabs if t["type"] == "page" and url in t["url"]]
                break
            except (OSError, ValueError, IndexError):
                if time.monotonic() > give_up:
                    raise
                time.sleep(0.1)
        path = page["webSocketDebuggerUrl"].split(str(port), 1)[1]
        self._socket = socket.create_connection(("127.0.0.1", port), PATIENCE)
        key = base64.b64encode(os.urandom(16)).decode()
        self._socket.sendall(
            f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
            "Sec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        self._stream = self._socket.makefile("rb")
        while self._stream.readline().strip():
            pass

    def call(self, method, **parameters):
        """Calls a method of the protocol and returns its result."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        data = json.dumps(message).encode()
        size = len(data)
        short = (
            bytes([0x80 | size]) if size < 126 else b"\xfe" + struct.pack(">H", size)
        )
        # The mask of zeros leaves the data as they are.
        self._socket.sendall(b"\x81" + short + bytes(4) + data)
        while True:
            answer = json.loads(self._receive())
            if answer.get("id") == self._number:
                return answer["result"]

    def _receive(self):
        data = b""
        while True:
            first, size = self._stream.read(2)
            size &= 127
            if size == 126:
                size = struct.unpack(">H", self._stream.read(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self._stream.read(8))[0]
            data += self._stream.read(size)
            if first & 0x80:
                return data

    def press(self, code, key):
        """Presses a key and lets it go."""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, code=code, key=key)

    def evaluate(self, script):
        """The value of a JavaScript expression."""
        result = self.call("Runtime.evaluate", expression=script, returnByValue=True)
        return result["result"].get("value")

    def close(self):
        """Ends the browser."""
        self._process.terminate()
        self._process.wait(PATIENCE)
