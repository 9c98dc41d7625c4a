"""The page's process: it begins, says one line of what is wrong, and ends."""

import asyncio

import aiohttp
import pytest

from atlas_drake.clients.cockpit.link import start_process
from atlas_drake.clients.cockpit.wire import Notice

PATIENCE = 20.0
"""With a process [s]."""


@pytest.fixture
def start():
    """Starts a page's process, which ends after the test."""
    started = []

    def start(port=8370):
        link, process = start_process(
            "atlas_drake.clients.cockpit.page", "localhost", str(port)
        )
        started.append((link, process))
        return link, process

    yield start
    for link, process in started:
        link.close()
        process.wait(PATIENCE)


@pytest.mark.slow
def test_junk_makes_one_line_and_the_process_ends_with_its_line(start, capfd):
    link, process = start()
    (url,) = link.take(1, timeout=PATIENCE)

    async def go():
        async with (
            aiohttp.ClientSession(skip_auto_headers=["User-Agent"]) as client,
            client.ws_connect(f"{url}socket") as socket,
        ):
            for _ in range(10):
                await socket.send_str("\x1b[31m junk")
                await socket.send_bytes(b"\xff")
            link.send(Notice("hello"))
            while "hello" not in await socket.receive_str(timeout=PATIENCE):
                pass
            await asyncio.sleep(0.05)

    asyncio.run(go())
    assert link.take(1, timeout=PATIENCE) == [1]
    link.close()
    assert process.wait(PATIENCE) == 0
    printed = capfd.readouterr().err.splitlines()
    assert len(printed) == 1, printed
    assert printed[0].startswith("! The page dropped an input: ")


@pytest.mark.slow
def test_a_taken_port_is_passed_over(start):
    (first,) = start()[0].take(1, timeout=PATIENCE)
    port = first.rstrip("/").rpartition(":")[2]
    (second,) = start(port)[0].take(1, timeout=PATIENCE)
    assert second != first
