"""The cockpit in a real browser, used as people use it."""

import json
import re
import signal
import subprocess
import sys
import time

import pytest

from .conftest import PATIENCE, drag, wait_for

pytestmark = pytest.mark.slow

SIZES = {"small laptop": (1280, 720), "screen": (1920, 1080), "phone": (390, 844)}


class Run:
    """``atlas-drake teleop`` in a process of its own, as at a terminal."""

    def __init__(self, folder, *options):
        self._printed = folder / "printed.txt"
        self._process = subprocess.Popen(
            [sys.executable, "-m", "atlas_drake", "teleop", *options],
            stdout=self._printed.open("w"),
            stderr=subprocess.STDOUT,
        )
        wait_for(lambda: re.search(r"http://\S+", self.printed), "the address")
        self.url = re.search(r"http://\S+", self.printed)[0]

    @property
    def printed(self):
        return self._printed.read_text()

    def end(self):
        self._process.send_signal(signal.SIGINT)
        return self._process.wait(PATIENCE)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    pytest.importorskip("nicegui", reason="the cockpit is not installed")
    run = Run(tmp_path_factory.mktemp("teleop"), "--port", "8180")
    yield run
    assert run.end() == 0
    assert "Traceback" not in run.printed


class Page:
    """A page of the cockpit, and what it says."""

    def __init__(self, browser, url, size=(1280, 720)):
        self.errors = []
        self.page = browser.new_page(
            viewport=dict(zip(("width", "height"), size, strict=True))
        )
        self.page.set_default_timeout(1e3 * PATIENCE)
        self.page.on("pageerror", lambda error: self.errors.append(error))  # noqa: PLW0108
        self.page.goto(url)
        wait_for(lambda: self.time is not None, "the first state")

    def press(self, name):
        self.page.get_by_role("button", name=name, exact=True).first.click()

    def tab(self, name):
        self.page.get_by_role("tab", name=name).click()

    def slider(self, name):
        """The part of a slider that takes keys."""
        slider = self.page.get_by_role("slider", name=name)
        return slider.locator(".q-slider__track-container")

    def says(self, label):
        return self.page.get_by_label(label, exact=True).first.inner_text()

    @property
    def mode(self):
        return self.says("Mode")

    @property
    def time(self):
        found = re.match(r"[0-9.]+", self.says("Time"))
        return None if found is None else float(found[0])

    def becomes(self, mode):
        wait_for(lambda: self.mode == mode, f"{mode}; it is {self.mode}")

    def events(self):
        return self.page.get_by_role("log").first.inner_text()


@pytest.fixture
def page(run, browser):
    page = Page(browser, run.url)
    if page.says("Speed").startswith("paused"):
        page.press("Pause")
    page.press("Reset")
    page.becomes("STAND")
    yield page
    assert not page.errors
    page.page.close()


def test_modes_are_asked_for_lit_and_refused_with_a_reason(page):
    page.press("MANIPULATE")
    page.becomes("MANIPULATE")
    walk = page.page.get_by_role("button", name="STEP", exact=True)
    assert walk.get_attribute("aria-disabled") == "true"
    page.press("STOP")
    page.becomes("STAND")
    page.press("FREEZE")
    page.becomes("FREEZE")
    assert "STAND -> FREEZE" in page.events()
    page.page.get_by_label("Search events").fill("FREEZE")
    wait_for(lambda: "FREEZE" in page.events(), "the search")
    page.page.get_by_label("Search events").fill("no such thing")
    wait_for(lambda: page.events() == "nothing yet", "the search")


def test_keys_walk_and_escape_stops(page):
    page.page.keyboard.press("i")
    page.becomes("WALK")
    wait_for(lambda: "step 2 landed" in page.events(), "two steps")
    page.page.keyboard.press("Escape")
    page.becomes("STAND")


def test_time_is_paused_stepped_paced_and_turned_back(page):
    wait_for(lambda: page.time > 2.0, "two seconds")
    page.page.keyboard.press("Space")
    wait_for(lambda: page.says("Speed").startswith("paused"), "the pause")
    before = page.time
    for _ in range(10):
        page.press("Single step")
        time.sleep(0.1)
    wait_for(lambda: page.time >= before + 0.19, "ten steps of 20 ms")
    assert page.time < before + 0.31
    page.press("Back 10 s")
    wait_for(lambda: page.time < before - 0.5, "the time before")
    page.press("Pause")
    wait_for(lambda: not page.says("Speed").startswith("paused"), "the run")


def test_joints_change_hands_in_the_figure_and_move(page):
    page.press("r_arm_ely: behavior")
    page.page.get_by_role("button", name="r_arm_ely: yours").wait_for()
    knob = page.page.get_by_role("slider", name="r_arm_ely [rad]")
    assert knob.get_attribute("aria-readonly") != "true"
    before = float(knob.inner_text())
    box = knob.bounding_box()
    page.page.mouse.click(
        box["x"] + 0.15 * box["width"], box["y"] + 0.4 * box["height"]
    )
    wait_for(lambda: abs(float(knob.inner_text()) - before) > 0.2, "the elbow")
    page.press("None mine")
    page.page.get_by_role("button", name="r_arm_ely: behavior").wait_for()
    page.press("Arms mine")
    page.page.get_by_role("button", name="l_arm_shx: yours").wait_for()
    page.press("Hold")
    page.press("Go limp")
    page.press("None mine")
    page.page.get_by_role("button", name="l_arm_shx: behavior").wait_for()


