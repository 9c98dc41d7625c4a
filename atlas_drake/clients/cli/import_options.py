"""Options of ``atlas-drake import``."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any


def add_import_command(commands: Any) -> None:
    """Adds the command."""
    command = commands.add_parser(
        "import",
        help="make a robot of a URDF file, and watch it walk",
        description="Find the limbs and soles of a humanoid, repair what simulation "
        "cannot use, write robot.yaml, a URDF and meshes, and try the robot: it "
        "stands, walks and is pushed. Takes up to a minute. Needs "
        '`pip install "atlas-drake[import]"`; the extra `robots` brings TALOS, G1, '
        "iCub, Romeo and JVRC-1.",
        epilog="exit status: 0 the robot stands and walks, 1 it does not (its files "
        "are written), 2 the file cannot become a robot, 3 a file could not be "
        "written; the folder then stays as it was",
    )
    command.add_argument(
        "robot",
        metavar="ROBOT",
        help="a .urdf file, or the name of a robot in an installed package, such as "
        "talos or jvrc",
    )
    command.add_argument(
        "-o",
        "--out",
        type=Path,
        metavar="FOLDER",
        help="where to write; its name becomes the robot's (default: that of the file)",
    )
    command.add_argument(
        "--package",
        action="append",
        default=[],
        type=_package,
        metavar="NAME=FOLDER",
        help="folder of package://NAME; may be given several times",
    )
    command.add_argument(
        "--no-trial",
        action="store_true",
        help="only write robot.yaml and what it needs",
    )
    found = command.add_argument_group("instead of finding it")
    found.add_argument(
        "--faces",
        choices=("x", "y", "-x", "-y"),
        help="axis of the root's frame along which the robot faces, as in --faces=-x",
    )
    for name, what in (("feet", "foot"), ("hands", "hand")):
        found.add_argument(
            f"--{name}",
            nargs=2,
            metavar=("LEFT", "RIGHT"),
            help=f"links of the left and the right {what}",
        )
    found.add_argument(
        "--chest", metavar="LINK", help="link that balance keeps upright"
    )
    found.add_argument(
        "--sole",
        nargs=4,
        type=float,
        metavar=("LENGTH", "WIDTH", "HEIGHT", "AHEAD"),
        help="size of the soles, height of the foot's link above them, and distance of "
        "their middle ahead of it [m]",
    )
    found.add_argument(
        "--fix",
        action="append",
        default=[],
        metavar="JOINT",
        help="make a joint fixed; may be given several times",
    )
    found.add_argument(
        "--fingers",
        action="store_true",
        help="keep moving fingers as joints of the limbs l_hand and r_hand",
    )
    command.set_defaults(run="import_robot.run_import", reads=())


def _package(text: str) -> tuple[str, Path]:
    name, separator, folder = text.partition("=")
    if not (separator and name):
        raise argparse.ArgumentTypeError(f"is {text!r}; must be NAME=FOLDER")
    path = Path(os.path.expanduser(folder))
    if not path.is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder {path}")
    return name, path.absolute()
