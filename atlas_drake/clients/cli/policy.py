"""``--policy``: a learned policy commands joints of the run."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from atlas_drake.errors import AtlasError, ScenarioError

if TYPE_CHECKING:
    from atlas_drake.scenario import Scenario

START = 0.3
"""Time at which the policy takes its joints [s]: the robot stands by then."""


def add_policy_options(parser: argparse.ArgumentParser) -> None:
    """Adds --policy and what belongs to it."""
    policy = parser.add_argument_group("who commands")
    policy.add_argument(
        "--policy",
        type=Path,
        metavar="FILE",
        help="a learned policy takes its joints after 0.3 s: an ONNX file with the "
        "metadata of its exporter, or a description in YAML (docs/policies.md)",
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
        default=(0.0, 0.0, 0.0),
        metavar="X,Y,TURN",
        help="velocity that it is asked for: ahead, left [m/s], turn [rad/s] "
        "(default: 0,0,0)",
    )
    policy.add_argument(
        "--watchdog",
        action="store_true",
        help="STAND takes the joints back when the policy's commands are late, no "
        "numbers, or beyond a joint's stop",
    )


def with_policy(
    parts: dict[str, Any], options: argparse.Namespace, scenario: Scenario
) -> dict[str, Any]:
    """Returns the parts of a simulation with those of --policy, if it is given."""
    given = vars(options)  # Not every command has the options.
    if given.get("policy") is None:
        for name in ("policy_joints", "watchdog"):
            if given.get(name):
                raise AtlasError(f"--{name.replace('_', '-')} needs --policy")
        return parts
    if scenario.schedule != "none" or scenario.messages:
        problem = "the scenario has commands of its own: a policy takes their port"
        raise ScenarioError("--policy", str(options.policy), problem)
    # Drake's plants and onnxruntime load only for a policy.
    from atlas_drake.clients.policies.policy_user import PolicyUser, add_policy
    from atlas_drake.clients.policies.reading import read_policy
    from atlas_drake.clients.policies.watchdog import Watchdog, add_watchdog
    from atlas_drake.robot import load_robot
    from atlas_drake.simulation.sockets import additions

    robot = load_robot(scenario.model)
    policy = read_policy(options.policy, options.policy_joints)
    user = PolicyUser(policy, robot, velocity=options.velocity, start=START)

    def extend(builder: Any, station: Any) -> None:
        add_policy(builder, station, user)
        if options.watchdog:
            dog = Watchdog(robot, policy.description.period)
            add_watchdog(builder, station, dog, user)

    return {**parts, "extend": [*additions(parts.get("extend", ())), extend]}


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _velocity(text: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) != 3 or not all(abs(value) < 10.0 for value in values):
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y,TURN, such as 0.5,0,0")
    return values
