"""Options of the commands about campaigns: sweep, results, compare.

What the commands do is in ``sweep``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from atlas_drake.clients.cli.options import (
    add_address_options,
    add_robot_options,
    add_show_option,
)
from atlas_drake.clients.cli.policy import add_policy_options


def add_sweep_commands(commands: Any, lost: str) -> None:
    """Adds the commands; ``lost`` is what the help says of lost files."""
    status = f"2 bad input, {lost}, 130 stopped by Ctrl-C"
    parser = commands.add_parser(
        "sweep",
        help="run a scenario many times, randomised, on all cores or a cluster",
        description="Run the trials of a campaign: a scenario whose numbers are drawn "
        "anew for each trial. Stopped in any way, the same command goes on where it "
        "was. docs/campaigns.md explains the file; examples are in "
        "benchmarks/campaigns/.",
        epilog="exit status: 0 all trials are done, and the campaign's goal is met if "
        "it has one, 1 it is not, or the folder cannot be written (with --only: the "
        f"trial failed), {status}",
    )
    parser.add_argument("campaign", metavar="CAMPAIGN.yaml", type=Path)
    add_robot_options(parser)
    add_policy_options(parser)
    where = parser.add_argument_group("how many, and where")
    where.add_argument(
        "--trials",
        type=int,
        metavar="N",
        help="of each case (default: what the campaign says)",
    )
    where.add_argument(
        "--jobs",
        type=int,
        metavar="J",
        help="child processes at a time here (default: as many as there are cores)",
    )
    where.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder of the results (default: the campaign's name in results/)",
    )
    where.add_argument(
        "--cluster",
        metavar="ADDRESS",
        help="run on the workers of a Dask scheduler, such as tcp://HOST:8786; needs "
        '`pip install "atlas-drake[cluster]"`',
    )
    one = parser.add_argument_group("one trial alone")
    one.add_argument(
        "--only",
        type=int,
        metavar="K",
        help="do trial K, as it is in the campaign, and keep nothing in the folder",
    )
    one.add_argument("--view", action="store_true", help="watch it in the 3D view")
    one.add_argument("--log", type=Path, metavar="FILE", help="as `run --log`")
    one.add_argument("--video", type=Path, metavar="FILE", help="as `run --video`")
    add_address_options(one)
    add_show_option(one, "none")
    parser.set_defaults(run="sweep.sweep", reads=("campaign", "parts", "policy"))

    parser = commands.add_parser(
        "results",
        help="tables and figures of a campaign, also while it runs",
        description="Write what a campaign's results amount to as they are now: a "
        "table (results.parquet), and a report with confidence intervals and figures "
        "(report.md).",
        epilog=f"exit status: 0 done, {status}",
    )
    parser.add_argument("folder", metavar="DIR", type=Path)
    parser.set_defaults(run="sweep.show_results", reads=())

    parser = commands.add_parser(
        "compare",
        help="compare two campaigns on the same seeds",
        description="Compare two configurations trial by trial: McNemar's test of the "
        "successes, paired differences of the figures with their intervals.",
        epilog=f"exit status: 0 done, {status}",
    )
    parser.add_argument("first", metavar="DIR_A", type=Path)
    parser.add_argument("second", metavar="DIR_B", type=Path)
    parser.set_defaults(run="sweep.show_comparison", reads=())
