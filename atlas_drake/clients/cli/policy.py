"""``--policy`` and what belongs to it: fields of the scenario's ``policy``."""

from __future__ import annotations

import argparse
import json
from pathlib import Path


def add_policy_options(parser: argparse.ArgumentParser) -> None:
    """Adds --policy and what belongs to it."""
    policy = parser.add_argument_group("who commands")
    policy.add_argument(
        "--policy",
        type=Path,
        metavar="FILE",
        help="a learned policy takes its joints after 0.3 s: an ONNX file with the "
        "metadata of its exporter, or a description in YAML (docs/policies.md); the "
        "scenario's policy.file, as --set has it",
    )
    policy.add_argument(
        "--policy-joints",
        type=_names,
        metavar="NAME,...",
        help="its joints in its own order, where the file does not name them",
    )
    policy.add_argument(
        "--velocity",
        type=_velocity,
        metavar="X,Y,TURN",
        help="velocity that it is asked for: ahead, left [m/s], turn [rad/s] "
        "(default: 0,0,0)",
    )
    policy.add_argument(
        "--watchdog",
        action="store_true",
        default=None,
        help="STAND takes the joints back when the policy's commands are late, no "
        "numbers, or far beyond a joint's stop",
    )


def policy_settings(options: argparse.Namespace) -> list[str]:
    """Returns these options as ``--set`` has them."""
    given = vars(options)  # Not every command has the options.
    file = given.get("policy")
    fields = {
        "file": None if file is None else str(file.absolute()),
        "joints": given.get("policy_joints"),
        "velocity": given.get("velocity"),
        "watchdog": given.get("watchdog"),
    }
    return [
        f"policy.{name}={json.dumps(value)}"
        for name, value in fields.items()
        if value is not None
    ]


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _velocity(text: str) -> list[float]:
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != 3:
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y,TURN, such as 0.5,0,0")
    return values
