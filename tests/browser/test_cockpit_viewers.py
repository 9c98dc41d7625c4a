"""Several viewers of the cockpit, bad ones too, in a real browser."""

import contextlib
import json
import re
import socket
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread

import pytest

from .conftest import DRAW_WHEN_ASKED, CockpitPage, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.browser]


def test_a_second_viewer_watches_asks_and_steers(page, watching):
    page.steering_says("You steer")
    watching.steering_says("Ask to steer")
    watching.press("FREEZE")
    watching.tells("You are watching: ask for control first")
    assert watching.mode == "STAND"
    watching.press("Steering")
    page.steering_says("Hand over")
    watching.steering_says("Asked …")
    page.press("Steering")
    watching.steering_says("You steer")
    page.steering_says("Ask to steer")
    watching.press("FREEZE")
    page.becomes("FREEZE")
    watching.press("Steering")
    page.steering_says("Steer")  # Nobody has control.


def test_closing_the_page_ends_a_walk_and_loses_nothing(page, watching):
    page.key("i")
    page.becomes("WALK")
    page.close()
    watching.steering_says("Steer")
    watching.becomes("STAND")
    page.open()
    page.steering_says("You steer")
    assert "STAND -> WALK" in page.events()


def test_a_flood_holds_nobody_else_up(page, watching):
    watching.page.evaluate(
        """() => { for (let i = 0; i < 2000; i++) {
          cockpit.page.do("share", { joints: ["l_arm_shx"], k_effort: 255 },
                          { quiet: true }).catch(() => {});
        } }"""
    )
    page.goes_on()
    page.press("FREEZE")
    page.becomes("FREEZE")
    assert not any(page.frame(".command.k_effort"))
    # Its connection was closed; it comes back, and may watch.
    wait_for(lambda: watching.mode == "FREEZE", "the connection")


# ---- other sites -----------------------------------------------------------------


def test_a_foreign_page_reaches_nothing(page, teleop, browser):
    foreign = browser.new_page()
    foreign.goto("about:blank")
    for path in ("socket", "meshcat"):
        reached = foreign.evaluate(
            """(address) => new Promise(done => {
              const socket = new WebSocket(address);
              socket.onopen = () => done(true);
              socket.onerror = () => done(false);
            })""",
            teleop.url.replace("http", "ws") + path,
        )
        assert not reached
    foreign.close()


@pytest.fixture
def foreign_site(teleop, tmp_path):
    """The address of a site that loads and frames the page, and links to it."""
    (tmp_path / "index.html").write_text(
        f"""<script type="module" src="{teleop.url}assets/page.js"></script>
        <iframe src="{teleop.url}"></iframe><a href="{teleop.url}">the robot</a>"""
    )
    handler = partial(SimpleHTTPRequestHandler, directory=tmp_path)
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost"])
def test_a_foreign_site_links_to_the_page_and_no_more(
    name, page, foreign_site, browser
):
    """The name of the same host makes it a cross-site, or only a cross-origin."""
    foreign = browser.new_page()
    foreign.add_init_script(DRAW_WHEN_ASKED)
    foreign.goto(foreign_site.replace("127.0.0.1", name))
    assert foreign.evaluate("typeof cockpit") == "undefined"
    frame = foreign.frames[1]
    assert frame.get_by_label("Mode", exact=True).count() == 0
    foreign.get_by_text("the robot").click()
    foreign.get_by_label("Mode", exact=True).first.wait_for()
    foreign.close()


# ---- the page itself -------------------------------------------------------------


@pytest.fixture
def tunnel(teleop):
    """The address of the page behind another port, as by ``ssh -L``."""
    port = int(re.search(r":(\d+)/", teleop.url)[1])

    def copy(source, target):
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                target.sendall(data)
        with contextlib.suppress(OSError):
            target.shutdown(socket.SHUT_WR)

    def accept():
        with contextlib.suppress(OSError):
            while True:
                near, _ = entrance.accept()
                far = socket.create_connection(("127.0.0.1", port))
                for way in ((near, far), (far, near)):
                    Thread(target=copy, args=way, daemon=True).start()

    with socket.create_server(("127.0.0.1", 0)) as entrance:
        Thread(target=accept, daemon=True).start()
        yield f"http://localhost:{entrance.getsockname()[1]}/"
        entrance.shutdown(socket.SHUT_RDWR)


NAME = "l_arm_elx"
HOSTILE = "l_arm_elx');alert(1);//\"><img src=x onerror=alert(1)>"


def renamed(page):
    """Gives a joint a hostile name on the way between server and page."""
    there, here = json.dumps(NAME)[1:-1], json.dumps(HOSTILE)[1:-1]

    def connect(browser):
        server = browser.connect_to_server()
        server.on_message(lambda text: browser.send(text.replace(there, here)))
        browser.on_message(lambda text: server.send(text.replace(here, there)))

    page.route_web_socket(re.compile("/socket"), connect)


def test_a_page_behind_another_port_works_and_runs_no_name_of_a_joint(
    page, tunnel, browser
):
    other = CockpitPage(browser, tunnel, before=renamed)
    policy = other.page.request.get(tunnel).headers["content-security-policy"]
    assert "script-src 'self';" in policy
    other.until("cockpit.wanted.size > 0")  # Of the 3D view.
    page.press("Steering")
    other.steering_says("Steer")  # Nobody has control.
    other.press("Steering")
    other.steering_says("You steer")
    other.page.get_by_role("button", name="l_arm", exact=True).press("Enter")
    other.button(f"{HOSTILE}: behavior").click()
    other.button(f"{HOSTILE}: yours").wait_for()
    assert other.page.get_by_role("slider", name=f"{HOSTILE} [rad]").is_enabled()
    other.press(f"Gains of {HOSTILE}")
    other.page.get_by_role("heading", name=f"Gains of {HOSTILE}").wait_for()
    assert other.page.locator("img").count() == 0
    assert other.see(HANDLERS) == []
    assert not other.errors
    other.page.close()
    page.steering_says("Steer")


HANDLERS = """[...document.querySelectorAll("*")].flatMap((e) =>
  [...e.attributes].map((one) => one.name).filter((name) => name.startsWith("on")))"""
"""Attributes that would be script."""


def test_the_page_needs_no_internet(page, teleop):
    ours = teleop.url.split("//")[1].split("/")[0]
    assert page.asked
    assert [
        url
        for url in page.asked
        if ours not in url and not url.startswith(("data:", "blob:", "about:"))
    ] == []
