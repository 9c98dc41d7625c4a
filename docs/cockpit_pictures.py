"""The picture of the cockpit, a film of a drive, and the tutorial for the README.

The page is used as people use it; time goes on by single steps, so that the film keeps
real time however slow the pictures are.
"""

# ruff: noqa: T201

import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import av
from PIL import Image

SIZE = {"width": 1280, "height": 720}
FRAMES_PER_SECOND = 5
STEPS = 10
"""Single steps of 20 ms for each picture."""
FLAGS = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
POINTER = """() => {
  const dot = document.createElement('div');
  dot.style = `position:fixed;width:18px;height:18px;border-radius:50%;z-index:9999;
    background:#ffb300cc;border:2px solid #222;pointer-events:none;
    transform:translate(-50%,-50%)`;
  document.body.append(dot);
  for (const event of ['pointermove', 'pointerdown', 'pointerup']) {
    window.addEventListener(event, (e) => {
      dot.style.left = `${e.clientX}px`; dot.style.top = `${e.clientY}px`;
      dot.style.background = e.buttons ? '#d32f2fcc' : '#ffb300cc';
    }, true);
  }
}"""
"""Shows where the mouse is, which a screenshot does not."""
COLORS = 192
"""Of the animated picture."""
TUTORIAL_END = 17.0
"""Time at which the tutorial's last motion has ended [s]."""
NEARER = 3
"""Turns of the wheel towards the robot, until an arm fills the view."""
TOOLS = 45
"""Height of the buttons above the view [pixel]."""
FARTHER = 5
"""Turns of the wheel away from the robot, until the goal of its walk is seen."""
DRAW_WHEN_ASKED = """() => {
  cockpit.draw = () => {};
  cockpit.viewer.renderer.setPixelRatio(1);
  window.drawNow = () => { cockpit.viewer.render(); return true; };
}"""
"""Draws the view for each picture of the film alone, which is slow without a GPU."""
DEMO_WIDTH = 720
"""Of the animated picture in the README [pixel]."""


