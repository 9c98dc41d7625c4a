"""What is passed on of Meshcat, by a Meshcat that drops connections and forgets."""

import asyncio
import contextlib

import aiohttp
import msgpack
import pytest
from aiohttp import web

from atlas_drake.clients.cockpit.page import relay
from atlas_drake.clients.cockpit.page.relay import subject_of
from atlas_drake.clients.cockpit.page.sockets import Pending

from .page_of import served

SCRIPT = "ab" * 32
MESHES = [f"{number:064x}" for number in range(1, 31)]


class Meshcat:
    """A stand-in whose first answer for each file is dropped half-way."""

    def __init__(self):
        self.asked, self.at_once, self.most_at_once = [], 0, 0
        self.forgets = False
        self.sockets = []

    def app(self):
        app = web.Application()
        app.router.add_get("/", self.root)
        app.router.add_get("/cas-v1/{name}", self.file)
        return app

    async def root(self, request):
        if request.headers.get("Upgrade"):
            socket = web.WebSocketResponse()
            await socket.prepare(request)
            self.sockets.append(socket)
            for name in MESHES:
                uri = f"cas-v1/{name}"
                await socket.send_bytes(
                    msgpack.packb({"type": "set_object", "path": "/a", "uri": uri})
                )
            self.heard = [message async for message in socket]
            return socket
        return web.Response(text=f'<script src="cas-v1/{SCRIPT}"></script>')

    async def file(self, request):
        name = request.match_info["name"]
        self.asked.append(name)
        self.at_once += 1
        self.most_at_once = max(self.most_at_once, self.at_once)
        await asyncio.sleep(0.005)
        self.at_once -= 1
        if self.forgets:
            raise web.HTTPNotFound
        if self.asked.count(name) == 1:
            answer = web.StreamResponse(headers={"Content-Length": "100"})
            await answer.prepare(request)
            await answer.write(b"half")
            request.transport.abort()
            return answer
        return web.Response(body=name.encode(), content_type="model/gltf")


@contextlib.asynccontextmanager
async def relayed():
    meshcat = Meshcat()
    runner = web.AppRunner(meshcat.app(), shutdown_timeout=0.1)
    await runner.setup()
    site = web.TCPSite(runner, "localhost", 0)
    await site.start()
    port = site._server.sockets[0].getsockname()[1]
    try:
        async with served() as page:
            page.take(page.simulation.run(meshcat_port=port))
            yield page, meshcat
    finally:
        await runner.cleanup()


@pytest.fixture(autouse=True)
def _quick(monkeypatch):
    monkeypatch.setattr(relay, "PAUSE", 0.01)


async def fetched(page, path):
    async with page.client.get(page.url + path) as answer:
        return answer.status, await answer.read()


def test_each_file_is_fetched_once_and_again_if_its_connection_is_dropped():
    async def go():
        async with relayed() as (page, meshcat):
            pictures = await page.client.ws_connect(page.url + "/meshcat")
            for _ in MESHES:
                await pictures.receive_bytes(timeout=5.0)
            wanted = [f"/cas-v1/{name}" for name in MESHES] * 3
            answers = await asyncio.gather(*(fetched(page, path) for path in wanted))
            assert answers == [(200, name.encode()) for name in MESHES] * 3
            assert sorted(meshcat.asked) == sorted(MESHES * 2)
            assert meshcat.most_at_once <= relay.AT_A_TIME
            # Meshcat forgets them with their objects; a slow page still gets them.
            meshcat.forgets = True
            assert await fetched(page, wanted[0]) == (200, MESHES[0].encode())
            await pictures.send_bytes(b"to meshcat")
            await pictures.send_str("to meshcat")
            await pictures.close()
            await asyncio.sleep(0.05)
            assert meshcat.heard == []

    asyncio.run(go())


def test_the_script_is_passed_on():
    async def go():
        async with relayed() as (page, meshcat):
            assert await fetched(page, "/meshcat.js") == (200, SCRIPT.encode())
            assert meshcat.asked == [SCRIPT] * 2
            answer = await page.client.get(page.url + "/meshcat.js")
            assert answer.headers["Cache-Control"] == "no-cache"

    asyncio.run(go())


def test_meshcat_is_asked_only_for_what_it_has_named():
    async def go():
        async with relayed() as (page, meshcat):
            for name in ("ff" * 32, "..%2f", "x", "0" * 5000):
                assert (await fetched(page, f"/cas-v1/{name}"))[0] == 404
            assert meshcat.asked == []

    asyncio.run(go())


@pytest.mark.slow
def test_a_file_that_does_not_come_is_asked_for_again_later():
    async def go():
        async with relayed() as (page, meshcat):
            meshcat.forgets = True
            pictures = await page.client.ws_connect(page.url + "/meshcat")
            await pictures.receive_bytes(timeout=5.0)
            path = f"/cas-v1/{MESHES[0]}"
            assert (await fetched(page, path))[0] == 502
            meshcat.forgets = False
            assert await fetched(page, path) == (200, MESHES[0].encode())

    asyncio.run(go())


def test_only_the_latest_pose_of_an_object_is_sent():
    def pose(path, x):
        return msgpack.packb({"type": "set_transform", "path": path, "matrix": [x]})

    made = msgpack.packb({"type": "set_object", "path": "/a"})
    pending = Pending()
    for message in (pose("/a", 1), made, pose("/b", 1), pose("/a", 2), made):
        pending.put(message, subject_of(message))

    async def all_of_it():
        return [await pending.take() for _ in range(4)]

    assert asyncio.run(all_of_it()) == [made, pose("/b", 1), pose("/a", 2), made]
    for junk in (b"", b"\xff\xff", b"\xc1", msgpack.packb([1, 2])):
        assert subject_of(junk) is None


def test_a_picture_reaches_every_view():
    async def go():
        async with relayed() as (page, _meshcat):
            views = [
                await page.client.ws_connect(page.url + "/meshcat") for _ in range(2)
            ]
            for view in views:
                message = await view.receive(timeout=5.0)
                assert message.type is aiohttp.WSMsgType.BINARY

    asyncio.run(go())
