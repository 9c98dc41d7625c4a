"""Reads a policy: its network, and its description or the exporter's metadata."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from atlas_drake.clients.policies.description import PolicyDescription
from atlas_drake.clients.policies.network import Network
from atlas_drake.clients.policies.observation import TERMS, Seen, Term
from atlas_drake.config import checked, read_file, read_yaml
from atlas_drake.errors import ScenarioError, did_you_mean
from atlas_drake.messages import Imu

_OF_UNITREE = "num_actions"
"""Field by which a deploy file of ``unitree_rl_gym`` is recognized."""


@dataclass(frozen=True)
class Policy:
    """A network, what its numbers mean, and how its observation is computed."""

    network: Network
    description: PolicyDescription
    terms: tuple[Term, ...]


def read_policy(
    path: str | Path,
    joints: list[str] | None = None,
    terms: Mapping[str, Term] | None = None,
) -> Policy:
    """Reads a policy from a description in YAML, or an ONNX file with metadata.

    Args:
        path: A ``PolicyDescription`` in YAML; a deploy file of ``unitree_rl_gym``,
            beside an ONNX file of the name of its network; or an ONNX file with the
            metadata of mjlab, Isaac Lab or holosoma.
        joints: The policy's joints, for a file that does not name them.
        terms: Terms of your own, by name, beside ``observation.TERMS``.

    Raises:
        ScenarioError: Naming file and field, if it cannot be used.
        AtlasError: If onnxruntime is not installed.
    """
    path = Path(path)
    try:
        if path.suffix.lower() == ".onnx":
            network = Network(path)
            fields = _from_metadata(network.metadata, path.name)
        else:
            fields = read_yaml(read_file(path))
            if isinstance(fields, Mapping) and _OF_UNITREE in fields:
                fields = _from_unitree(fields)
            network = None
        if joints is not None and isinstance(fields, Mapping):
            fields = {**fields, "joints": joints}
        description = checked(PolicyDescription, fields)
        if network is None:
            network = Network(path.parent / description.network)
        functions, sizes = terms_of(description, terms)
        _check_sizes(description, network, sizes)
        return Policy(network, description, functions)
    except ScenarioError as error:
        raise error if str(path) in str(error) else error.within(path) from None


# ---- sizes -------------------------------------------------------------------


def terms_of(
    description: PolicyDescription, terms: Mapping[str, Term] | None = None
) -> tuple[tuple[Term, ...], list[int]]:
    """Returns the functions of the terms, and the size of each for the network.

    Args:
        description: The policy.
        terms: Terms of your own, by name, beside ``observation.TERMS``.

    Raises:
        ScenarioError: If there is no such term, or it has another number of scales.
    """
    known = {**TERMS, **(terms or {})}
    zero = np.zeros(len(description.joints))
    seen = Seen(Imu(), zero, zero, zero, np.zeros(3), 0.0, description.gait_period)
    functions, sizes = [], []
    for index, term in enumerate(description.observation):
        field = f"observation[{index}]"
        if term.name not in known:
            hint = did_you_mean(term.name, known) or f" There are {', '.join(known)}."
            problem = f"there is no term {term.name!r}.{hint}"
            raise ScenarioError(f"{field}.name", term.name, problem)
        size = len(known[term.name](seen))
        if len(term.scale) not in (1, size):
            problem = f"has {len(term.scale)} values, not 1 or {size}"
            raise ScenarioError(f"{field}.scale", term.scale, problem)
        functions.append(known[term.name])
        sizes.append(size * term.history)
    return tuple(functions), sizes


def _check_sizes(
    description: PolicyDescription, network: Network, sizes: list[int]
) -> None:
    """Checks the numbers of observations and actions against the network's."""
    count = len(description.joints)
    if network.action_size != count:
        problem = f"the network has {network.action_size} actions for {count} joints"
        raise ScenarioError("joints", description.joints, problem)
    if sum(sizes) != network.observation_size:
        listed = ", ".join(
            f"{term.name} {size}"
            for term, size in zip(description.observation, sizes, strict=True)
        )
        problem = (
            f"the network takes {network.observation_size} numbers, and the terms have "
            f"{sum(sizes)}: {listed}"
        )
        raise ScenarioError("observation", sum(sizes), problem)


# ---- formats of others -------------------------------------------------------


def _from_metadata(metadata: Mapping[str, str], network: str) -> dict[str, Any]:
    """Returns the fields that an exporter wrote into an ONNX file as texts."""
    needed = (
        "joint_names",
        "joint_stiffness",
        "joint_damping",
        "default_joint_pos",
        "action_scale",
        "observation_names",
    )
    absent = [name for name in needed if name not in metadata]
    if absent:
        problem = (
            f"has no metadata {', '.join(absent)}; write a description in YAML "
            "(docs/policies.md)"
        )
        raise ScenarioError("network", network, problem)
    names = _texts(metadata["observation_names"])
    histories = _texts(metadata.get("observation_history_lengths", ""))
    lengths = [int(float(text)) for text in histories] or [1] * len(names)
    if len(lengths) != len(names):
        problem = f"has {len(lengths)} values for {len(names)} terms"
        raise ScenarioError("observation_history_lengths", histories, problem)
    return {
        "network": network,
        "joints": _texts(metadata["joint_names"]),
        "position": _numbers(metadata, "default_joint_pos"),
        "kp": _numbers(metadata, "joint_stiffness"),
        "kd": _numbers(metadata, "joint_damping"),
        "action_scale": _numbers(metadata, "action_scale"),
        "observation": [
            {"name": name, "scale": [1.0], "history": max(length, 1)}
            for name, length in zip(names, lengths, strict=True)
        ],
    }


def _texts(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def _numbers(metadata: Mapping[str, str], name: str) -> list[float]:
    try:
        return [float(part) for part in _texts(metadata[name])]
    except ValueError:
        problem = f"{metadata[name]!r} is not a list of numbers"
        raise ScenarioError(name, metadata[name], problem) from None


def _from_unitree(given: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the fields of a deploy file of ``unitree_rl_gym``."""
    needed = (
        "policy_path",
        "default_angles",
        "kps",
        "kds",
        "action_scale",
        "ang_vel_scale",
        "cmd_scale",
        "dof_pos_scale",
        "dof_vel_scale",
    )
    for name in needed:
        if name not in given:
            raise ScenarioError(name, None, "is missing")

    def floats(name: str) -> list[float]:
        try:
            return [float(value) for value in np.atleast_1d(given[name])]
        except (TypeError, ValueError):
            problem = f"{given[name]!r} is not a list of numbers"
            raise ScenarioError(name, given[name], problem) from None

    step = float(given.get("simulation_dt", 0.002))
    scales = {
        "base_ang_vel": floats("ang_vel_scale"),
        "projected_gravity": [1.0],
        "velocity_commands": floats("cmd_scale"),
        "joint_pos": floats("dof_pos_scale"),
        "joint_vel": floats("dof_vel_scale"),
        "actions": [1.0],
        "phase": [1.0],
    }
    return {
        "network": Path(str(given["policy_path"])).with_suffix(".onnx").name,
        "position": floats("default_angles"),
        "kp": floats("kps"),
        "kd": floats("kds"),
        "action_scale": floats("action_scale"),
        "period": step * float(given.get("control_decimation", 10)),
        "observation": [
            {"name": name, "scale": scale} for name, scale in scales.items()
        ],
    }
