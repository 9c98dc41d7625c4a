"""The page's server at a real port, attacked and used, with a stand-in simulation."""

import asyncio
import gc
import json
import logging

import aiohttp
import pytest
from yarl import URL

from atlas_drake.clients.cockpit.page import actions, sockets
from atlas_drake.clients.cockpit.page.__main__ import OneLine, Rarely
from atlas_drake.clients.cockpit.page.access import BURST
from atlas_drake.clients.cockpit.page.actions import MOST_OPEN
from atlas_drake.clients.cockpit.page.server import MOST_BYTES, MOST_BYTES_WATCHING
from atlas_drake.clients.cockpit.page.session import MOST_VIEWERS, SILENCE
from atlas_drake.clients.cockpit.wire import ACKNOWLEDGED, Notice, Settings
from atlas_drake.clients.steering.pilot import Pilot

from .page_of import Clock, served


def lines_of(caplog):
    return [r for r in caplog.records if r.levelno >= logging.WARNING]


# ---- what a page gets ----------------------------------------------------------------


def test_a_page_gets_run_settings_history_and_frames():
    async def go():
        async with served() as page:
            page.take(Settings(b'{"name":"x"}'))
            browser = await page.open()
            assert (await browser.hear("run"))["run"] == {"title": "a run"}
            assert (await browser.hear("settings"))["settings"] == {"name": "x"}
            assert len((await browser.hear("history"))["moments"]) == 1
            assert (await browser.hear("session"))["control"] == "you"
            page.take(page.simulation.frame(2.0, events=((2.0, "fall", "ouch"),)))
            assert (await browser.hear("events"))["events"] == [[2.0, "fall", "ouch"]]
            frame = await browser.hear("frame")
            assert frame["frame"] == {"time": 2.0}
            assert frame["walking"]["direction"] is None
            assert frame["walking"]["gait"]["stride"] > 0.0
            assert frame["poses"] == ["STAND_PREP"]
            page.take(Notice("hello"))
            assert (await browser.hear("notice"))["text"] == "hello"
            assert page.simulation.got.count(ACKNOWLEDGED) == 2
            assert 1 in page.simulation.got  # Number of open pages.
            await browser.socket.close()
            while page.session.viewers:
                await asyncio.sleep(0.01)
            assert page.simulation.got[-1] == 0

    asyncio.run(go())


def test_requests_reach_the_run_and_their_answers_the_browser():
    async def go():
        async with served() as page:
            simulation = page.simulation
            simulation.answers = {"back": 3.5, "reset": ValueError("not now")}
            browser = await page.open()
            assert await browser.do("back", seconds=2) == 3.5
            assert simulation.requests[-1].values == {"seconds": 2}
            assert await browser.do("reset", seed=None) == "! not now"
            assert simulation.requests[-1].values == {"seed": None}
            command = {"behavior": "STAND"}
            await browser.do("message", atlas_sim_interface_command=command)
            sent = simulation.requests[-1]
            assert sent.name == "message"
            assert sent.values == {"atlas_sim_interface_command": command}

    asyncio.run(go())


def test_the_pilot_makes_messages_of_what_is_asked():
    async def go():
        async with served() as page:
            simulation = page.simulation
            browser = await page.open()
            assert await browser.do("behave", name="FREEZE") is True
            sent = simulation.requests[-1]
            assert sent.name == "message"
            assert sent.values["atlas_sim_interface_command"]["behavior"] in (
                "FREEZE",
                1,
            )
            assert (await browser.do("gait", stride=0.2))["stride"] == 0.2
            assert await browser.do("plan_to", x=1.0, y=0.0) > 2
            simulation.answers = {"message": ValueError("refused by the door")}
            assert await browser.do("behave", name="STAND") == "! refused by the door"
            assert "! " in await browser.do("behave", name="FLY")

    asyncio.run(go())


def test_a_policy_that_has_its_joints_is_steered_in_place_of_a_walk():
    async def go():
        async with served() as page:
            browser = await page.open()
            page.take(page.simulation.frame(1.1, steered_policy=(0.5, 0.0, 0.0)))
            while (seen := await browser.hear("frame"))["frame"]["time"] < 1.1:
                pass
            assert seen["walking"]["direction"] == [0.5, 0.0, 0.0]
            await browser.do("walk", forward=1)
            asked = page.simulation.requests[-1]
            assert asked.name == "steer_policy"
            assert asked.values == {"forward": 1, "left": 0.0, "turn": 0.0}
            await browser.do("stop_walking")
            assert page.simulation.requests[-1].values["forward"] == 0.0
            await browser.do("release_control")
            assert page.simulation.requests[-1].name == "steer_policy"

    asyncio.run(go())


