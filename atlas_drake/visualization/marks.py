"""Objects that appear, disappear and change in Meshcat, live and in a recording.

A recording holds motions and properties but no new objects; so objects are made once
and then shown or hidden. It must be started before the simulation is built; otherwise
it lacks the initial objects. Between two keys it interpolates numbers, and its first
key is valid from the start: a jump, or a later first value, needs an extra key.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from pydrake.geometry import Meshcat

from atlas_drake.visualization import FRAME_RATE

PERIOD = 1.0 / FRAME_RATE
"""Time between two pictures [s]."""
SPARE = 16
"""Number of hidden marks that are kept for reuse when nothing is recorded."""


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
        """Shows or hides an object from ``time`` [s] on.

        A recording starts with the opposite state.
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
        """Sets a property of an object to a number from ``time`` [s] on."""
        before = self._numbers.get((path, name))
        if before is not None:
            last, since = before
            if last == number:
                return
            if time - since > 1.5 * PERIOD:
                self._meshcat.SetProperty(path, name, last, time - PERIOD)
        self._numbers[path, name] = number, time
        self._meshcat.SetProperty(path, name, number, time)


class Marks:
    """Shows a changing set of objects under one path.

    In a recording every mark keeps its object, which the recording shows again.
    Otherwise a new mark reuses the object of the mark that was hidden first, so that a
    view does not grow over hours.
    """

    def __init__(
        self,
        meshcat: Meshcat,
        path: str,
        draw: Callable[[str, object], None],
        recorded: bool,
    ) -> None:
        """Draws under ``path``.

        Args:
            meshcat: Meshcat instance to draw in.
            path: Common path of all marks.
            draw: Makes the object of a mark at a given path.
            recorded: True if a recording must be able to show all marks.
        """
        self._meshcat = meshcat
        self._path = path
        self._draw = draw
        self._recorded = recorded
        self._time = 0.0
        self._begin()

    def _begin(self) -> None:
        self._meshcat.Delete(self._path)
        self._timeline = Timeline(self._meshcat)
        # In the order in which they were last shown.
        self._paths: dict[object, str] = {}
        self._shown: set[object] = set()

    def show(self, marks: Iterable[object], time: float) -> None:
        """Shows exactly these marks from ``time`` [s] on.

        Marks that look the same are equal. When time runs backward, a new run begins.
        """
        wanted = set(marks)
        if time < self._time:
            self._begin()
        self._time = time
        for mark in self._shown - wanted:
            path = self._paths[mark] = self._paths.pop(mark)
            self._timeline.show(path, False, time)
        hidden = [mark for mark in self._paths if mark not in wanted]
        for mark in wanted - self._shown:
            if mark not in self._paths:
                if self._recorded or len(hidden) <= SPARE:
                    path = f"{self._path}/{len(self._paths)}"
                else:
                    path = self._paths.pop(hidden.pop(0))
                self._paths[mark] = path
                self._draw(path, mark)
            self._timeline.show(self._paths[mark], True, time)
        self._shown = wanted
