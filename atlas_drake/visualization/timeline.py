"""Property changes in Meshcat that a recording plays back correctly.

Between two keys a recording interpolates numbers, and its first key is valid from the
start. A jump, or a later first value, therefore needs an extra key, which this module
sets.
"""

from __future__ import annotations

from pydrake.geometry import Meshcat

from atlas_drake.visualization import FRAME_RATE

PERIOD = 1.0 / FRAME_RATE
"""Time between two pictures [s]."""


class Timeline:
    """Sets properties at a time, each only when it changes.

    The set values are kept here and not in a Context, because they belong to the
    browser, as with Drake's own visualisers.
    """

    def __init__(self, meshcat: Meshcat) -> None:
        """Starts without any property set in ``meshcat``."""
        self._meshcat = meshcat
        self._visible: dict[str, bool] = {}
        self._numbers: dict[tuple[str, str], tuple[float, float]] = {}

    def show(self, path: str, visible: bool, time: float) -> None:
        """Shows or hides an object; a recording starts with the opposite state.

        Args:
            path: Path of an existing object.
            visible: True to show the object from now on.
            time: Simulated time [s].
        """
        before = self._visible.get(path)
        if before == visible:
            return
        self._visible[path] = visible
        if before is None and time > 0.0:
            self._meshcat.SetProperty(path, "visible", not visible, 0.0)
            # Visible while a browser still loads the recording.
            self._meshcat.SetProperty(path, "visible", not visible)
        self._meshcat.SetProperty(path, "visible", visible, time)

    def jump(self, path: str, name: str, number: float, time: float) -> None:
        """Sets a number that stays until the next one.

        Args:
            path: Path of an existing object.
            name: Name of the property.
            number: Value from now on.
            time: Simulated time [s].
        """
        before = self._numbers.get((path, name))
        if before is not None:
            last, since = before
            if last == number:
                return
            if time - since > 1.5 * PERIOD:
                self._meshcat.SetProperty(path, name, last, time - PERIOD)
        self._numbers[path, name] = number, time
        self._meshcat.SetProperty(path, name, number, time)
