"""In what scenarios differ: fields of a run, and fields that are built in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from atlas_drake.config import as_plain, joined
from atlas_drake.scenario.scenario import Scenario

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


def is_of_a_run(path: str) -> bool:
    """Returns True if the field of a path matters to a run alone."""
    return any(path == one or path.startswith(f"{one}.") for one in OF_A_RUN)


def built_in_difference(one: Scenario, other: Scenario) -> str | None:
    """Path of the first field in which the diagrams of two scenarios differ, if any."""
    ours, theirs = flat(as_plain(one)), flat(as_plain(other))
    for path in {**ours, **theirs}:
        if not is_of_a_run(path) and ours.get(path) != theirs.get(path):
            return path
    return None


def flat(value: Any, path: str = "") -> dict[str, Any]:
    """Returns the values within mappings by their path; lists are values."""
    if not isinstance(value, Mapping):
        return {path: value}
    found: dict[str, Any] = {}
    for name, item in value.items():
        found |= flat(item, joined(path, name))
    return found
