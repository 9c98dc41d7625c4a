"""Which fields of a scenario a simulation can take up without being built anew."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from atlas_drake.checked import as_plain
from atlas_drake.scenario import Scenario

OF_A_RUN = (
    "name",
    "duration",
    "seed",
    "jitter",
    "friction_jitter",
    "ground_friction",
    "pushes",
    "start.position",
    "start.yaw",
    "start.release_time",
)
"""Fields that matter only when a run begins or while it goes on. All others are built
into the diagram: the robot, the steps, the controller's numbers, the world."""


def built_in_difference(one: Scenario, other: Scenario) -> str | None:
    """Path of the first field in which the diagrams of two scenarios differ, if any."""
    ours, theirs = _flat(as_plain(one)), _flat(as_plain(other))
    for path in {**ours, **theirs}:
        of_a_run = any(path == f or path.startswith(f"{f}.") for f in OF_A_RUN)
        if not of_a_run and ours.get(path) != theirs.get(path):
            return path
    return None


def _flat(value: Any, path: str = "") -> dict[str, Any]:
    """Values by their path; lists are values."""
    if not isinstance(value, Mapping):
        return {path: value}
    found: dict[str, Any] = {}
    for name, item in value.items():
        found |= _flat(item, f"{path}.{name}" if path else str(name))
    return found
