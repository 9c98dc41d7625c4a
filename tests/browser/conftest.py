"""A browser without a window, driven by Playwright."""

import io
import os
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
# Without a GPU the 3D view alone is drawn as by one, which takes long.
FLAGS = (
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing",
)
SIZE = {"width": 400, "height": 300}
"""Of the window [pixel]: small, as each pixel costs time without a GPU."""
SMALL_LAPTOP = {"width": 1280, "height": 720}
SCREEN = {"width": 1920, "height": 1080}
PHONE = {"width": 390, "height": 844}
PATIENCE = 60.0
"""With the browser [s of wall time]."""


def wait_for(condition, what):
    """Waits until a function says yes."""
    give_up = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < give_up, f"waited {PATIENCE:g} s for {what}"
        time.sleep(0.02)


class Run:
    """``atlas-drake`` in a process of its own, as at a terminal, and its page."""

    def __init__(self, folder, *arguments):
        self._printed = folder / "printed.txt"
        self._process = subprocess.Popen(
            [sys.executable, "-m", "atlas_drake", *arguments],
            stdout=self._printed.open("w"),
            stderr=subprocess.STDOUT,
        )
        wait_for(lambda: re.search(r"http://\S+", self.printed), "the address")
        self.url = re.search(r"http://\S+", self.printed)[0]

    @property
    def printed(self):
        return self._printed.read_text()

    def end(self, status=0):
        """Ends it by Ctrl-C."""
        self._process.send_signal(signal.SIGINT)
        assert self._process.wait(PATIENCE) == status
        assert "Traceback" not in self.printed


class CockpitPage:
    """A page of the cockpit, and what it says."""

    def __init__(self, browser, url, before=lambda _page: None):
        """Opens the page, after a function has prepared the browser's."""
        self.errors, self.asked, self.url = [], [], url
        self.page = browser.new_page(viewport=SMALL_LAPTOP)
        self.page.set_default_timeout(1e3 * PATIENCE)
        self.page.on("pageerror", lambda error: self.errors.append(error))  # noqa: PLW0108
        self.page.on("dialog", lambda dialog: self.errors.append(dialog.message))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.add_init_script(DRAW_WHEN_ASKED)
        before(self.page)
        self.open()

    def open(self):
        self.page.goto(self.url)
        self.awaits_run()

    def awaits_run(self):
        """Waits for the first frame, and for the script of the 3D view."""
        self.until("window.cockpit?.page.frame && cockpit.viewer")

    def close(self):
        """Leaves the cockpit, as by closing the browser's tab."""
        self.page.goto("about:blank")

    def begin(self):
        """Puts page and robot to where every test begins, as fast as can be."""
        if self.page.url == "about:blank":
            self.open()
        self.page.evaluate(BEGIN)
        self.page.set_viewport_size(SMALL_LAPTOP)
        self.page.mouse.move(1, 1)
        wait_for(lambda: self.mode == "STAND", "STAND")
        self.errors.clear()

    def rest(self):
        """Lets time stand still, for the sake of the tests to come."""
        self.page.evaluate(REST)

    def draw(self, live):
        """Draws as time goes on, or no more, which is quick without a GPU."""
        self.page.evaluate(
            f"cockpit.draw = {'cockpit.drawLive' if live else '() => {}'}; 0"
        )

    def until(self, expression):
        """Waits for something to be true; ``wait_for_function`` needs eval."""
        wait_for(lambda: self.page.evaluate(f"Boolean({expression})"), expression)

    def ask(self, what, **values):
        """Asks the run for something, past the page's elements; returns the answer."""
        call = "([what, values]) => cockpit.page.do(what, values, { quiet: true })"
        return self.page.evaluate(call, [what, values])

    def frame(self, expression=""):
        """The latest frame, or a part of it."""
        return self.page.evaluate(f"cockpit.page.frame{expression}")

    def box(self, selector):
        """Left, top, right and bottom of what a selector finds first [pixel]."""
        return self.page.evaluate(BOX, selector)

    def button(self, name):
        return self.page.get_by_role("button", name=name, exact=True).first

    def press(self, name):
        self.button(name).click()

    def key(self, key):
        self.page.keyboard.press(key)

    def tab(self, name):
        self.page.get_by_role("tab", name=name).click()

    def labelled(self, label):
        return self.page.get_by_label(label, exact=True).first

    def says(self, label):
        return self.labelled(label).inner_text()

    @property
    def mode(self):
        return self.says("Mode")

    @property
    def time(self):
        return float(self.says("Time").split()[0])

    @property
    def paused(self):
        return self.says("Speed").startswith("paused")

    def becomes(self, mode):
        wait_for(lambda: self.mode == mode, f"{mode}; it is {self.mode}")

    def steering_says(self, text):
        """Waits for who has control, which each page is told for itself."""
        wait_for(lambda: self.says("Steering") == text, f"the button {text!r}")

    def tells(self, text):
        """Waits for a notice."""
        notices = self.page.locator("#notices")
        notices.filter(has_text=text).wait_for()

    def goes_on(self):
        before = self.time
        wait_for(lambda: self.time > before + 0.5, "the run to go on")

    def events(self):
        return self.labelled("Events").inner_text()

    def at_W(self, *point):
        """Where a point of the world is on the page [pixel]."""
        return tuple(self.page.evaluate(ON_PAGE, point))

    def see(self, script, *arguments):
        """Returns what a script of ``looks`` finds."""
        return self.page.evaluate(script, *arguments)


