"""Shapes of what tasks are made of, checked quickly enough for every tick.

Where all is well a check compares one tuple; the rest is for the error.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from atlas_drake.errors import shown


def task_name(task: object) -> str:
    """Return what to call a task in an error: its kind, and its frame if it has one."""
    name = type(task).__name__
    frame = getattr(task, "frame", None)
    return name if frame is None else f"{name} on {frame!r}"


def shaped(value: Any, shape: tuple[int, ...], name: str, owner: str) -> np.ndarray:
    """Return a value as an array.

    Args:
        value: An array, or a list of numbers.
        shape: That it must have.
        name: Of the value.
        owner: Whose it is, see ``task_name``.

    Raises:
        ValueError: If it has another shape, or is made of anything but numbers; it
            names value and owner.
    """
    if type(value) is np.ndarray and value.shape == shape:
        return value
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.array(None)
    if array.dtype == object:
        raise ValueError(
            f"{name} of {owner} must be numbers of shape {shape}, is {shown(value)}"
        )
    if array.shape != shape:
        raise ValueError(
            f"{name} of {owner} must have shape {shape}, has {array.shape}"
        )
    return array