def test_set_points_move_while_the_run_goes_on():
    async def go():
        async with served() as page:
            browser, simulation = await page.open(), page.simulation
            joint = simulation.robot.joint_names[0]
            await browser.do("share", joints=[joint], k_effort=255)
            page.take(simulation.frame(1.5, rate=0.0))
            await browser.do("move", joint=joint, position=0.2)
            before = len(simulation.requests)
            await asyncio.sleep(0.1)
            assert len(simulation.requests) == before  # Paused.
            page.take(simulation.frame(1.6))
            await asyncio.sleep(0.15)
            moved = simulation.requests[before:]
            assert len(moved) >= 3
            assert {(one.number, one.name) for one in moved} == {(0, "message")}

    asyncio.run(go())


def test_a_stop_before_the_first_frame_is_not_lost():
    async def go():
        async with served() as page:
            page.take(page.simulation.run())
            browser = await page.open()
            await browser.ask("stop")
            await browser.hear("stopping")
            page.take(page.simulation.frame())
            assert (await browser.hear("answer"))["value"] is True
            assert page.simulation.requests[-1].name == "message"

    asyncio.run(go())


def test_a_pilot_that_fails_does_not_hold_the_page_up(monkeypatch, caplog):
    def fail(_pilot, _dt):
        raise RuntimeError("a mistake")

    async def go():
        async with served() as page:
            monkeypatch.setattr(Pilot, "update", fail)
            browser = await page.open()
            for time in (2.0, 3.0):
                page.take(page.simulation.frame(time))
                while (await browser.hear("frame"))["frame"]["time"] != time:
                    pass
            await asyncio.sleep(0.05)
            assert await browser.do("hold") == "! RuntimeError: a mistake"
            assert await browser.do("step") == "done"

    asyncio.run(go())
    said = [record.getMessage() for record in lines_of(caplog)]
    assert said == ["RuntimeError: a mistake"] * 2  # Unasked, and asked.


def test_handlers_of_one_controller_take_turns_and_stop_does_not_wait():
    async def go():
        async with served() as page:
            browser, simulation = await page.open(), page.simulation
            simulation.silent = True
            await browser.ask("step")
            await browser.ask("back")
            await browser.ask("stop")
            await browser.hear("stopping")
            names = [one.name for one in simulation.requests]
            assert names == ["step", "stop_hand", "message"]

    asyncio.run(go())


def test_a_run_that_does_not_answer_is_given_up(monkeypatch):
    async def go():
        async with served() as page:
            browser, page.simulation.silent = await page.open(), True
            assert "does not answer" in await browser.do("step")

    monkeypatch.setattr(actions, "PATIENCE", 0.05)
    asyncio.run(go())


def test_a_log_is_played_and_not_commanded():
    async def go():
        async with served(log=True) as page:
            browser, watcher = await page.open(), await page.open()
            assert await browser.do("seek", time=1.0) == "done"
            assert await watcher.do("columns", names=["a"]) == "done"
            for name, values in (
                ("walk", {"forward": 0, "left": 0, "turn": 0}),
                ("stop", {}),
            ):
                assert "A log is shown" in await browser.do(name, **values)

    asyncio.run(go())


# ---- control -------------------------------------------------------------------------


def test_one_viewer_has_control_and_closing_it_ends_its_walk():
    async def go():
        async with served() as page:
            first, second = await page.open(), await page.open()
            assert "watching" in await second.do("pause", on=True)
            await first.do("walk", forward=1, left=0, turn=0)
            await second.do("take_control")
            await first.socket.close()
            while (await second.hear("session"))["control"] != "you":
                pass
            page.take(page.simulation.frame(2.0))
            assert (await second.hear("frame"))["walking"]["direction"] is None
            assert await second.do("pause", on=True) == "done"

    asyncio.run(go())


def test_control_goes_from_who_is_silent_to_who_asks():
    async def go():
        clock = Clock()
        async with served(clock=clock) as page:
            first, second = await page.open(), await page.open()
            clock.time = SILENCE - 1.0
            await first.do("pause", on=True)
            await second.do("take_control")
            clock.time = SILENCE + 1.0
            page.session.pass_on()
            assert "watching" in await second.do("step")
            clock.time = 2.0 * SILENCE
            page.session.pass_on()
            assert await second.do("step") == "done"
            assert "watching" in await first.do("step")

    asyncio.run(go())


