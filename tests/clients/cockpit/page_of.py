"""A page's server at a free port, with a stand-in for the simulation."""

import asyncio
import contextlib
import json

import aiohttp
import numpy as np

from atlas_drake.clients.cockpit.page.access import Access
from atlas_drake.clients.cockpit.page.server import Server, serving
from atlas_drake.clients.cockpit.page.session import Session
from atlas_drake.clients.cockpit.wire import Answer, Frame, Request, Robot, Run
from atlas_drake.clients.steering.joint_motion import JointFacts
from atlas_drake.clients.steering.reports import Reports
from atlas_drake.messages import AtlasSimInterfaceState, Behavior
from atlas_drake.messages.commands import commands_at_start
from atlas_drake.planning.footholds import Gait
from atlas_drake.robot import load_robot

PATIENCE = 10.0
"""With the server [s]."""
TOKEN = "secret"


class Clock:
    """A clock that a test sets."""

    def __init__(self):
        self.time = 0.0

    def __call__(self):
        return self.time


class Simulation:
    """Answers requests at once, unless it is ``silent``."""

    def __init__(self):
        self.got, self.answers, self.silent = [], {}, False
        self.robot = load_robot("atlas")
        self.report = AtlasSimInterfaceState()
        self.report.current_behavior = self.report.desired_behavior = Behavior.STAND
        for pose, y in zip(self.report.foot_pos_est, (0.12, -0.12), strict=True):
            pose.position.y = y

    def send(self, value):
        self.got.append(value)
        if isinstance(value, Request) and value.number and not self.silent:
            answer = self.answers.get(value.name, "done")
            made = (
                {"problem": str(answer)}
                if isinstance(answer, Exception)
                else {"value": answer}
            )
            asyncio.get_running_loop().call_soon(
                self.server.take, Answer(value.number, **made)
            )

    @property
    def requests(self):
        return [one for one in self.got if isinstance(one, Request)]

    def run(self, **changes):
        robot = Robot(JointFacts.of(self.robot), Gait())
        values = {"page": b'{"title":"a run"}', "meshcat_port": 1, "robot": robot}
        return Run(**values | changes)

    def frame(self, time=1.0, **changes):
        values = {
            "page": b'{"time":%.2f}' % time,
            "run": 0,
            "time": time,
            "rate": 1.0,
            "behavior": "STAND",
            "user": 0.0,
            "reports": Reports(
                self.report,
                commands_at_start(self.robot, Behavior.STAND).joints,
                np.array(self.robot.stand_prep),
            ),
        }
        return Frame(**values | changes)


class Browser:
    """One page's websocket."""

    def __init__(self, socket):
        self.socket = socket
        self._numbers = 0

    async def hear(self, kind):
        """Returns the next message of a kind."""
        async with asyncio.timeout(PATIENCE):
            while True:
                message = json.loads(await self.socket.receive_str())
                if message["kind"] == kind:
                    return message

    async def ask(self, what, /, **values):
        """Sends a request, and returns its number."""
        self._numbers += 1
        request = {"do": what, "number": self._numbers, "with": values}
        await self.socket.send_str(json.dumps(request))
        return self._numbers

    async def do(self, what, /, **values):
        """Returns the value of the answer, or "!" and the problem."""
        number = await self.ask(what, **values)
        while (answer := await self.hear("answer"))["number"] != number:
            pass
        return answer["value"] if "value" in answer else f"! {answer['problem']}"

    async def closed(self):
        """Waits for the end of the connection, and returns its code."""
        async with asyncio.timeout(PATIENCE):
            async for _message in self.socket:
                pass
        return self.socket.close_code


class Served:
    """A server and its simulation, and what opens pages of it."""

    def __init__(self, server, session, simulation, port, client):
        self.server, self.session, self.simulation = server, session, simulation
        self.take, self.port, self.client = server.take, port, client
        self.url = f"http://localhost:{port}"

    async def open(self, token=TOKEN):
        query = f"?token={token}" if token else ""
        return Browser(await self.client.ws_connect(f"{self.url}/socket{query}"))


@contextlib.asynccontextmanager
async def served(*, token=TOKEN, clock=None, log=False):
    """Serves a page with a run and a frame."""
    session = Session(*([clock] if clock else []))
    simulation = Simulation()
    server = Server(Access("localhost", token), simulation.send, session)
    simulation.server = server
    connector = aiohttp.TCPConnector(force_close=True)
    no_agent = {"skip_auto_headers": ["User-Agent"]}
    async with (
        serving(server, "localhost", 8300) as port,
        aiohttp.ClientSession(connector=connector, **no_agent) as client,
    ):
        if log:
            server.take(simulation.run(robot=None))
            server.take(simulation.frame(reports=None))
        else:
            server.take(simulation.run())
            server.take(simulation.frame())
        yield Served(server, session, simulation, port, client)
