"""What the page asks of scenarios: check one, start it, write it as YAML."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from atlas_drake.clients.cockpit.clock import Clock
from atlas_drake.clients.cockpit.fields import EXAMPLES
from atlas_drake.config import read_fields
from atlas_drake.errors import ScenarioError
from atlas_drake.messages import Behavior
from atlas_drake.scenario import (
    Scenario,
    load_scenario,
    scenario_from,
    with_settings,
)
from atlas_drake.scenario.differences import (
    built_in_difference,
    changed_fields,
    scenario_yaml,
)
from atlas_drake.simulation.done import scenario_of_what_was_done
from atlas_drake.simulation.sockets import BehaviorEntry
from atlas_drake.worlds.world_file import with_full_paths

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

NO_OTHER = (
    "this program runs one simulation: `atlas-drake teleop` can start another; "
    "seed, jitter, friction, pushes and start can change here"
)


@dataclass
class NextRun:
    """Holds the scenario that was asked for until the program takes it.

    Attributes:
        why_not: Why no other scenario can follow; empty if one can.
        scenario: The scenario; None if none was asked for.
    """

    why_not: str = NO_OTHER
    scenario: Scenario | None = None

    def take(self) -> Scenario | None:
        """Returns the scenario, which then is not asked for any more."""
        asked, self.scenario = self.scenario, None
        return asked


class ScenarioRequests:
    """Checks scenarios, starts them, and writes them as YAML."""

    def __init__(self, sim: AtlasSimulation, clock: Clock, next_run: NextRun) -> None:
        """Begins with the scenario of the simulation."""
        self._sim, self._clock, self._next = sim, clock, next_run

    def check(
        self,
        changes: Mapping[str, str] | None = None,
        text: str | None = None,
        example: str | None = None,
    ) -> bool:
        """Returns True if a scenario can be used; what is in force stays.

        Args:
            changes: Values by path, as the text that YAML has for them.
            text: YAML of a scenario that they change; None for the present one.
            example: Name of an example, likewise.

        Raises:
            ScenarioError: Naming the field that cannot be used.
        """
        self._made(changes, text, example)
        return True

    def start(
        self,
        changes: Mapping[str, str] | None = None,
        text: str | None = None,
        example: str | None = None,
    ) -> None:
        """Starts a scenario, as ``check`` describes it.

        Without another robot, world or controller it begins at once. Otherwise the
        program that simulates builds it, if it is one that can.

        Raises:
            ScenarioError: As ``check``, or if the program runs one simulation alone.
        """
        asked = self._made(changes, text, example)
        field = built_in_difference(self._sim.scenario, asked)
        if field is None:
            self._clock.restart(asked)
        elif self._next.why_not:
            raise ScenarioError(field, None, f"is changed; {self._next.why_not}")
        else:
            self._next.scenario = asked

    def written(self, changes: Mapping[str, str] | None = None) -> str:
        """Returns the present scenario with changes, as YAML."""
        return scenario_yaml(self._made(changes, None, None))

    def done(self) -> str:
        """Returns what was done since the last reset as a scenario, as YAML."""
        return scenario_yaml(scenario_of_what_was_done(self._sim))

    def _made(
        self,
        changes: Mapping[str, str] | None,
        text: str | None,
        example: str | None,
    ) -> Scenario:
        base = self._base(text, example)
        own = [
            one
            for one in self._sim.behaviors
            if isinstance(one, BehaviorEntry) and one.name not in Behavior.__members__
        ]
        settings = [f"{path}={value}" for path, value in (changes or {}).items()]
        return with_settings(base, settings).resolved(own)

    def _base(self, text: str | None, example: str | None) -> Scenario:
        if example is not None:
            known = {path.stem: path for path in EXAMPLES.glob("*.yaml")}
            if example not in known:
                raise ScenarioError("example", example, "there is no such example")
            return load_scenario(known[example])
        if text is None:
            return scenario_from(changed_fields(self._sim.scenario))
        raw = read_fields(text, "duration: 10")
        return scenario_from(with_full_paths(raw, Path.cwd()))