def test_a_watcher_with_the_token_can_stop_and_another_cannot():
    async def go():
        async with served() as page:
            first, second = await page.open(), await page.open()
            guest = await page.open(token="")
            assert (await guest.hear("session"))["may_steer"] is False
            assert "token" in await guest.do("stop")
            assert "token" in await guest.do("take_control")
            assert "token" in await guest.do("pause", on=True)
            assert page.simulation.requests == []
            assert await second.do("stop") is True
            for viewer in (first, guest):
                await viewer.hear("stopping")
            assert page.simulation.requests[-1].name == "message"

    asyncio.run(go())


# ---- attacks -------------------------------------------------------------------------


@pytest.mark.parametrize("path", ["/", "/socket", "/assets/page.js", "/no/such/page"])
def test_foreign_sites_stay_out(path):
    async def go():
        async with served() as page:
            for headers in (
                {"Origin": "http://evil.example"},
                {"Sec-Fetch-Site": "cross-site"},
                {"Host": "evil example"},
            ):
                answer = await page.client.get(page.url + path, headers=headers)
                assert answer.status in (400, 403)
            upgrade = {"Host": f"localhost:{page.port}", "User-Agent": "Mozilla"}
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await page.client.ws_connect(page.url + path, headers=upgrade)

    asyncio.run(go())


def test_every_answer_says_for_whom_it_is():
    async def go():
        async with served() as page:
            for path in ("/", "/no/such/page", "/cas-v1/ab"):
                answer = await page.client.get(page.url + path)
                policy = answer.headers["Content-Security-Policy"]
                assert "frame-ancestors 'none'" in policy
                assert "script-src 'self';" in policy
                assert f"ws://localhost:{page.port}" in policy
                resource = answer.headers["Cross-Origin-Resource-Policy"]
                assert resource == "same-origin"
            away = {"Host": "localhost:9000"}
            answer = await page.client.get(page.url, headers=away)
            assert answer.status == 200

    asyncio.run(go())


def test_nothing_can_be_uploaded():
    async def go():
        async with served() as page:
            for path in ("/", "/socket", "/assets/page.js", "/upload"):
                answer = await page.client.post(page.url + path, data=bytes(100))
                assert answer.status in (403, 404, 405)
            assert not any(
                route.method not in ("GET", "HEAD")
                for route in page.server.app().router.routes()
            )

    asyncio.run(go())


@pytest.mark.slow
def test_pages_that_are_only_fetched_leave_nothing():
    async def go():
        async with served() as page:
            await page.client.get(page.url)
            gc.collect()
            before = len(gc.get_objects())
            for _ in range(50):
                async with page.client.get(page.url) as answer:
                    await answer.read()
            await asyncio.sleep(0.05)
            gc.collect()
            assert len(gc.get_objects()) - before < 500
            assert page.session.viewers == []

    asyncio.run(go())


