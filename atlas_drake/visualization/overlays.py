"""Switches of the overlays, by name.

Switches only; the overlays are drawn in the files beside this one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

from atlas_drake.errors import ScenarioError, did_you_mean

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
    "flags": "feedback flags in words",
    "follow": "the camera follows the robot; off, the mouse turns it",
}
"""Names and descriptions of the overlays."""

LOGGED = tuple(name for name in OVERLAYS if name != "forces")
"""Overlays of a replay: a log has the sum of the contact forces on each foot only."""
_COLORINGS = ("owner", "effort")
"""Overlays of which at most one is on, because a link has one color."""


class Overlays:
    """State of the switches.

    It may change while the simulation runs. It belongs to the view, as with Drake's own
    visualisers, and not to the Context.

    Attributes:
        recorded: True if Meshcat is recording already when the view is built. Then
            every picture is kept for the recording, and the recording has all overlays.
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
        self._on: set[str] = set()
        for name in on:
            self.switch(name, True)

    def is_on(self, name: str) -> bool:
        """Returns True if an overlay is shown.

        Args:
            name: A key of ``OVERLAYS``.
        """
        return name in self._on

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
        if on and name in _COLORINGS:
            self._on.difference_update(_COLORINGS)
        (self._on.add if on else self._on.discard)(name)


def overlays_from(text: str, offered: Collection[str] = OVERLAYS) -> list[str]:
    """Parses a list such as ``com,dcm``, or ``all`` or ``none``.

    Args:
        text: The list.
        offered: Overlays that can be shown: all, or LOGGED.

    Raises:
        ScenarioError: If there is no such overlay, or it is not offered.
    """
    words = [word.strip() for word in text.split(",") if word.strip()]
    if words == ["all"]:
        return [name for name in offered if name != "effort"]
    names = [] if words == ["none"] else words
    Overlays(names)
    for name in names:
        if name not in offered:
            raise ScenarioError(
                "--show",
                name,
                f"{name!r} ({OVERLAYS[name]}) is not in a log, which has "
                + ", ".join(offered),
            )
    return names
