"""The command ``atlas-drake``: its sub-commands, options and help.

Parses and dispatches; runs are in ``run``, plots and replays of logs in ``log``, films
in ``film``, campaigns in ``sweep``, the picture of the diagram in ``diagram``.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from atlas_drake.atomic_write import why_not_readable
from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.import_options import add_import_command
from atlas_drake.clients.cli.options import (
    add_address_options,
    add_cockpit_option,
    add_record_option,
    add_robot_options,
    add_run_options,
    add_show_option,
    add_speed_options,
    rate,
    size,
)
from atlas_drake.clients.cli.policy import add_policy_options
from atlas_drake.clients.cli.sweep_options import add_sweep_commands
from atlas_drake.clients.film import FILM_SIZE
from atlas_drake.errors import AtlasError, printable

_LOST = "3 an output file could not be written (every other one is kept)"
_EXIT_STATUS = (
    "exit status: 0 Atlas ended upright and did what was asked, 1 it did not, "
    f"2 bad input, {_LOST}, 130 stopped by Ctrl-C"
)
_LOG_EXIT_STATUS = f"exit status: 0 done, 2 bad input, {_LOST}, 130 stopped by Ctrl-C"


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command, by default that of the process; returns the exit status."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    own: list[str] = []
    if given[:1] == ["script"] and "--" in given:
        end = given.index("--")
        given, own = given[:end], given[end + 1 :]
    try:
        options = _parsed(given)
        options.arguments = own
        _check_files_read(options)
        # Only the module of the command is loaded, and Drake with it.
        module, _, name = options.run.partition(".")
        run = getattr(import_module(f"atlas_drake.clients.cli.{module}"), name)
        status: int = run(options)
        return status
    except AtlasError as error:
        print(f"atlas-drake: error: {printable(str(error))}", file=sys.stderr)
        return exit_status.BAD_INPUT
    except KeyboardInterrupt:
        return exit_status.INTERRUPTED


class _Parser(argparse.ArgumentParser):
    """A parser that says in one line what is wrong, and where the help is."""

    def error(self, message: str) -> NoReturn:
        """Ends the process."""
        told = f"{self.prog}: error: {printable(message)} (see {self.prog} --help)\n"
        self.exit(exit_status.BAD_INPUT, told)


def _parsed(given: Sequence[str]) -> argparse.Namespace:
    """Parses the arguments; ends the process if they cannot be used."""
    return _parser().parse_args(given)


def _check_files_read(options: argparse.Namespace) -> None:
    """Checks that inputs are files, before Drake loads, which takes seconds."""
    for path in [getattr(options, name, None) for name in options.reads]:
        if path is not None and (problem := why_not_readable(path)):
            raise AtlasError(f"{path}: {problem}")


def _parser() -> _Parser:
    """Makes the parser of the command line."""
    parser = _Parser(
        prog="atlas-drake",
        description="Simulate the humanoid robot Atlas, under your own joint commands "
        "and under behaviors that stand and walk.",
        epilog="Begin with `atlas-drake demo`: it opens a 3D view in the browser and "
        "shows Atlas standing, moving its arms and walking. "
        "`atlas-drake COMMAND --help` lists the options of a command.",
    )
    parser.add_argument("--version", action=_Version, help="print the version")
    commands = parser.add_subparsers(
        title="commands", metavar="COMMAND", required=True, dest="command"
    )

    demo = commands.add_parser(
        "demo",
        help="watch the tutorial: stand, move the arms, walk (17 s)",
        description="Atlas changes control modes: it stands by itself, stands under "
        "joint commands, lets go of its arms while it balances, walks four steps "
        "and ends under joint commands again.",
        epilog=_EXIT_STATUS,
    )
    demo.add_argument(
        "--literal",
        action="store_true",
        help="send the arm command exactly as the tutorial published it, without the "
        "damping that its own comment means",
    )
    add_run_options(demo)
    demo.set_defaults(run="run.run_demo", reads=("parts",), cockpit_is_usual=True)

    run = commands.add_parser(
        "run",
        help="simulate a scenario described in a YAML file",
        description="Simulate a scenario; examples are in examples/scenarios/. "
        "Options given here win over the file; without one the robot stands.",
        epilog=_EXIT_STATUS,
    )
    run.add_argument("scenario", metavar="SCENARIO.yaml", type=Path, nargs="?")
    add_run_options(run)
    add_policy_options(run)
    run.set_defaults(run="run.run_file", reads=("scenario", "parts", "policy"))

    script = commands.add_parser(
        "script",
        help="run a program that was written for DRCSim and ROS, as it is",
        description="Run a Python program written for DRCSim: what it imports from "
        "ROS is stood in for, and what it publishes commands the simulated robot. "
        "Time passes where the program waits. See docs/scripts.md.",
        usage="atlas-drake script [options] FILE.py [-- ARGUMENT ...]",
        epilog="What follows -- is for the program. " + _EXIT_STATUS,
    )
    script.add_argument("file", metavar="FILE.py", type=Path)
    script.add_argument(
        "--scenario",
        metavar="SCENARIO.yaml",
        type=Path,
        help="what is simulated (default: Atlas in STAND on level ground); the program "
        "decides how long",
    )
    add_run_options(script)
    script.set_defaults(run="script.run_script", reads=("file", "scenario", "parts"))

    def on_log(name: str, *, run: str, help: str, description: str) -> _Parser:
        """Adds a command that reads a log."""
        command = commands.add_parser(
            name, help=help, description=description, epilog=_LOG_EXIT_STATUS
        )
        command.add_argument("log", metavar="LOG", type=Path)
        command.set_defaults(run=run, reads=("log",))
        return command

    plot = on_log(
        "plot",
        help="draw a page of figures of a log",
        description="Draw behaviors and k_effort over time, joints and their "
        "set-points, efforts against their limits, balance from above and over time, "
        "feet, and the controller's tick times; or chosen columns. Logs come from "
        "--log of `demo` and `run`.",
        run="log.plot_log",
    )
    plot.add_argument(
        "--channels",
        nargs="?",
        const="",
        metavar="NAMES",
        help="draw these columns over time instead, such as "
        "balance.com.x,walk,*.l_leg_kny; without names, list all columns",
    )
    _add_output(plot, "a .png, .svg or .pdf file (default: run.png for run.mcap)")

    export = on_log(
        "export",
        help="write the columns of a log as a table",
        description="Write every number of every control tick, by the names that "
        "`plot --channels` lists.",
        run="log.export_log",
    )
    _add_output(
        export, "a .parquet, .csv or .npz file (default: run.parquet for run.mcap)"
    )

    replay = on_log(
        "replay",
        help="watch a log",
        description="Show the robot as the log has it, with footsteps, in the 3D view. "
        "Nothing is simulated.",
        run="log.replay_log",
    )
    watch = replay.add_argument_group("how you watch it")
    add_speed_options(watch, "no 3D view: for --record alone, as fast as possible")
    add_cockpit_option(watch)
    watch.add_argument(
        "--beside",
        metavar="LOG",
        type=Path,
        help="in the cockpit: a second log, whose robot stands beside the first and "
        "whose plots are dashed",
    )
    add_address_options(watch)
    add_show_option(watch, "none")
    add_record_option(replay.add_argument_group("what you keep"))
    replay.set_defaults(reads=("log", "beside"), cockpit_is_usual=True)

    film = on_log(
        "film",
        help="film a log",
        description="Film the robot as the log has it, with footsteps, into a video. "
        "Needs no display; nothing is simulated. Takes 2 to 5 s for each second of the "
        'log. Needs `pip install "atlas-drake[video]"`.',
        run="film.film_log",
    )
    pictures = film.add_argument_group("what the film shows")
    film.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="a .mp4 or .gif (default: beside the log, run.mp4 for run.mcap)",
    )
    pictures.add_argument(
        "--size",
        type=size,
        default=FILM_SIZE,
        metavar="WxH",
        help=f"of the pictures (default: {FILM_SIZE[0]}x{FILM_SIZE[1]})",
    )
    pictures.add_argument(
        "--view",
        type=float,
        nargs=6,
        metavar=("X", "Y", "Z", "X_TO", "Y_TO", "Z_TO"),
        help="place of the camera and of what it looks at, in the world [m], such as "
        "--view 3 -2 1.5 0 0 1 (default: the view of the world, if it has one; else, "
        "and with --show follow, the camera follows the robot)",
    )
    add_show_option(pictures, "none")

    teleop = commands.add_parser(
        "teleop",
        help="steer Atlas yourself, in the cockpit in the browser",
        description="Steer Atlas in the cockpit: behaviors, walking by keys or by a "
        "click on the ground, the pelvis, your share of each joint, pushes. Ctrl-C "
        "ends it.",
        epilog="exit status: 0 stopped by Ctrl-C or after --duration, 1 the simulation "
        "failed, 2 bad input",
    )
    teleop.add_argument(
        "scenario",
        metavar="SCENARIO.yaml",
        type=Path,
        nargs="?",
        help="scenario to simulate (default: Atlas on level ground, or in --world)",
    )
    teleop.add_argument(
        "--duration",
        type=rate,
        metavar="SECONDS",
        help="end after this simulated time (default: no end)",
    )
    add_robot_options(teleop)
    add_policy_options(teleop)
    watch = teleop.add_argument_group("how you watch it")
    add_address_options(watch)
    add_show_option(watch, "com,dcm,cop,support,swing,plan")
    teleop.set_defaults(run="teleop.run_teleop", reads=("scenario", "parts", "policy"))

    add_import_command(commands)
    add_sweep_commands(commands, _LOST)

    diagram = commands.add_parser(
        "diagram",
        help="draw the block diagram of the simulation",
        description="Draw the diagram that a run simulates, as the code wires it. "
        "Pictures need Graphviz; its source, .dot, does not.",
    )
    diagram.add_argument(
        "file",
        nargs="?",
        type=Path,
        default=Path("atlas_drake.svg"),
        metavar="FILE",
        help="a .svg, .png, .pdf or .dot file (default: %(default)s)",
    )
    diagram.set_defaults(run="diagram.show_diagram", reads=())
    return parser


def _add_output(parser: argparse.ArgumentParser, help: str) -> None:
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help=help)


class _Version(argparse.Action):
    """Looks the version up only on request."""

    def __init__(self, option_strings: list[str], dest: str, help: str) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, help=help)

    def __call__(self, parser, *_arguments) -> None:  # type: ignore[no-untyped-def]
        """Prints the versions that matter in a bug report."""
        from importlib.metadata import version

        print(f"atlas-drake {version('atlas-drake')}, drake {version('drake')}")
        parser.exit()