def test_big_messages_end_their_connection_alone(caplog):
    async def go():
        async with served() as page:
            first, second, third = [await page.open() for _ in range(3)]
            big = json.dumps({"do": "step", "pad": "x" * MOST_BYTES_WATCHING})
            await second.socket.send_str(big)
            await second.closed()
            await third.socket.send_bytes(bytes(MOST_BYTES_WATCHING + 1))
            await third.closed()
            text = "x" * (MOST_BYTES // 2)
            assert await first.do("check", changes={}, text=text) == "done"
            other = await page.open()
            await first.socket.send_str("x" * (2 * MOST_BYTES))
            await first.closed()
            assert await other.do("take_control") is True
            assert await other.do("step") == "done"

    asyncio.run(go())
    assert len(lines_of(caplog)) == 3


def test_a_flood_ends_its_connection(caplog):
    async def go():
        async with served() as page:
            flooding, other = await page.open(), await page.open()
            for _ in range(2 * BURST):
                try:
                    await flooding.ask("step")
                except ConnectionError:
                    break
            await flooding.closed()
            assert await other.do("take_control") is True
            assert await other.do("step") == "done"

    asyncio.run(go())
    assert len(lines_of(caplog)) == 1


def test_too_many_open_requests_are_dropped_but_stop_is_not():
    async def go():
        async with served() as page:
            first, second = await page.open(), await page.open()
            page.simulation.silent = True
            for _ in range(MOST_OPEN):
                await first.ask("step")
            assert "Too many" in await first.do("step")
            await first.ask("stop")
            await first.hear("stopping")
            # One viewer does not use up what another one may ask.
            page.simulation.silent = False
            assert await second.do("stop") is True

    asyncio.run(go())


JUNK = [
    "",
    "{",
    "null",
    "[]",
    "7",
    '"x"',
    "[" * 5000,
    '{"do": NaN}',
    '{"do": 1e999}',
    '{"do": "step", "with": {"a": NaN}}',
    '{"do": "step", "number": "one"}',
    '{"do": "step", "with": [1]}',
    '{"do": ["step"]}',
    '{"do": "\\ud800"}',
    "\x00\x1b[31m",
]
WRONG = [
    ("walk", {"forward": [1], "left": 0, "turn": 0}),
    ("walk", {"forward": True}),
    ("walk", {"self": 1}),
    ("gait", {"stride": "long"}),
    ("share", {"joints": "l_arm_elx", "k_effort": 255}),
    ("share", {"joints": [1], "k_effort": 255}),
    ("move", {"joint": "no_such_joint", "position": 0.0}),
    ("move", {"joint": "l_arm_elx"}),
    ("save_pose", {"name": None}),
    ("stop", {"now": True}),
]


def test_junk_is_dropped_with_one_line_and_wrong_requests_are_answered(caplog):
    async def go():
        async with served() as page:
            browser = await page.open()
            for junk in JUNK:
                await browser.socket.send_str(junk)
            await browser.socket.send_bytes(b"\xff\x00")
            for name, values in WRONG:
                answer = await browser.do(name, **values)
                assert str(answer).startswith("! "), (name, values)
            assert page.simulation.requests == []
            assert await browser.do("step") == "done"

    asyncio.run(go())
    assert len(lines_of(caplog)) == 1
    assert lines_of(caplog)[0].exc_info is None


def test_broken_http_makes_no_traceback(caplog):
    async def go():
        async with served() as page:
            for junk in (
                b"\x00\xff\r\n\r\n",
                b"GET /\r\n\r\n",
                b"GET / HTTP/1.1\r\n\r\n",
            ):
                reader, writer = await asyncio.open_connection("localhost", page.port)
                writer.write(junk)
                await asyncio.wait_for(reader.read(100), 5.0)
                writer.close()
            assert (await page.client.get(page.url)).status == 200

    asyncio.run(go())
    lines = [OneLine().format(record) for record in lines_of(caplog)]
    assert len(lines) <= 3
    assert all(line.startswith("! The page dropped an input: ") for line in lines)
    assert all(line.isprintable() and len(line) <= 200 for line in lines)


def test_bad_requests_are_said_once_and_then_counted(caplog):
    async def go():
        async with served() as page:
            for _ in range(25):
                answer = await page.client.get(f"{page.url}/{'a' * 9000}")
                assert answer.status == 400

    asyncio.run(go())
    rarely = Rarely()
    said = [OneLine().format(one) for one in lines_of(caplog) if rarely.filter(one)]
    assert len(said) == 2
    assert said[1].endswith("(10 like it so far)")
    assert max(map(len, said)) <= 200


@pytest.mark.parametrize(
    ("name", "status"),
    [("page.js", 200), (5000 * "a", 404), ("..%2fserver.py", 404), ("%00", 404)],
)
def test_an_asset_is_one_of_the_files_that_are_there(name, status, caplog):
    async def go():
        async with served() as page:
            address = URL(f"{page.url}/assets/{name}", encoded=True)
            assert (await page.client.get(address)).status == status

    asyncio.run(go())
    assert lines_of(caplog) == []


def test_at_most_so_many_pages_are_open():
    async def go():
        async with served() as page:
            opened = [await page.open() for _ in range(MOST_VIEWERS)]
            refused = await page.open()
            notice = await refused.hear("notice")
            assert "Too many pages" in notice["text"]
            await refused.closed()
            assert len(page.session.viewers) == MOST_VIEWERS
            await opened[0].socket.close()
            while len(page.session.viewers) == MOST_VIEWERS:
                await asyncio.sleep(0.01)
            await (await page.open()).hear("session")

    asyncio.run(go())


def test_a_browser_that_takes_nothing_holds_nobody_up(monkeypatch):
    monkeypatch.setattr(sockets, "MOST_BYTES_WAITING", 1_000_000)

    async def go():
        async with served() as page:
            stuck, other = await page.open(), await page.open()
            stuck.socket._response.connection.transport.pause_reading()
            text = "x" * 20_000
            for step in range(6000):
                events = ((2.0, "fall", text),)
                page.take(page.simulation.frame(2.0 + step, events=events))
                if step % 10 == 0:
                    await other.hear("frame")
                if len(page.session.viewers) == 1:
                    break
            assert len(page.session.viewers) == 1
            page.take(page.simulation.frame(9999.0))
            while (await other.hear("frame"))["frame"]["time"] != 9999.0:
                pass

    asyncio.run(go())
