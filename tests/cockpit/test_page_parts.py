"""The parts of the page that need no browser: access, relay, history, figure."""

import asyncio

import msgpack
import pytest

from atlas_drake.cockpit.card import joint_cards
from atlas_drake.cockpit.observe import Observer
from atlas_drake.cockpit.orders import Order, Reply
from atlas_drake.cockpit.page.access import BURST, Access, Throttled
from atlas_drake.cockpit.page.desk import MOST_OPEN, STOP, Desk, Refused, Viewer
from atlas_drake.cockpit.page.figure import TARGET, Figure, spread
from atlas_drake.cockpit.page.panels import plan, strain, timeline
from atlas_drake.cockpit.page.relay import Pending, subject_of
from atlas_drake.cockpit.page.server import free_port
from atlas_drake.robot import load_robot

HOST = "localhost:8080"


CROSS_SITE = {"host": HOST, "sec_fetch_site": "cross-site"}
LINK = {"sec_fetch_mode": "navigate", "sec_fetch_dest": "document"}


def request(kind="http", **headers):
    named = [(k.replace("_", "-").encode(), v.encode()) for k, v in headers.items()]
    return {"type": kind, "headers": named}


@pytest.mark.parametrize(
    ("scope", "admitted"),
    [
        (request(host=HOST), True),
        (request(host="127.0.0.1:8080"), True),
        (request(host="[::1]:8080"), True),
        (request(host="evil.example:8080"), False),
        (request(host="localhost:80"), False),
        (request(), False),
        (request(host=HOST, origin=f"http://{HOST}"), True),
        (request(host=HOST, origin="http://evil.example"), False),
        (request(host=HOST, origin="null"), False),
        (request(host=HOST, sec_fetch_site="none"), True),
        (request(host=HOST, sec_fetch_site="same-origin"), True),
        (request(host=HOST, sec_fetch_site="same-site"), False),
        (request(**CROSS_SITE), False),
        (request(**CROSS_SITE, sec_fetch_mode="no-cors"), False),
        (request(**CROSS_SITE, **LINK), True),
        (request(**CROSS_SITE, **LINK, origin="http://evil.example"), False),
        (request(**CROSS_SITE, **{**LINK, "sec_fetch_dest": "iframe"}), False),
        (request("websocket", host=HOST, origin=f"http://{HOST}"), True),
        (request("websocket", host=HOST, origin="http://localhost:8081"), False),
        (request("websocket", host=HOST, user_agent="Mozilla/5.0"), False),
    ],
)
def test_only_the_page_itself_is_served(scope, admitted):
    assert Access("localhost", 8080, None).admits(scope) is admitted


@pytest.mark.parametrize("host", [HOST, "evil.example"])
def test_answers_are_not_for_other_sites(host):
    sent = []

    async def page(_scope, _receive, send):
        start = {"type": "http.response.start", "status": 200}
        await send({**start, "headers": [(b"content-type", b"text/html")]})
        await send({"type": "http.response.body", "body": b"the page"})

    async def send(message):
        sent.append(message)

    guarded = Access("localhost", 8080, None).middleware(page)
    asyncio.run(guarded(request(host=host), None, send))
    headers = dict(sent[0]["headers"])
    if host == HOST:
        assert headers[b"content-type"] == b"text/html"
        assert headers[b"content-security-policy"] == b"frame-ancestors 'none'"
        assert headers[b"cross-origin-resource-policy"] == b"same-origin"
        assert sent[1]["body"] == b"the page"
    else:
        assert sent[0]["status"] == 403


def test_a_page_for_other_computers_needs_its_token_to_steer():
    open_to_all = Access("0.0.0.0", 8080, "secret")
    assert open_to_all.allows("secret")
    assert not open_to_all.allows("")
    assert not open_to_all.allows("sécret")
    assert open_to_all.url == "http://localhost:8080/?token=secret"
    assert open_to_all.admits(request(host="robot.lab:8080"))
    assert Access("localhost", 8080, None).allows("")
    assert Access("::1", 8080, None).url == "http://[::1]:8080/"


def test_a_flood_ends_its_connection():
    async def receive():
        return {"type": "websocket.receive", "text": "x"}

    async def taken():
        throttled, count = Throttled(receive), 0
        while (await throttled())["type"] == "websocket.receive":
            count += 1
        return count

    assert BURST <= asyncio.run(taken()) < 2 * BURST


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


class FakeLink:
    def __init__(self):
        self.sent = []

    def send(self, value):
        self.sent.append(value)


@pytest.fixture
def link():
    return FakeLink()


@pytest.fixture
def desk(link):
    return Desk(link)


def seated(desk, may_steer=True):
    viewer = Viewer(may_steer)
    viewer.told = []
    viewer.tell = viewer.told.append
    desk.seat(viewer)
    return viewer


def test_one_viewer_steers_and_others_can_ask(desk):
    first, second = seated(desk), seated(desk)
    assert desk.steers is first
    with pytest.raises(Refused, match="watching"):
        asyncio.run(desk.order(second, "walk.stop"))
    desk.ask_to_steer(second)
    assert first.told
    desk.hand_over(first)
    assert desk.steers is second
    desk.remove_viewer(second)
    assert desk.steers is first


