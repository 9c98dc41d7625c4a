"""Changes of what Meshcat shows, which a recording plays back as they were seen.

Between two keys a recording fades numbers from one to the other, and its first key
counts from the very beginning. What jumps, or comes later, has to say so; here it does.
"""

from __future__ import annotations

from pydrake.geometry import Meshcat

from atlas_drake.visualization import FRAME_RATE

PERIOD = 1.0 / FRAME_RATE
"""Between two pictures [s]."""


class Timeline:
    """Sets properties at a time, each only when it changes.

    What has been set is known here and not in a Context: it is a fact about the
    browser, as with Drake's own visualisers.
    """

    def __init__(self, meshcat: Meshcat) -> None:
        """Knows nothing yet of what ``meshcat`` shows."""
        self._meshcat = meshcat
        self._visible: dict[str, bool] = {}
        self._numbers: dict[tuple[str, str], tuple[float, float]] = {}

    def show(self, path: str, visible: bool, time: float) -> None:
        """Shows or hides; where a recording begins it was the other way round.

        Args:
            path: Of something that is there already.
            visible: Whether it is seen from now on.
            time: Simulated time [s].
        """
        before = self._visible.get(path)
        if before == visible:
            return
        self._visible[path] = visible
        if before is None and time > 0.0:
            self._meshcat.SetProperty(path, "visible", not visible, 0.0)
            # Seen while a browser still loads the recording.
            self._meshcat.SetProperty(path, "visible", not visible)
        self._meshcat.SetProperty(path, "visible", visible, time)

    def jump(self, path: str, name: str, number: float, time: float) -> None:
        """Sets a number that stays until the next one.

        Args:
            path: Of something that is there already.
            name: Of the property.
            number: What it is from now on.
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
