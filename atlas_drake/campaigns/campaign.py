"""Campaigns as data: a scenario, the values that vary, and the metrics.

``reading`` reads campaigns from YAML files.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from annotated_types import Ge, MinLen

from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.campaigns.conditions import check_conditions
from atlas_drake.campaigns.distributions import check_distribution, example
from atlas_drake.campaigns.errors import CampaignError
from atlas_drake.config import (
    CheckedOnce,
    Configuration,
    NotNegative,
    Positive,
    Share,
    checked,
)
from atlas_drake.errors import ScenarioError, shown
from atlas_drake.scenario import Scenario, with_values
from atlas_drake.scenario.scenario import Seed

METRICS_BY_DEFAULT = ("success", "landing", "tilt", "effort", "energy", "drift")
PARAMETERS = "parameters."
"""Prefix of paths to parameters of the trial function; others are the scenario's."""


@dataclass(frozen=True)
class Threshold(Configuration):
    """A search for the largest value under which the robot still succeeds."""

    of: Annotated[str, MinLen(1)]
    """Path of the value, such as ``pushes[0].impulse``."""
    least: float = 0.0
    """Smallest value; not tried, because success is assumed."""
    most: float = 100.0
    """Largest value tried."""
    within: Positive = 10.0
    """Step between the values tried, from ``least`` up."""
    replicas: Annotated[int, Ge(1)] = 5
    """Trials of each value; all values have the same seeds."""
    passes: Annotated[int, Ge(1)] = 4
    """Number of replicas that must succeed."""
    search: Literal["bisect", "climb"] = "bisect"
    """Order of the values: ``bisect`` halves the interval, ``climb`` goes up from
    ``least`` until too many trials fail."""

    def check(self) -> None:
        """Checks that there are values to try, and that replicas can pass."""
        span = self.most - self.least
        for name, good, wanted in (
            ("most", span > 0.0, f"above least ({self.least:g})"),
            ("within", self.levels >= 1, f"at most most - least ({span:g})"),
            ("passes", self.passes <= self.replicas, "from 1 to replicas"),
        ):
            if not good:
                value = getattr(self, name)
                problem = f"is {shown(value)}; must be {wanted}"
                raise CampaignError(name, value, problem)

    @property
    def levels(self) -> int:
        """Number of values on the grid above ``least``."""
        return int((self.most - self.least) / self.within + 1e-9)

    def value(self, level: int) -> float:
        """Returns the value at a level of the grid; level 0 is ``least``."""
        return self.least + level * self.within


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
    """Functions that measure a trial: names of ``metrics.METRICS``, or a user's
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
    trial_timeout: NotNegative = 0.0
    """Wall time after which a trial is ended and has failed [s]; 0 for no limit."""
    threshold: Threshold | None = None
    """Search for the largest value with success, in place of independent trials."""
    goal: Share | None = None
    """Smallest share of successes for which the command ends with status 0; null for no
    goal."""

    def validate(self) -> Campaign:
        """Returns the campaign with every field checked except the names of functions.

        Raises:
            ScenarioError: Naming the first field that cannot be used.
        """
        if self.is_checked:
            return self
        valid: Campaign = checked(Campaign, self)
        return valid

    def check(self) -> None:
        """Checks the conditions, and that the fields accept the values that vary."""
        check_conditions(self.success)
        self.check_values()
        self.mark_checked()

    def check_values(self, behaviors: Iterable[BehaviorEntry] | None = None) -> None:
        """Checks that the fields accept the values that vary.

        Args:
            behaviors: Entries of the user's own behaviors; None does not check the
                fields that may be theirs.

        Raises:
            ScenarioError: Naming the first field that does not.
        """
        if behaviors is not None:
            self.scenario.controller_config(behaviors)
        for path, distribution in self.vary.items():
            where = f"vary.{path}"
            given = check_distribution(distribution, where)
            self._try(path, example(given), where, behaviors)
        for path, values in self.cases.items():
            if not values:
                problem = f"is {shown(values)}; must be a list of values"
                raise CampaignError(f"cases.{path}", values, problem)
            for value in values:
                self._try(path, value, f"cases.{path}", behaviors)
        if self.threshold is not None:
            most = self.threshold.most
            self._try(self.threshold.of, most, "threshold.of", behaviors)

    def _try(
        self,
        path: str,
        value: Any,
        where: str,
        behaviors: Iterable[BehaviorEntry] | None,
    ) -> None:
        """Checks that a field accepts a value like this one."""
        if path == "seed":
            raise CampaignError(where, value, "differs in each trial; vary another")
        if path.startswith(PARAMETERS):
            return
        try:
            tried = with_values(self.scenario, {path: value})
            if path.startswith("controller.") and behaviors is not None:
                tried.controller_config(behaviors)
        except ScenarioError as error:
            raise CampaignError(where, value, str(error)) from None
