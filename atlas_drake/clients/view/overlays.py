"""Switches of the overlays, by name; ``shapes`` and ``colors`` have what they show."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from atlas_drake.errors import ScenarioError, did_you_mean

if TYPE_CHECKING:  # The command line says what is wrong before Drake is loaded.
    from atlas_drake.scenario.scenario import LogContent

OVERLAYS = {
    "com": "center of mass, and its projection on the ground",
    "dcm": "divergent component of motion",
    "cop": "center of pressure",
    "support": "support polygon of the feet on the ground",
    "plan": "planned paths of CoM and DCM",
    "swing": "path of the foot in the air",
    "forces": "contact forces where the feet touch",
    "owner": "links colored by the user's share of their joint",
    "effort": "links colored by their joint's share of its effort limit",
    "follow": "the camera follows the robot; off, the mouse turns it",
}
"""Names and descriptions of the overlays."""

LOG_FIELDS = {"plan": "paths", "swing": "paths", "forces": "contacts"}
"""Field of a scenario's ``log`` that an overlay of a log needs."""
_COLORINGS = ("owner", "effort")
"""Overlays of which at most one is on, because a link has one color."""


class Overlays:
    """State of the switches.

    It may change while the simulation runs. It belongs to the view, as with Drake's own
    visualizers, and not to the Context.

    Attributes:
        recorded: True if Meshcat is recording already when the view is built. Then
            every picture is kept for the recording, and the recording has all overlays.
        on: Names of the overlays that are shown.
    """

    def __init__(self, on: Iterable[str] = (), *, recorded: bool = False) -> None:
        """Switches overlays on.

        Args:
            on: Keys of ``OVERLAYS``.
            recorded: See the attribute.

        Raises:
            ScenarioError: If there is no such overlay.
        """
        self.recorded = recorded
        self.on: frozenset[str] = frozenset()
        for name in on:
            self.switch(name, True)

    def switch(self, name: str, on: bool) -> None:
        """Shows or hides an overlay; of the two colorings the later one counts.

        Args:
            name: A key of ``OVERLAYS``.
            on: True to show the overlay.

        Raises:
            ScenarioError: If there is no such overlay.
        """
        if name not in OVERLAYS:
            hint = did_you_mean(name, OVERLAYS)
            known = ", ".join(OVERLAYS)
            raise ScenarioError(
                "--show", name, f"there is no overlay {name!r}.{hint} Known are {known}"
            )
        excluded = set(_COLORINGS) if on and name in _COLORINGS else {name}
        self.on = self.on - excluded | ({name} if on else set())


def logged_overlays(content: LogContent) -> tuple[str, ...]:
    """Returns the overlays that can be shown of a log."""
    return tuple(
        name
        for name in OVERLAYS
        if name not in LOG_FIELDS or getattr(content, LOG_FIELDS[name])
    )


def overlays_from(text: str) -> list[str]:
    """Parses names with commas, ``all`` or ``none``; raises ScenarioError."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    if words == ["all"]:
        return [name for name in OVERLAYS if name != "effort"]
    names = [] if words == ["none"] else words
    Overlays(names)
    return names