def test_the_pelvis_moves_in_manipulate(page):
    page.tab("Pelvis")
    page.page.locator(".left").get_by_role("button", name="MANIPULATE").click()
    page.becomes("MANIPULATE")
    page.slider("pelvis height").focus()
    for _ in range(8):
        page.page.keyboard.press("ArrowDown")
    shown = page.page.locator(".left .q-tab-panel .numbers .number").first
    before = shown.inner_text()
    wait_for(lambda: shown.inner_text() != before, "the height")
    page.tab("Joints")


def test_the_gait_is_set(page):
    page.tab("Walk")
    page.slider("stride").focus()
    page.page.keyboard.press("ArrowRight")
    wait_for(
        lambda: "0.21 m" in page.page.locator(".left").inner_text(), "the new stride"
    )
    page.page.keyboard.press("ArrowLeft")
    page.press("turn left")
    page.becomes("WALK")
    page.press("stop walking")
    page.becomes("STAND")
    page.tab("Joints")


def at_W(page, x, y, z=0.0):
    """Where a point of the world is on the page [pixel]."""
    point = page.page.evaluate(
        """([x, y, z]) => {
          const v = cockpit.fromW(x, y, z).project(viewer.camera);
          const box = viewer.renderer.domElement.getBoundingClientRect();
          return [box.left + 0.5 * (1 + v.x) * box.width,
                  box.top + 0.5 * (1 - v.y) * box.height];
        }""",
        [x, y, z],
    )
    return tuple(point)


def test_a_click_on_the_ground_plans_and_a_second_one_walks(page):
    page.press("Front")
    time.sleep(1.0)
    place = at_W(page, 0.8, 0.7)
    page.page.mouse.click(*place)
    hint = page.page.locator("#hint")
    wait_for(lambda: "Click again" in hint.inner_text(), "the hint")
    page.page.keyboard.press("Escape")
    wait_for(lambda: hint.inner_text() == "", "no hint")
    assert page.mode == "STAND"
    page.page.mouse.click(*place)
    wait_for(lambda: "Click again" in hint.inner_text(), "the hint")
    time.sleep(0.5)
    page.page.mouse.click(*place)
    page.becomes("WALK")
    page.becomes("STAND")
    robot = page.page.evaluate("cockpit.robot")
    assert abs(robot[0] - 0.8) < 0.1
    assert abs(robot[1] - 0.7) < 0.1


def test_a_link_is_asked_for_and_pushed_by_the_mouse(page):
    page.press("Front")
    time.sleep(1.0)
    x, y, z, _ = page.page.evaluate("cockpit.robot")
    chest = at_W(page, x + 0.1, y, z + 0.45)
    page.page.mouse.click(*chest)
    page.page.get_by_role("button", name="Take it").wait_for()
    assert "the behavior has it" in page.page.locator(".link").inner_text()
    page.press("Close")
    drag(page.page, chest, (chest[0] + 20, chest[1]), (chest[0] + 40, chest[1]))
    wait_for(lambda: "push" in page.events().lower(), "the push")


def test_overlays_are_switched(page):
    page.press("Show")
    switch = page.page.get_by_role("switch", name="forces")
    before = switch.get_attribute("aria-checked")
    switch.click()
    wait_for(lambda: switch.get_attribute("aria-checked") != before, "the switch")
    page.page.keyboard.press("Escape")


@pytest.mark.parametrize("size", SIZES)
def test_the_page_fits(run, browser, size):
    page = Page(browser, run.url, SIZES[size])
    width, height = SIZES[size]
    inner = page.page.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    assert inner[0] <= width
    view = page.page.locator("#view").bounding_box()
    if size == "phone":
        assert view["y"] < 0.3 * height
        assert view["width"] > 0.9 * width
    else:
        assert inner[1] <= height
        stop = page.page.get_by_role("button", name="STOP", exact=True).bounding_box()
        assert stop["y"] + stop["height"] <= height
        assert view["width"] > 0.45 * width
    page.page.close()


def test_a_second_viewer_watches_asks_and_steers(page, run, browser):
    other = Page(browser, run.url)
    assert other.says("Steering") == "Ask to steer"
    other.press("FREEZE")
    other.page.get_by_text("ask to steer first").first.wait_for()
    assert other.mode == "STAND"
    other.page.get_by_label("Steering").click()
    wait_for(lambda: page.says("Steering") == "Hand over", "the question")
    page.page.get_by_label("Steering").click()
    wait_for(lambda: other.says("Steering") == "You steer", "the answer")
    other.press("FREEZE")
    page.becomes("FREEZE")
    other.page.close()
    wait_for(lambda: page.says("Steering") == "You steer", "the way back")


