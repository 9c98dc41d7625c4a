"""The scenario that follows the present one, if the program lets one follow."""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.scenario import Scenario

NO_OTHER = (
    "this program runs one simulation: `atlas-drake teleop` can start another; "
    "seed, jitter, friction, pushes and start can change here"
)


@dataclass
class NextRun:
    """Holds the scenario that was asked for until the program takes it."""

    why_not: str = NO_OTHER
    scenario: Scenario | None = None

    def take(self) -> Scenario | None:
        """Returns the scenario, which then is not asked for any more."""
        asked, self.scenario = self.scenario, None
        return asked
