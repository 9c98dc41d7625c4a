"""Objects that appear and disappear in Meshcat, live and in a recording.

A recording holds motions and visibility but no new objects; so objects are made once
and then shown or hidden. A recording must be started before the simulation is built;
otherwise it lacks the initial objects.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from pydrake.geometry import Meshcat

from atlas_drake.visualization.timeline import Timeline

SPARE = 16
"""Number of hidden marks that are kept for reuse when nothing is recorded."""


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
        """Shows exactly these marks.

        Args:
            marks: Values that compare equal if they look the same.
            time: Simulated time [s]; when it runs backward, a new run begins.
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
