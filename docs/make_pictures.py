"""Makes the films, and the pictures of the README, extending.md and worlds.md.

Needs Chromium for the views, Graphviz for the diagram and the extra ``video``::

    python docs/make_pictures.py [--browser chromium] [--only cockpit]
"""

# ruff: noqa: T201

import argparse
import shutil
import subprocess
import tempfile
from functools import partial
from pathlib import Path

from cockpit_pictures import make_cockpit_pictures
from extending_pictures import make_extending_pictures
from worlds_pictures import make_worlds_pictures

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    PlannedPush,
    Scenario,
    film,
    read_log,
)
from atlas_drake.clients.cli.main import main as atlas_drake
from atlas_drake.clients.parts_file import run_file
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.viewer import start_meshcat
from atlas_drake.worlds.world_file import View

PAGES = ("films", "readme", "cockpit", "extending", "worlds", "robots")
IMAGES = Path(__file__).parent / "images"
FILM_SIZE = (640, 360)
PUSH, PUSH_VIEW = 60.0, View([0.45, -3.9, 1.1], [0.45, 0.0, 0.9])
"""Push of ``push.mp4`` [N·s], and its camera."""
TOUR_SEED = 3
TOUR = {"fastest": 0.4, "driven": True, "punch": 12.0, "waypoints": 5}
"""Seed and parameters of ``tour.mp4``."""
CAMPAIGNS = Path(__file__).parents[1] / "benchmarks/campaigns"
STAIRS = {
    "up": {"position": [0.21, 0.0, 0.0]},
    "down": {"position": [1.71, 0.0, 0.0], "yaw": 3.141593},
}
STAIRS_VIEW = View([1.2, -6.6, 2.3], [1.0, 0.0, 1.5])
"""Stairs of ``stairs_up.mp4`` and ``stairs_down.mp4``, and their camera."""
HANDS = {
    "carry": "crate",
    "door": "door",
    "valve": "valve",
    "box": "box",
    "tray": "tray",
}
"""Films of the hands' work, by the campaign whose first trial they show."""
FIGURES = "figures.png"
THOUGHTS = (
    "com",
    "dcm",
    "cop",
    "support",
    "plan",
    "swing",
    "forces",
    "follow",
)
THOUGHTS_AT = 9.25
"""Overlays of ``thoughts.png``, and their time in the demo walk [s]."""
SIZE = "1200,800"
"""Size of the pictures [pixel]."""
BROWSER_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--no-first-run",
    "--virtual-time-budget=6000",
    f"--window-size={SIZE}",
)
HIDE_CONTROLS = "<style>.dg { display: none }</style>"


def photograph(browser: str, page: str, picture: Path) -> None:
    """Opens a web page and writes what is seen."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "page.html"
        file.write_text(page.replace("</head>", f"{HIDE_CONTROLS}</head>", 1))
        command = [browser, *BROWSER_OPTIONS, f"--user-data-dir={folder}/profile"]
        command += [f"--screenshot={picture}", file.as_uri()]
        subprocess.run(command, check=True, capture_output=True)
    print(f"Wrote {picture} ({picture.stat().st_size / 1e3:.0f} kB).")


def main() -> None:
    """Makes all pictures, or those of one page."""
    parser = argparse.ArgumentParser(description="Make the pictures of the pages.")
    parser.add_argument("--browser", default="chromium", help="default: %(default)s")
    parser.add_argument("--only", choices=PAGES, help="of one page")
    options = parser.parse_args()
    IMAGES.mkdir(exist_ok=True)
    pages = PAGES if options.only is None else (options.only,)
    if "films" in pages:
        make_films()
    if "readme" in pages:
        make_readme_pictures(options.browser)
    if "cockpit" in pages:
        make_cockpit_pictures(str(shutil.which(options.browser)), IMAGES)
    if "extending" in pages:
        make_extending_pictures(IMAGES, partial(photograph, options.browser))
    if "robots" in pages:
        from robots_pictures import make_robots_pictures

        make_robots_pictures(IMAGES)
    if "worlds" in pages:
        make_worlds_pictures(IMAGES, partial(photograph, options.browser))


def make_films() -> None:
    """Films the tutorial with the owner of each joint, a push, tour, stairs, hands."""
    push = PlannedPush(time=1.0, impulse=PUSH)
    with tempfile.TemporaryDirectory() as folder:
        log = f"{folder}/tutorial.mcap"
        atlas_drake(["demo", "--headless", "--log", log])
        show = ["owner", "plan", "swing"]
        film(read_log(log), IMAGES / "demo.mp4", size=FILM_SIZE, show=show)
        log = f"{folder}/push.mcap"
        with AtlasSimulation(Scenario(pushes=[push]), log=log) as sim:
            sim.advance_to(8.0)
        show, view = ["com", "dcm", "cop", "support"], PUSH_VIEW
        film(read_log(log), IMAGES / "push.mp4", size=FILM_SIZE, show=show, view=view)
        tour = run_file(CAMPAIGNS / "steering.py", "steering")["tour"]
        log = f"{folder}/tour.mcap"
        with AtlasSimulation(Scenario(seed=TOUR_SEED), log=log) as sim:
            tour(sim, TOUR)
        show = ["owner", "com", "dcm", "support"]
        film(read_log(log), IMAGES / "tour.mp4", size=FILM_SIZE, show=show)
        for campaign, name in HANDS.items():
            first = [str(CAMPAIGNS / f"{campaign}.yaml"), "--only", "0"]
            kept = ["--out", folder, "--video", str(IMAGES / f"{name}.mp4")]
            atlas_drake(["sweep", *first, *kept])
        climb = run_file(CAMPAIGNS / "stairs.py", "stairs")["climb"]
        for way, place in STAIRS.items():
            stairs = {**place, "rise": 0.20, "run": 0.30, "number": 6}
            world = {"name": "stairs", "stairs": stairs}
            log = f"{folder}/{way}.mcap"
            with AtlasSimulation(Scenario(world=world), log=log) as sim:
                climb(sim, {"step_duration": 0.63})
            path = IMAGES / f"stairs_{way}.mp4"
            film(read_log(log), path, size=FILM_SIZE, view=STAIRS_VIEW)


def make_readme_pictures(browser: str) -> None:
    """Makes the pictures of the README."""
    meshcat = start_meshcat()
    sim = AtlasSimulation(view=meshcat, overlays=Overlays(THOUGHTS))
    walk = AtlasSimInterfaceCommand()
    walk.behavior = Behavior.WALK
    walk.walk_params.use_demo_walk = True
    sim.publish(walk)
    sim.advance_to(THOUGHTS_AT)
    photograph(browser, meshcat.StaticHtml(), IMAGES / "thoughts.png")
    with tempfile.TemporaryDirectory() as folder:
        log = f"{folder}/tutorial.mcap"
        atlas_drake(["demo", "--headless", "--log", log])
        atlas_drake(["plot", log, "--output", str(IMAGES / FIGURES)])


if __name__ == "__main__":
    main()
