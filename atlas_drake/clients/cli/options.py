"""Options that several commands share, and their values.

``main`` adds the options to the commands.
"""

from __future__ import annotations

import argparse
import math
import re
from pathlib import Path

from atlas_drake.clients.film import FILM_SIZE
from atlas_drake.clients.view.overlays import OVERLAYS, overlays_from
from atlas_drake.errors import ScenarioError


def add_robot_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options of the scenario: robot, world, seed, step, any other field."""
    robot = parser.add_argument_group("what is simulated")
    robot.add_argument(
        "--model",
        metavar="MODEL",
        help="the robot: atlas (91 kg, the default), atlas_v3 (148 kg), drake_atlas "
        "(175 kg, from Drake's models), or the path of a robot's YAML file",
    )
    robot.add_argument(
        "--world",
        metavar="WORLD",
        help="what stands around the robot, and where it starts: a world's "
        "name (docs/worlds.md) or the path of its YAML file; "
        "--set world.stairs.rise=0.06 changes a part",
    )
    robot.add_argument(
        "--seed",
        type=int,
        metavar="N",
        help="seed of the sensor noise and the random variations of a scenario",
    )
    robot.add_argument(
        "--physics-step",
        type=float,
        metavar="SECONDS",
        help="at most 0.01 (default: 0.003); smaller is slower and more exact. The "
        "control period is the multiple nearest to 0.009, if the scenario has none",
    )
    robot.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY.PATH=VALUE",
        help="set any field of the scenario, such as controller.gains.dcm_gain=2.5, "
        "jitter.mass=0.05 or plant.stiction_tolerance=1e-3; may be given several times",
    )
    robot.add_argument(
        "--with",
        dest="parts",
        type=Path,
        metavar="FILE.py",
        help="put in parts of your own: those of controller, behaviors, world, extend "
        "that the file defines, as AtlasSimulation takes them",
    )


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """Adds every option that ``demo``, ``run`` and ``script`` share."""
    add_robot_options(parser)
    parser.add_argument(
        "--duration",
        type=rate,
        metavar="SECONDS",
        help="simulate for so long (default: as the scenario says; of a script, as "
        "long as the program runs)",
    )
    view = parser.add_argument_group("how you watch it")
    add_speed_options(view, "no 3D view: as fast as possible, for scripts and servers")
    add_cockpit_option(view)
    add_address_options(view)
    add_show_option(view, "none")
    keep = parser.add_argument_group("what you keep")
    keep.add_argument(
        "--json",
        type=Path,
        metavar="FILE",
        help="write a summary of the run, with all figures, as JSON",
    )
    keep.add_argument(
        "--log",
        type=Path,
        metavar="FILE",
        help="write the record of every control tick: an .mcap file, for `plot`, "
        "`replay`, Python, Foxglove and PlotJuggler",
    )
    add_record_option(keep)
    keep.add_argument(
        "--video",
        type=Path,
        metavar="FILE",
        help="film the run afterwards into a .mp4 or .gif, as `atlas-drake film` does "
        "its log; also with --headless",
    )
    keep.add_argument(
        "--video-size",
        type=size,
        default=FILM_SIZE,
        metavar="WxH",
        help=f"of the film's pictures (default: {FILM_SIZE[0]}x{FILM_SIZE[1]})",
    )


def add_cockpit_option(view: argparse._ArgumentGroup) -> None:
    """Adds --cockpit and --no-cockpit; None where the user gives neither."""
    view.add_argument(
        "--cockpit",
        action=argparse.BooleanOptionalAction,
        help="the cockpit in the browser, with every command and what the controller "
        "thinks, or Meshcat alone (default: the cockpit for `demo` and `replay` if "
        '`pip install "atlas-drake[cockpit]"` was done, else Meshcat)',
    )
    view.set_defaults(cockpit_is_usual=False)


def add_speed_options(view: argparse._ArgumentGroup, headless: str) -> None:
    """Adds --headless, with its help, and --realtime-rate."""
    view.add_argument("--headless", action="store_true", help=headless)
    view.add_argument(
        "--realtime-rate",
        type=rate,
        metavar="R",
        help="simulated seconds per second, at most; 0 is as fast as possible "
        "(default: 1 with the 3D view, 0 without)",
    )


def add_address_options(view: argparse._ArgumentGroup) -> None:
    """Adds host and port of the 3D view."""
    view.add_argument(
        "--port",
        type=_port,
        metavar="P",
        help="port of the 3D view, or the next free one (default: from 7000; the "
        "cockpit's from 8080)",
    )
    view.add_argument(
        "--host",
        default="localhost",
        metavar="H",
        help="address that the 3D view listens on; with * or 0.0.0.0 everyone with "
        "access to its port can watch; steering the cockpit then needs the token in "
        "the address that is printed (default: %(default)s)",
    )


def add_record_option(keep: argparse._ArgumentGroup) -> None:
    """Adds --record."""
    keep.add_argument(
        "--record",
        type=Path,
        metavar="FILE.html",
        help="write the 3D animation, with what --show asks for, as one web page that "
        "plays without this program",
    )


def add_show_option(view: argparse._ArgumentGroup, show: str) -> None:
    """Adds --show; ``show`` is the default."""
    view.add_argument(
        "--show",
        type=_overlays,
        default=_overlays(show),
        metavar="LIST",
        help="overlays of the controller's state and plan in 3D view and film, with "
        f"commas: {', '.join(OVERLAYS)}; or all, or none (default: {show})",
    )


def _overlays(text: str) -> list[str]:
    try:
        return overlays_from(text)
    except ScenarioError as error:
        # argparse adds the option's name.
        raise argparse.ArgumentTypeError(error.problem) from error


def rate(text: str) -> float:
    """Reads a number from 0 up, for argparse."""
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not (math.isfinite(rate) and rate >= 0.0):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0 up")
    return rate


def _port(text: str) -> int:
    # Below 1024 only administrators may listen, and Meshcat does not.
    if not (text.isdecimal() and 1024 <= int(text) <= 65535):
        raise argparse.ArgumentTypeError(f"{text!r} is not a port in 1024..65535")
    return int(text)


def size(text: str) -> tuple[int, int]:
    """Reads width and height in pixels, for argparse."""
    found = re.fullmatch(r"([0-9]{1,4})x([0-9]{1,4})", text)
    if found is None or not all(64 <= int(side) <= 4096 for side in found.groups()):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a width and height in 64..4096 pixels, such as 960x540"
        )
    return int(found[1]), int(found[2])
