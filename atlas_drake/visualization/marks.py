"""Things that appear and disappear in Meshcat, live and in a recording alike.

A recording holds motions and visibility but no new objects; so objects are made once
and then shown or hidden. A recording has to be started before the simulation is built,
or it lacks what is shown from the beginning.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from pydrake.geometry import Meshcat


class Marks:
    """Shows a changing set of objects under one path.

    What has been drawn is known here and not in a Context: it is a fact about the
    browser, as with Drake's own visualisers.
    """

    def __init__(
        self, meshcat: Meshcat, path: str, draw: Callable[[str, object], None]
    ) -> None:
        """Draws under ``path``.

        Args:
            meshcat: Where to.
            path: Of all marks together.
            draw: Makes the object of a mark at the path that it is given.
        """
        self._meshcat = meshcat
        self._path = path
        self._draw = draw
        self._paths: dict[object, str] = {}
        self._shown: set[object] = set()
        self._time = 0.0
        meshcat.Delete(path)

    def show(self, marks: Iterable[object], time: float) -> None:
        """Shows these marks and no others.

        Args:
            marks: Values that compare equal when they look the same.
            time: Simulated time [s]; when it runs backward, a new run begins.
        """
        wanted = set(marks)
        if time < self._time:
            self._meshcat.Delete(self._path)
            self._paths.clear()
            self._shown.clear()
        self._time = time
        for mark in self._shown - wanted:
            self._meshcat.SetProperty(self._paths[mark], "visible", False, time)
        for mark in wanted - self._shown:
            if mark not in self._paths:
                path = f"{self._path}/{len(self._paths)}"
                self._paths[mark] = path
                self._draw(path, mark)
                if time > 0.0:
                    # Where a recording is rewound to, the mark is yet to come.
                    self._meshcat.SetProperty(path, "visible", False, 0.0)
            self._meshcat.SetProperty(self._paths[mark], "visible", True, time)
        self._shown = wanted