def test_closing_the_page_ends_a_walk_and_loses_nothing(run, browser):
    page = Page(browser, run.url)
    page.press("Reset")
    page.page.keyboard.press("i")
    page.becomes("WALK")
    page.page.close()
    again = Page(browser, run.url)
    again.becomes("STAND")
    assert "WALK" in again.events()
    again.page.close()


def test_a_slow_browser_holds_nothing_up(page, browser, run):
    slow = Page(browser, run.url)
    session = slow.page.context.new_cdp_session(slow.page)
    session.send("Emulation.setCPUThrottlingRate", {"rate": 10})
    begin = page.time
    wait_for(lambda: page.time > begin + 1.0, "the run to go on")
    page.press("FREEZE")
    page.becomes("FREEZE")
    session.send("Emulation.setCPUThrottlingRate", {"rate": 1})
    slow.page.close()


HOSTILE = """async (address) => {
  const ids = [...document.querySelectorAll('[id^=c]')]
    .map(e => Number(e.id.slice(1)));
  const values = [NaN, 1e6, -5, Infinity,
                  null, 'junk', {}, [], {x: NaN}, {name: 7}];
  const events = 'ground push link joint limb stick plan_step plan_send'.split(' ');
  for (const event of events) {
    for (const value of values) emitEvent(event, value);
  }
  for (const id of ids) for (const value of values) {
    window.socket.emit('event', {id, client_id: window.clientId, listener_id: 'x',
                                 args: [value]});
  }
  window.socket.emit('event', 'junk');
  window.socket.emit('javascript_response', {});
  const raw = new WebSocket(address);
  await new Promise(done => { raw.onopen = done; });
  raw.send(new Uint8Array([255, 193, 0, 1]));
  raw.send('{"type": "button", "name": "STOP"}');
  raw.send('x'.repeat(1000));
  await new Promise(done => setTimeout(done, 300));
  raw.close();
}"""


def test_junk_neither_ends_nor_steers_a_run(page, run):
    page.page.evaluate(HOSTILE, run.url.replace("http", "ws") + "meshcat")
    before = page.time
    wait_for(lambda: page.time > before + 1.0, "the run to go on")
    assert page.mode == "STAND"
    page.errors.clear()  # Of the junk, in its own page.


def test_a_flood_of_clicks_holds_nobody_else_up(page, run, browser):
    hostile = Page(browser, run.url)
    hostile.page.evaluate(
        """() => { for (let i = 0; i < 200000; i++) {
          emitEvent('joint', {name: 'l_arm_shx', keep: true});
        } }"""
    )
    before = page.time
    wait_for(lambda: page.time > before + 1.0, "the run to go on")
    page.press("FREEZE")
    page.becomes("FREEZE")
    hostile.page.close()


def test_a_foreign_page_reaches_nothing(run, browser, page):
    foreign = browser.new_page()
    foreign.goto("about:blank")
    reached = foreign.evaluate(
        """(address) => new Promise(done => {
          const socket = new WebSocket(address);
          socket.onopen = () => done(true);
          socket.onerror = () => done(false);
        })""",
        run.url.replace("http", "ws") + "meshcat",
    )
    assert not reached
    foreign.close()


def test_the_page_needs_no_internet(run, browser):
    asked = []
    page = browser.new_page()
    page.on("request", lambda request: asked.append(request.url))
    page.goto(run.url)
    page.wait_for_timeout(2000)
    ours = run.url.split("//")[1].split("/")[0]
    assert asked
    assert [
        url for url in asked if ours not in url and not url.startswith("data:")
    ] == []
    page.close()


def test_names_and_contrast(page):
    """Every button has a name, and text can be read in light and dark."""
    for _ in range(2):
        nameless = page.page.evaluate(
            """[...document.querySelectorAll('button, input, [role=button]')].filter(
              (e) => e.offsetParent && !(e.getAttribute('aria-label') || e.innerText ||
                     e.placeholder || e.title)).map((e) => e.outerHTML.slice(0, 200))"""
        )
        assert nameless == []
        # Colors change in a transition.
        wait_for(lambda: json.loads(page.page.evaluate(CONTRAST)) == [], "contrast")
        page.press("Dark or light")


CONTRAST = """(() => {
  const light = (c) => { const p = c.map(v => { v /= 255;
    return v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; });
    return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]; };
  const parse = (s) => (s.match(/[0-9.]+/g) || []).map(Number);
  const faint = [];
  const texts = "label, .nicegui-label, .q-btn, .q-tab, p";
  for (const e of document.querySelectorAll(texts)) {
    if (!e.offsetParent || !e.innerText || e.closest('.disable')) continue;
    let back = null;
    for (let o = e; o && !back; o = o.parentElement) {
      const c = parse(getComputedStyle(o).backgroundColor);
      if (c.length === 3 || c[3] === 1) back = c;
    }
    const b = light((back || [255, 255, 255]).slice(0, 3));
    const f = light(parse(getComputedStyle(e).color).slice(0, 3));
    const ratio = (Math.max(f, b) + 0.05) / (Math.min(f, b) + 0.05);
    if (ratio < 4.5) faint.push([e.innerText.slice(0, 30), ratio.toFixed(1)]);
  }
  return JSON.stringify(faint);
})()"""