class Film:
    """A page that is filmed while it is used."""

    def __init__(self, page: Any, file: Path) -> None:
        """Films a page into a file."""
        self.page = page
        self._container = av.open(str(file), "w")
        self._stream: Any = self._container.add_stream("h264", FRAMES_PER_SECOND)
        self._stream.width, self._stream.height = SIZE["width"], SIZE["height"]
        self._stream.pix_fmt = "yuv420p"
        self._stream.options = {"crf": "26"}
        self._picture = file.with_suffix(".frame.png")

    def take(self) -> None:
        """Takes a picture, and lets time go on until the next."""
        self.page.evaluate("drawNow()")
        self.page.screenshot(path=self._picture)
        frame = av.VideoFrame.from_image(Image.open(self._picture).convert("RGB"))
        for packet in self._stream.encode(frame):
            self._container.mux(packet)
        end = self.time + STEPS * 0.02 - 0.011
        for _ in range(STEPS):
            self.page.keyboard.press("n")
        while self.time < end:
            self.page.wait_for_timeout(20)

    def run(self, seconds: float, until: Callable[[], bool] = lambda: False) -> None:
        """Films for a time, or until something has happened."""
        for _ in range(round(seconds * FRAMES_PER_SECOND)):
            if until():
                return
            self.take()

    @property
    def time(self) -> float:
        """Time that the page shows [s]."""
        found = re.match(r"[0-9.]+", self.text("Time"))
        return float(found[0]) if found else 0.0

    def text(self, label: str) -> str:
        """Text of an element by its name."""
        found: str = self.page.get_by_label(label, exact=True).first.inner_text()
        return found

    def glide(self, x: float, y: float, pictures: int = 3) -> None:
        """Moves the mouse so that one can follow it."""
        for part in range(1, pictures + 1):
            self.page.mouse.move(x, y, steps=part)
            self.take()

    def place(self, x: float, y: float, z: float) -> tuple[float, float]:
        """Where a point of the world is on the page [pixel]."""
        point = self.page.evaluate("(point) => cockpit.onPage(...point)", [x, y, z])
        return point[0], point[1]

    def button(self, name: str) -> Any:
        """A button by its name."""
        return self.page.get_by_role("button", name=name, exact=True).first

    def press(self, name: str) -> None:
        """Goes to a button and presses it."""
        box = self.button(name).bounding_box()
        self.glide(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"], 2)
        self.button(name).click()

    def close(self) -> None:
        """Completes the film."""
        for packet in self._stream.encode():
            self._container.mux(packet)
        self._container.close()
        self._picture.unlink()


def drive(film: Film, picture: Path) -> None:
    """Walks through the first gate, takes the arms, and is pushed."""
    film.page.mouse.move(640, 300)
    for _ in range(FARTHER):
        film.page.mouse.wheel(0, 100)
        film.page.wait_for_timeout(300)
    film.run(0.6)
    goal = film.place(1.7, 0.5, 1.0)
    film.glide(*goal)
    film.page.mouse.click(*goal)
    film.page.wait_for_timeout(500)
    film.run(0.8)
    film.page.mouse.click(*goal)
    film.run(4.0)
    film.press("Arms mine")
    film.run(1.0)
    film.page.screenshot(path=picture)
    film.run(15.0, until=lambda: film.text("Mode") == "STAND")
    x, y, z, _ = film.page.evaluate("cockpit.robot")
    chest = film.place(x + 0.1, y, z + 0.42)
    film.glide(*chest)
    film.page.mouse.down()
    film.glide(chest[0] + 90, chest[1] + 10)
    film.page.mouse.up()
    film.page.wait_for_timeout(500)
    film.run(4.0)


def watch(film: Film) -> None:
    """Watches the tutorial to its end."""
    film.run(18.0, until=lambda: film.time > TUTORIAL_END)


def drag_hand(film: Film, picture: Path) -> None:
    """Drags the goal of a hand up and ahead."""
    film.page.mouse.move(640, 300)
    for _ in range(NEARER):
        film.page.mouse.wheel(0, -300)
        film.page.wait_for_timeout(300)
    film.button("Move hand").click()
    film.run(1.0)
    for way in ([0.0, 0.0, 0.3], [0.25, 0.0, 0.0]):
        x, y, z = film.page.evaluate("cockpit.page.view.hand.goal().toArray()")
        # An arrow is taken beyond the rings.
        taken = [0.19 if part else 0.0 for part in way]
        film.page.mouse.move(*film.place(x + taken[0], y, z + taken[2]))
        film.page.mouse.down()
        film.page.mouse.move(
            *film.place(x + taken[0] + way[0], y, z + taken[2] + way[2]), steps=5
        )
        film.page.mouse.up()
        film.page.wait_for_timeout(1000)
        film.run(0.2)
    film.page.locator("#view").screenshot(path=picture)
    image = Image.open(picture)
    width, height = image.size
    image.crop((width // 4, TOOLS, 3 * width // 4, height)).save(picture)


def make_cockpit_pictures(browser: str, images: Path) -> None:
    """Films a drive through ``qual_task_1``, and the tutorial; drags a hand."""
    drive_file, demo_file = images / "cockpit.mp4", images / "cockpit_demo.mp4"
    with opened(browser, demo_file, "teleop") as film:
        drag_hand(film, images / "hand.png")
    with opened(browser, drive_file, "teleop", "--world", "qual_task_1") as film:
        drive(film, images / "cockpit.png")
    with opened(browser, demo_file, "demo", "--show", "owner,com,support") as film:
        watch(film)
    animate(demo_file, images / "cockpit.gif")
    demo_file.unlink()
    print(f"Wrote cockpit.mp4, cockpit.png, cockpit.gif and hand.png in {images}.")


@contextmanager
def opened(browser: str, file: Path, *arguments: str) -> Iterator[Film]:
    """Opens the page of a run that waits for its first single step, and films it."""
    from playwright.sync_api import sync_playwright

    command = [sys.executable, "-m", "atlas_drake", *arguments, "--cockpit"]
    if arguments[0] == "teleop":
        command.remove("--cockpit")
    run = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert run.stdout is not None
    url = next(filter(None, (re.search(r"http://\S+", line) for line in run.stdout)))
    try:
        with sync_playwright() as driver:
            chromium = driver.chromium.launch(executable_path=browser, args=FLAGS)
            page = chromium.new_page(viewport=SIZE)
            page.goto(url[0])
            page.get_by_role("button", name="Single step").click()
            page.get_by_text("Loading the robot").wait_for(state="hidden")
            page.evaluate(POINTER)
            page.evaluate(DRAW_WHEN_ASKED)
            film = Film(page, file)
            yield film
            film.close()
            chromium.close()
    finally:
        run.send_signal(signal.SIGINT)
        run.wait()


def animate(film: Path, picture: Path) -> None:
    """Makes an animated picture of a film."""
    frames = []
    with av.open(str(film)) as container:
        for frame in container.decode(video=0):
            image = frame.to_image()
            height = round(image.height * DEMO_WIDTH / image.width)
            frames.append(image.resize((DEMO_WIDTH, height)))
    # One palette for all, in which the owners' colors have their place.
    palette = frames[len(frames) // 2].quantize(COLORS)
    plain = Image.Dither.NONE
    first, *rest = (one.quantize(palette=palette, dither=plain) for one in frames)
    period = 1000 // FRAMES_PER_SECOND
    first.save(picture, save_all=True, append_images=rest, duration=period, loop=0)