def test_a_watcher_can_stop_the_robot(desk, link):
    first, second, guest = seated(desk), seated(desk), seated(desk, may_steer=False)

    async def stop(viewer):
        asked = asyncio.ensure_future(desk.order(viewer, STOP))
        await asyncio.sleep(0)
        for order in link.sent:
            if isinstance(order, Order):
                desk.take(Reply(order.number, value="stopped"))
        return await asked

    assert asyncio.run(stop(second)) == "stopped"
    assert first.told == [f"{second.name} pressed STOP"]
    assert asyncio.run(stop(first)) == "stopped"
    assert len(first.told) == 1
    with pytest.raises(Refused, match="watching"):
        asyncio.run(stop(guest))


def test_who_has_no_token_never_steers(desk):
    watcher = seated(desk, may_steer=False)
    assert desk.steers is None
    desk.ask_to_steer(watcher)
    assert desk.steers is None
    assert "token" in watcher.told[0]


def test_an_order_is_answered_or_refused(desk, link):
    viewer = seated(desk)

    async def ask():
        asked = asyncio.ensure_future(desk.order(viewer, "walk.stop"))
        await asyncio.sleep(0)
        order = next(one for one in link.sent if isinstance(one, Order))
        desk.take(Reply(order.number, problem="no"))
        await asked

    with pytest.raises(Refused, match="no"):
        asyncio.run(ask())


def test_every_viewer_plots_without_steering(desk, link):
    first, second = seated(desk), seated(desk, may_steer=False)

    async def plot(viewer, names):
        asked = asyncio.ensure_future(desk.plot(viewer, names))
        await asyncio.sleep(0)
        desk.take(Reply(link.sent[-1].number))
        await asked

    asyncio.run(plot(first, ["a", "b"]))
    asyncio.run(plot(second, ["b", "c"]))
    assert link.sent[-1].values == {"names": ["a", "b", "c"]}
    desk.remove_viewer(first)
    assert link.sent[-1].values == {"names": ["b", "c"]}


def test_a_flood_of_orders_is_dropped(desk, link):
    viewer = seated(desk)

    async def flood():
        asked = [
            asyncio.ensure_future(desk.order(viewer, "walk.stop"))
            for _ in range(MOST_OPEN + 1)
        ]
        await asyncio.sleep(0)
        with pytest.raises(Refused, match="Too many"):
            await asked[-1]
        for one in asked:
            one.cancel()

    asyncio.run(flood())
    orders = [one for one in link.sent if isinstance(one, Order)]
    assert len(orders) == MOST_OPEN


def test_a_walk_ends_when_who_steers_it_goes(desk, link, driven):
    viewer = seated(desk)
    driven.do("walk.steer", forward=1.0)
    desk.take(Observer(driven.sim, driven.operator).read(0))
    desk.remove_viewer(viewer)
    assert Order("walk.stop") in link.sent


def test_states_show_the_run_and_each_event_once(driven, desk):
    observer = Observer(driven.sim, driven.operator)
    state = observer.read(0)
    assert state.behavior == "STAND"
    assert len(state.effort) == len(state.k_effort) == driven.sim.robot.num_joints
    weight = 9.81 * driven.sim.robot.mass
    driven.do("modes.request", name="FREEZE")
    driven.go(0.1)
    later = observer.read(state.event_count)
    assert sum(later.loads) == pytest.approx(weight, rel=0.25)
    assert [kind for _, kind, _ in later.events].count("behavior") == 1
    assert observer.read(later.event_count).events == ()
    driven.do("clock.reset", seed=3)
    anew = observer.read(later.event_count)
    assert anew.run == later.run + 1


def test_pictures_of_a_state_are_drawn(driven):
    observer = Observer(driven.sim, driven.operator)
    driven.go(0.04)
    driven.do("walk.plan_to", x=1.0, y=0.0)
    state = observer.read(0)
    svg = plan.draw(state, (0.26, 0.124))
    assert svg.count("<rect") == 2 + len(state.plan)
    assert svg.count("<circle") == 3
    joints = joint_cards(driven.sim.robot)
    name, _, share = strain.hottest(joints, state)[0]
    assert name in driven.sim.robot.joint_names
    assert 0.0 < share <= 1.0
    assert timeline.draw([], {}) == ""


@pytest.mark.parametrize("model", ["atlas", "atlas_v3"])
def test_the_figure_has_a_button_for_each_joint_and_limb(model):
    robot = load_robot(model)
    joints = joint_cards(robot)
    svg = Figure(joints).svg([0] * len(joints), "r_arm")
    limbs = {joint.limb for joint in joints}
    assert svg.count('role="button"') == len(joints) + len(limbs)
    places = spread([joint.place for joint in joints])
    nearest = min(
        (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2
        for i, a in enumerate(places)
        for b in places[i + 1 :]
    )
    assert nearest**0.5 > 2.0 * TARGET


def test_the_next_free_port_is_taken():
    import socket

    with socket.socket() as taken:
        taken.bind(("localhost", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert free_port("localhost", port) > port