DRAW_WHEN_ASKED = """
  let scene;
  Object.defineProperty(window, "cockpit", { get: () => scene, set: (made) => {
    scene = made;
    if (scene.draw) { scene.drawLive = scene.draw; scene.draw = () => {}; }
  } });
"""
BOX = """(selector) => {
  const { left, top, right, bottom } =
    document.querySelector(selector).getBoundingClientRect();
  return [left, top, right, bottom];
}"""
REST = """async () => {
  const { page } = cockpit;
  await page.do("take_control", {}, { quiet: true });
  await page.do("pause", { on: true }, { quiet: true });
}"""
BEGIN = """async () => {
  const { page } = cockpit;
  const order = (name, values) => page.do(name, values, { quiet: true });
  document.querySelectorAll(".menu:popover-open").forEach((one) => one.hidePopover());
  document.getElementById("notices").replaceChildren();
  document.activeElement?.blur();
  page.openTab("Joints");
  document.querySelector(".limb[aria-label=r_arm]").dispatchEvent(
    new MouseEvent("click", { shiftKey: true })); // Chooses it alone.
  await order("take_control");
  await order("rate", { rate: 0 });
  await order("pause", { on: false });
  await order("reset");
}"""
ON_PAGE = """(point) => {
  viewer.controls.update();
  viewer.scene.updateMatrixWorld(true);
  viewer.camera.updateMatrixWorld(true);
  return cockpit.onPage(...point);
}"""


def drag(page, *points):
    """Moves the mouse along points [pixel], its button down from first to last."""
    page.mouse.move(*points[0])
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*point)
    page.mouse.up()


def picture(page):
    """What is seen, shape (height, width, 3)."""
    from PIL import Image

    # Two frames later all that was asked for is on the screen.
    page.evaluate(
        "new Promise(done => { viewer.set_dirty(); requestAnimationFrame("
        "() => requestAnimationFrame(() => done(true))) })"
    )
    data = io.BytesIO(page.screenshot())
    return np.array(Image.open(data).convert("RGB")).astype(int)


@pytest.fixture(scope="package")
def browser():
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed"
    )
    asked = os.environ.get("CHROMIUM")
    program = asked or next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=program, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="package")
def teleop(tmp_path_factory):
    """A run of ``atlas-drake teleop``, which stands still between the tests."""
    pytest.importorskip("aiohttp", reason="the cockpit is not installed")
    run = Run(tmp_path_factory.mktemp("teleop"), "teleop", "--port", "8180")
    yield run
    run.end()


@pytest.fixture(scope="package")
def steering(teleop, browser):
    page = CockpitPage(browser, teleop.url)
    yield page
    page.page.close()


@pytest.fixture
def page(steering):
    """The page that steers, its robot as at the beginning."""
    steering.begin()
    yield steering
    steering.rest()
    assert not steering.errors


@pytest.fixture(scope="package")
def second_page(teleop, browser):
    page = CockpitPage(browser, teleop.url)
    yield page
    page.page.close()


@pytest.fixture
def watching(page, second_page):
    """A second page, which does not steer and does not ask to."""
    second_page.open()
    second_page.ask("release_control")
    yield second_page
    second_page.close()  # It costs the other tests time, too.
    assert not second_page.errors


@pytest.fixture
def open_page(browser):
    """A function that opens an address in a new window, offline if asked to."""
    pages = []

    def open_page(url, offline=False):
        pages.append(browser.new_page(viewport=SIZE, offline=offline))
        pages[-1].set_default_timeout(1e3 * PATIENCE)
        pages[-1].goto(url)
        return pages[-1]

    yield open_page
    for page in pages:
        page.close()
