"""Campaigns as data: a scenario, the values that vary, and the conditions of success.

``reading`` reads campaigns from YAML files.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from annotated_types import Ge, MinLen

from atlas_drake.clients.campaigns.distributions import check_distribution, example
from atlas_drake.config import (
    CheckedOnce,
    Configuration,
    NotNegative,
    Positive,
    Share,
    checked,
)
from atlas_drake.errors import ScenarioError
from atlas_drake.scenario import Scenario, with_values
from atlas_drake.scenario.scenario import Seed
from atlas_drake.simulation.sockets import BehaviorEntry
from atlas_drake.units import Seconds

METRICS_BY_DEFAULT = ("success", "landing", "tilt", "effort", "energy", "drift")
PARAMETERS = "parameters."
"""Prefix of paths to parameters of the trial function; others are the scenario's."""
_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?inf"
_CONDITION = re.compile(
    rf"\s*(?P<figure>[\w.\[\]]+)\s*"
    rf"(?:(?P<comparison><=|>=|==|!=|<|>)\s*(?P<number>{_NUMBER})\s*)?"
)


@dataclass(frozen=True)
class Threshold(Configuration):
    """A search for the largest value under which the robot still succeeds.

    Numbers have the unit of the value.
    """

    of: Annotated[str, MinLen(1)]
    """Path of the value, such as ``pushes[0].impulse``."""
    min: float = 0.0
    """Smallest value; not tried, because success is assumed."""
    max: float = 100.0
    """Largest value tried."""
    step: Positive[float] = 10.0
    """Step between the values tried, from ``min`` up."""
    replicas: Annotated[int, Ge(1)] = 5
    """Trials of each value; all values have the same seeds."""
    passes: Annotated[int, Ge(1)] = 4
    """Number of replicas that must succeed."""
    search: Literal["bisect", "climb"] = "bisect"
    """Order of the values: ``bisect`` halves the interval, ``climb`` goes up from
    ``min`` until too many trials fail."""

    def check(self) -> None:
        """Checks that there are values to try, and that replicas can pass."""
        if self.max <= self.min:
            raise ScenarioError.about("max", self.max, f"must be above {self.min:g}")
        if self.levels < 1:
            problem = f"must be at most max - min ({self.max - self.min:g})"
            raise ScenarioError.about("step", self.step, problem)
        if self.passes > self.replicas:
            problem = f"must be at most replicas ({self.replicas})"
            raise ScenarioError.about("passes", self.passes, problem)

    @property
    def levels(self) -> int:
        """Number of values on the grid above ``min``."""
        return int((self.max - self.min) / self.step + 1e-9)

    def value(self, level: int) -> float:
        """Returns the value at a level of the grid; level 0 is ``min``."""
        return self.min + level * self.step


@dataclass(frozen=True)
class Campaign(CheckedOnce):
    """Many runs of one scenario, each with its own seed."""

    name: str = "campaign"
    """Name in reports."""
    scenario: Scenario = field(default_factory=Scenario)
    """The scenario of all trials."""
    code: list[str] = field(default_factory=list)
    """Python files with the user's functions and parts, as for ``--with``."""
    trial: str = "run"
    """Function that runs a trial: ``run`` simulates the scenario's duration; a user's
    function (sim, parameters) -> figures has its name in ``code``, or is given as
    ``module:function``."""
    parameters: dict[str, Any] = field(default_factory=dict)
    """Parameters of the trial function."""
    vary: dict[str, Any] = field(default_factory=dict)
    """Distributions by path, such as ``pushes[0].impulse: {uniform: [10, 60]}``. Paths
    are those of ``--set``; ``parameters.NAME`` is for the trial function."""
    cases: dict[str, list[Any]] = field(default_factory=dict)
    """Values by path; every combination runs with the same seeds."""
    metrics: list[str] = field(default_factory=lambda: list(METRICS_BY_DEFAULT))
    """Functions that measure a trial: names of ``shipped.METRICS``, or a user's
    functions (sim) -> figures, named as in ``trial``."""
    success: list[str] = field(default_factory=lambda: ["success"])
    """Conditions on the figures, all of which must hold: ``NAME``, or such as
    ``landing_max_m <= 0.02``."""
    trials: Annotated[int, Ge(1)] = 100
    """Number of trials of each case; unused with a threshold."""
    seed: Seed = 0
    """Seed of the campaign."""
    seeds: Literal["spread", "counted"] = "spread"
    """Seeds of the trials: ``spread`` over all numbers, or ``counted`` up from the
    campaign's."""
    fresh: bool = False
    """Builds the simulation anew for each trial: for controllers that keep state
    outside Drake's Context."""
    trial_timeout: NotNegative[Seconds] = 0.0
    """Wall time after which a trial is ended and has failed; 0 for no limit."""
    threshold: Threshold | None = None
    """Search for the largest value with success, in place of independent trials."""
    goal: Share | None = None
    """Smallest share of successes for which the command ends with status 0; null for no
    goal."""

    def validate(self) -> Campaign:
        """Returns the campaign, checked except for the names of functions."""
        if self.is_checked:
            return self
        valid: Campaign = checked(Campaign, self)
        return valid

    def check(self) -> None:
        """Checks the conditions, and that the fields accept the values that vary."""
        for index, text in enumerate(self.success):
            if _CONDITION.fullmatch(text) is None:
                problem = "must be such as walk_ended, or landing_max_m <= 0.02"
                raise ScenarioError.about(f"success[{index}]", text, problem)
        self.check_values()
        self.mark_checked()

    def check_values(self, behaviors: Iterable[BehaviorEntry] | None = None) -> None:
        """Checks that the fields accept the values that vary.

        Without the user's ``behaviors``, fields that may be theirs are not checked.
        """
        if behaviors is not None:
            self.scenario.controller_config(behaviors)
        tried = []
        for path, distribution in self.vary.items():
            given = check_distribution(distribution, f"vary.{path}")
            tried.append((f"vary.{path}", path, example(given)))
        for path, values in self.cases.items():
            if not values:
                raise ScenarioError(f"cases.{path}", values, "must have values")
            tried += [(f"cases.{path}", path, value) for value in values]
        if self.threshold is not None:
            tried.append(("threshold.of", self.threshold.of, self.threshold.max))
        for name, path, value in tried:
            if path == "seed":
                raise ScenarioError(name, value, "differs in each trial; vary another")
            if path.startswith(PARAMETERS):
                continue
            try:
                scenario = with_values(self.scenario, {path: value})
                if path.startswith("controller.") and behaviors is not None:
                    scenario.controller_config(behaviors)
            except ScenarioError as error:
                raise ScenarioError(name, value, str(error)) from None


def figure_of(condition: str) -> str:
    """Returns the name of the figure in a valid condition."""
    return _parts(condition)[0]


def unmet(conditions: Iterable[str], figures: Mapping[str, Any]) -> list[str]:
    """Returns the conditions that do not hold; a missing figure meets none."""
    return [text for text in conditions if not _holds(text, figures)]


def _holds(condition: str, figures: Mapping[str, Any]) -> bool:
    name, comparison, number = _parts(condition)
    value = figures.get(name)
    if comparison is None:
        return bool(value)
    if not isinstance(value, int | float):
        return False
    return _COMPARISONS[comparison](value, float(number))


def _parts(condition: str) -> tuple[Any, ...]:
    """Returns figure, comparison and number; the last two are None without one."""
    found = _CONDITION.fullmatch(condition)
    assert found is not None  # Campaign.check has checked it.
    return found.group("figure", "comparison", "number")
