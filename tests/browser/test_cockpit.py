"""The cockpit in a real browser, used as people use it."""

import json
import re
import time
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread

import pytest

from .conftest import FAST, PATIENCE, Run, drag, wait_for

pytestmark = [pytest.mark.slow, pytest.mark.browser]

SMALL_LAPTOP = {"width": 1280, "height": 720}
SCREEN = {"width": 1920, "height": 1080}
PHONE = {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    pytest.importorskip("nicegui", reason="the cockpit is not installed")
    run = Run(tmp_path_factory.mktemp("teleop"), "teleop", *FAST, "--port", "8180")
    yield run
    run.end()


class Page:
    """A page of the cockpit, and what it says."""

    def __init__(self, browser, url):
        self.errors, self.asked = [], []
        self.url = url
        self.page = browser.new_page(viewport=SMALL_LAPTOP)
        self.page.set_default_timeout(1e3 * PATIENCE)
        self.page.on("pageerror", lambda error: self.errors.append(error))  # noqa: PLW0108
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.open()

    def open(self):
        self.page.goto(self.url)
        wait_for(lambda: self.time is not None, "the first state")
        self.draws(False)

    def draws(self, live):
        """Draws as time goes on, or when asked alone, which is quick without a GPU."""
        self.page.evaluate(
            "cockpit.draw_live ??= cockpit.draw;"
            f"cockpit.draw = {'cockpit.draw_live' if live else '() => {}'}; 0"
        )

    def close(self):
        """Leaves the cockpit, as by closing the browser's tab."""
        self.page.goto("about:blank")

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

    @property
    def paused(self):
        return self.says("Speed").startswith("paused")

    def becomes(self, mode):
        wait_for(lambda: self.mode == mode, f"{mode}; it is {self.mode}")

    def goes_on(self):
        before = self.time
        wait_for(lambda: self.time > before + 0.5, "the run to go on")

    def events(self):
        return self.page.get_by_role("log").first.inner_text()

    def at_W(self, *point):
        """Where a point of the world is on the page [pixel]."""
        self.page.evaluate("viewer.render()")
        return tuple(self.page.evaluate("(point) => cockpit.onPage(...point)", point))


@pytest.fixture(scope="module")
def steering(run, browser):
    page = Page(browser, run.url)
    yield page
    page.page.close()


@pytest.fixture
def page(steering):
    """The page that steers, its robot as at the beginning."""
    if steering.paused:
        steering.press("Pause")
    before = steering.events()
    steering.press("Reset")
    wait_for(lambda: steering.events() != before, "the reset")
    steering.becomes("STAND")
    yield steering
    assert not steering.errors


@pytest.fixture(scope="module")
def watching(steering, run, browser):
    """A second page, which does not steer."""
    page = Page(browser, run.url)
    yield page
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
    page.page.get_by_label("Search events").fill("")


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


def test_a_slider_gives_a_part_of_the_chosen_limb(page):
    page.page.get_by_role("button", name="l_arm", exact=True).press("Enter")
    slider = page.slider("k_effort of l_arm")
    slider.click()  # In the middle.
    half = re.compile("l_arm_wrx: k_effort 12[78]")
    page.page.get_by_role("button", name=half).wait_for()
    page.press("None mine")
    page.page.get_by_role("button", name="l_arm_wrx: behavior").wait_for()
    page.page.get_by_role("button", name="r_arm", exact=True).press("Enter")
    page.slider("k_effort of r_arm").wait_for()


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


def test_a_click_on_the_ground_plans_and_a_second_one_walks(page):
    page.press("Front")
    place = page.at_W(0.8, 0.7)
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


def test_the_camera_stays_above_the_ground(page):
    page.press("Free")
    box = page.page.locator("#view").bounding_box()
    x, top = box["x"] + 20, box["y"] + 60
    bottom = box["y"] + box["height"] - 20
    # Around the robot, away from it, and sideways.
    drag(page.page, (x, bottom), (x, 0.5 * (top + bottom)), (x, top))
    assert camera_height(page) == pytest.approx(0.05, abs=0.01)
    page.page.mouse.wheel(0, 2000)
    assert camera_height(page) == pytest.approx(0.05, abs=0.01)
    page.page.keyboard.down("Shift")
    drag(page.page, (x, top), (x, 0.5 * (top + bottom)), (x, top))
    for _ in range(3):
        drag(page.page, (x, top), (x, bottom), (x, top + 5))
    page.page.keyboard.up("Shift")
    assert camera_height(page) >= 0.04
    page.press("Follow")


def camera_height(page):
    """Height of the camera two frames later [m]."""
    return page.page.evaluate(
        "new Promise(done => requestAnimationFrame(() => requestAnimationFrame("
        "() => done(viewer.camera.position.y))))"
    )


def test_a_link_is_asked_for_and_pushed_by_the_mouse(page):
    page.press("Front")
    x, y, z, _ = page.page.evaluate("cockpit.robot")
    chest = page.at_W(x + 0.1, y, z + 0.45)
    page.page.mouse.click(*chest)
    page.page.get_by_role("button", name="Take it").wait_for()
    assert "the behavior has it" in page.page.locator(".link").inner_text()
    page.press("Close")
    drag(page.page, chest, (chest[0] + 20, chest[1]), (chest[0] + 40, chest[1]))
    wait_for(lambda: "push" in page.events().lower(), "the push")


def test_without_a_graphics_card_pictures_are_coarse_and_few(page):
    page.draws(True)
    wait_for(lambda: page.page.evaluate("cockpit.slow"), "a picture")
    wait_for(
        lambda: page.page.evaluate("viewer.renderer.getPixelRatio()") == 0.5,
        "a coarse picture",
    )
    drawn = page.page.evaluate(DRAWN_MEANWHILE)
    assert drawn["pictures"] >= 1
    assert drawn["share"] < 0.75
    page.draws(False)


DRAWN_MEANWHILE = """new Promise((done) => {
  const begin = performance.now();
  let pictures = 0, before = null, drawing = 0;
  const look = (now) => {
    if (before !== null && cockpit.drawing) drawing += now - before;
    if (cockpit.drawing && cockpit.drawing !== look.last) pictures += 1;
    look.last = cockpit.drawing;
    before = now;
    if (now - begin < 5000) requestAnimationFrame(look);
    else done({ pictures, share: drawing / (now - begin) });
  };
  requestAnimationFrame(look);
})"""
"""Counts pictures of five seconds, and the share of the time that they take."""


def test_overlays_are_switched(page):
    page.press("Show")
    switch = page.page.get_by_role("switch", name="forces")
    before = switch.get_attribute("aria-checked")
    switch.click()
    wait_for(lambda: switch.get_attribute("aria-checked") != before, "the switch")
    page.page.keyboard.press("Escape")


@pytest.mark.parametrize("size", [SMALL_LAPTOP, SCREEN])
def test_a_screen_shows_all_without_scrolling(page, size):
    width, height = size.values()
    page.page.set_viewport_size(size)
    inner = page.page.evaluate(INNER_SIZE)
    assert inner[0] <= width
    assert inner[1] <= height
    stop = page.page.get_by_role("button", name="STOP", exact=True).bounding_box()
    assert stop["y"] + stop["height"] <= height
    assert page.page.locator("#view").bounding_box()["width"] > 0.45 * width
    page.page.set_viewport_size(SMALL_LAPTOP)


@pytest.mark.parametrize("size", [PHONE, SMALL_LAPTOP, SCREEN])
def test_every_control_has_a_size_one_can_hit(page, size):
    page.page.set_viewport_size(size)
    page.page.get_by_label("Channel to plot").fill("balance.com.x")
    page.page.get_by_role("button", name="Remove balance.com.x").wait_for()
    small = set()
    for tab in ("Walk", "Pelvis", "Scenario", "Settings", "Joints"):
        page.tab(tab)
        if tab == "Settings":
            page.page.get_by_label("Search settings").fill("controller.stand")
            page.page.locator(".setting").first.wait_for()
        small.update(page.page.evaluate(SMALL_CONTROLS))
    for menu in ("Show", "Push", "Pose", "New run", "Gains of r_arm_shy"):
        page.press(menu)
        page.page.locator(".q-menu").wait_for()
        small.update(page.page.evaluate(SMALL_CONTROLS))
        page.page.keyboard.press("Escape")
        page.page.locator(".q-menu").wait_for(state="detached")
    page.press("Remove balance.com.x")
    page.page.set_viewport_size(SMALL_LAPTOP)
    assert small == set()


SMALL_CONTROLS = """(() => {
  const roles = ["button", "slider", "tab", "switch", "checkbox", "option", "menuitem"];
  const controls = "button, input, select, textarea, a, " +
                   roles.map((role) => `[role=${role}]`).join(", ");
  const small = [];
  for (const e of document.querySelectorAll(controls)) {
    if (!e.checkVisibility({ visibilityProperty: true }) || e.type === "file") continue;
    // A field is hit all over, and not on its text alone; a line as far as it is thick.
    const whole = e.closest(".q-field__control") || e, line = e.querySelector("line");
    let { width, height } = whole.getBoundingClientRect();
    if (line) {
      const thick = parseFloat(getComputedStyle(line).strokeWidth);
      width += thick * line.getScreenCTM().a;
      height += thick * line.getScreenCTM().d;
    }
    const name = e.getAttribute("aria-label") || e.innerText || e.outerHTML;
    if (Math.min(width, height) < 24) small.push(`${name}: ${width} x ${height}`);
  }
  return small;
})()"""
"""Names and sizes of controls that are smaller than 24 pixels in one direction."""


@pytest.mark.parametrize("size", [PHONE, SMALL_LAPTOP, SCREEN])
def test_no_explanation_covers_stop(page, size):
    page.page.set_viewport_size(size)
    modes = page.page.locator(".modes button")
    stop = modes.filter(has_text="STOP")
    for mode in modes.all():
        mode.hover()
        page.page.wait_for_timeout(300)
        box = stop.bounding_box()
        for told in page.page.locator(".q-tooltip:visible").all():
            over = told.bounding_box()
            assert (
                over["y"] + over["height"] <= box["y"]
                or over["x"] + over["width"] <= box["x"]
                or over["x"] >= box["x"] + box["width"]
            )
    page.page.mouse.move(1, 1)
    page.page.set_viewport_size(SMALL_LAPTOP)


def test_a_phone_shows_the_robot_first(page):
    page.page.set_viewport_size(PHONE)
    assert page.page.evaluate(INNER_SIZE)[0] <= PHONE["width"]
    view = page.page.locator("#view").bounding_box()
    assert view["y"] < 0.3 * PHONE["height"]
    assert view["width"] > 0.9 * PHONE["width"]
    page.page.set_viewport_size(SMALL_LAPTOP)


INNER_SIZE = (
    "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
)


def test_a_second_viewer_watches_asks_and_steers(page, watching):
    assert watching.says("Steering") == "Ask to steer"
    watching.press("FREEZE")
    watching.page.get_by_text("ask to steer first").first.wait_for()
    assert watching.mode == "STAND"
    watching.page.get_by_label("Steering").click()
    wait_for(lambda: page.says("Steering") == "Hand over", "the question")
    page.page.get_by_label("Steering").click()
    wait_for(lambda: watching.says("Steering") == "You steer", "the answer")
    watching.press("FREEZE")
    page.becomes("FREEZE")
    watching.close()
    wait_for(lambda: page.says("Steering") == "You steer", "the way back")
    watching.open()


def test_a_watcher_stops_a_walk(page, watching):
    page.page.keyboard.press("i")
    page.becomes("WALK")
    assert watching.says("Steering") == "Ask to steer"
    watching.press("STOP")
    page.page.get_by_text("pressed STOP").first.wait_for()
    page.becomes("STAND")


def open_again(page, watching):
    """Closes the page that steers, opens it anew, and lets it steer again."""
    page.close()
    wait_for(lambda: watching.says("Steering") == "You steer", "the next viewer")
    page.open()
    page.page.get_by_label("Steering").click()
    wait_for(lambda: watching.says("Steering") == "Hand over", "the question")
    watching.page.get_by_label("Steering").click()
    wait_for(lambda: page.says("Steering") == "You steer", "the way back")


def test_closing_the_page_ends_a_walk_and_loses_nothing(page, watching):
    page.page.keyboard.press("i")
    page.becomes("WALK")
    open_again(page, watching)
    page.becomes("STAND")
    assert "WALK" in page.events()


def test_a_slow_browser_holds_nothing_up(page, watching):
    session = watching.page.context.new_cdp_session(watching.page)
    session.send("Emulation.setCPUThrottlingRate", {"rate": 10})
    page.goes_on()
    page.press("FREEZE")
    page.becomes("FREEZE")
    session.send("Emulation.setCPUThrottlingRate", {"rate": 1})


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


def test_junk_neither_ends_nor_steers_a_run(page, watching, run):
    page.page.evaluate(HOSTILE, run.url.replace("http", "ws") + "meshcat")
    page.goes_on()
    assert page.mode == "STAND"
    open_again(page, watching)
    page.errors.clear()  # Of the junk, in its own page.


def test_a_flood_of_clicks_holds_nobody_else_up(page, watching):
    watching.page.evaluate(
        """() => { for (let i = 0; i < 20000; i++) {
          emitEvent('joint', {name: 'l_arm_shx', keep: true});
        } }"""
    )
    page.goes_on()
    page.press("FREEZE")
    page.becomes("FREEZE")


def test_a_foreign_page_reaches_nothing(page, run, browser):
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


@pytest.fixture
def foreign_site(run, tmp_path):
    """The address of a site that loads and frames the page, and links to it."""
    (tmp_path / "index.html").write_text(
        f"""<script src="{run.url}assets/cockpit.js"></script>
        <iframe src="{run.url}"></iframe><a href="{run.url}">the robot</a>"""
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
    foreign.goto(foreign_site.replace("127.0.0.1", name))
    assert foreign.evaluate("typeof cockpit") == "undefined"
    frame = foreign.frames[1]
    assert frame.get_by_label("Mode", exact=True).count() == 0
    foreign.get_by_text("the robot").click()
    foreign.get_by_label("Mode", exact=True).first.wait_for()
    foreign.close()


def test_the_page_needs_no_internet(page, run):
    ours = run.url.split("//")[1].split("/")[0]
    assert page.asked
    assert [
        url for url in page.asked if ours not in url and not url.startswith("data:")
    ] == []


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
