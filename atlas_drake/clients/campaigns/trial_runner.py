"""Runs trials, one after the other, in one process.

The simulations stay built: if two trials differ only in the fields that
``scenario.differences.OF_A_RUN`` names, the second restarts the simulation of the
first, with the same result bit for bit.
"""

from __future__ import annotations

import gc
import importlib
import logging
import math
import time
import traceback
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from atlas_drake.clients.campaigns.campaign import Campaign, unmet
from atlas_drake.clients.campaigns.plan import Record, Trial, parameters_of, scenario_of
from atlas_drake.clients.campaigns.shipped import METRICS, TRIALS, Figures
from atlas_drake.clients.parts_file import parts_in, run_file
from atlas_drake.clients.session import AtlasSimulation
from atlas_drake.config import plain_number
from atlas_drake.errors import ScenarioError, did_you_mean, shown
from atlas_drake.records import TickRecord
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.differences import built_in_difference
from atlas_drake.simulation.sockets import add_listener, registered

LISTENER = "metrics"
"""Name of the system that feeds records to the metrics."""
KEPT = 4
"""Number of simulations that a process keeps, such as one for each robot."""


class TrialRunner:
    """Runs the trials of one campaign, and keeps the simulations it has built."""

    def __init__(self, campaign: Campaign) -> None:
        """Runs the files of the campaign, and finds the functions that it names."""
        names: dict[str, Any] = {}
        for file in campaign.code:
            names |= run_file(Path(file), "code")
        self._campaign, self.parts = campaign, parts_in(names)
        campaign.check_values(registered(self.parts.get("behaviors", ())))
        self._trial = _function(campaign.trial, "trial", TRIALS, names)
        self._metrics = {
            name: _function(name, f"metrics[{index}]", METRICS, names)
            for index, name in enumerate(campaign.metrics)
        }
        self._kept: list[tuple[Scenario, AtlasSimulation]] = []
        self._updates: list[Callable[[TickRecord], None]] = []

    def __call__(self, trial: Trial) -> Record:
        """Runs a trial; returns its record, with the error if one was raised."""
        begin = time.perf_counter()
        self._built = False
        try:
            sim = self._simulation(scenario_of(self._campaign, trial))
            record = self.judged(sim, trial)
        except BaseException:  # SystemExit, too, ends the trial and not the process.
            # After an error the state of a simulation is unknown.
            self._kept.clear()
            gc.collect()
            record = trial.record(error=traceback.format_exc())
        wall_time = time.perf_counter() - begin
        return record | {
            "machine": {"wall_time_s": wall_time, "built_anew": self._built}
        }

    def judged(self, sim: AtlasSimulation, trial: Trial) -> Record:
        """Runs a trial in a simulation at its start; returns its record."""
        # Records are heard from the start of the run, by metrics of this trial alone.
        fed = {
            name: metric(sim.robot)
            for name, metric in self._metrics.items()
            if isinstance(metric, type)
        }
        self._updates[:] = [metric.update for metric in fed.values()]
        parameters = parameters_of(self._campaign, trial)
        figures = _plain(self._trial(sim, parameters), self._campaign.trial)
        if fed:
            listener: Any = sim.diagram.GetSubsystemByName(LISTENER)
            listener.flush(listener.GetMyContextFromRoot(sim.context))
        for name, metric in self._metrics.items():
            result = fed[name].result if name in fed else metric
            more = _plain(result(sim), name)
            for key in figures.keys() & more.keys():
                raise ValueError(f"{name}: there is a figure {key} already")
            figures |= more
        missed = unmet(self._campaign.success, figures)
        return trial.record(success=not missed, missed=missed, figures=figures)

    def simulation(self, trial: Trial, **arguments: Any) -> AtlasSimulation:
        """Builds the simulation of a trial, with more arguments such as ``log``."""
        return self._build(scenario_of(self._campaign, trial), **arguments)

    def _simulation(self, scenario: Scenario) -> AtlasSimulation:
        """Restarts a kept simulation, or builds a new one."""
        if not self._campaign.fresh:
            for place, (known, sim) in enumerate(self._kept):
                if built_in_difference(known, scenario) is None:
                    self._kept.append(self._kept.pop(place))
                    sim.restart(scenario)
                    return sim
        self._built = True
        sim = self._build(scenario)
        if len(self._kept) == KEPT:
            # A simulation is full of cycles, and the collector rests while one runs.
            del self._kept[0]
            gc.collect()
        self._kept.append((scenario, sim))
        return sim

    def _build(self, scenario: Scenario, **arguments: Any) -> AtlasSimulation:
        # A thousand trials say what is worth saying in their records.
        logging.getLogger("atlas_drake").propagate = False
        logging.getLogger("drake").setLevel(logging.ERROR)
        given = {**self.parts, **arguments}
        extend = given.pop("extend", ())
        own = [extend] if callable(extend) else extend
        robot = load_robot(scenario.model)

        def add_metrics(builder: Any, station: Any) -> None:
            metrics = self._metrics.values()
            for metric in metrics:
                if hasattr(metric, "extend"):
                    metric.extend(builder, station, robot)
            if any(isinstance(metric, type) for metric in metrics):
                add_listener(builder, station, LISTENER, self._update)

        return AtlasSimulation(scenario, extend=[add_metrics, *own], **given)

    def _update(self, record: TickRecord) -> None:
        """Feeds a record to the metrics of the present trial."""
        for update in self._updates:
            update(record)


def _function(
    name: str, path: str, shipped: Mapping[str, Any], own: Mapping[str, Any]
) -> Callable[..., Any]:
    """Finds a shipped function, one of the user's own, or ``module:function``."""
    found = {**shipped, **own}.get(name)
    if ":" in name:
        module, _, attribute = name.partition(":")
        try:
            found = getattr(importlib.import_module(module), attribute)
        except (ImportError, AttributeError, ValueError) as error:
            raise ScenarioError.about(path, name, str(error)) from error
    if not callable(found):
        hint = did_you_mean(name, [*shipped, *own]) or f" There are {[*shipped]}."
        raise ScenarioError(path, name, f"there is no function {name!r}.{hint}")
    function: Callable[..., Any] = found
    return function


def _plain(given: object, name: str) -> Figures:
    """Converts figures to plain values, and infinity and NaN to None."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise TypeError(f"{name} must return figures by name, returned {shown(given)}")
    figures: Figures = {}
    for key, value in given.items():
        plain = plain_number(value)
        if isinstance(plain, float) and not math.isfinite(plain):
            plain = None
        if not (isinstance(key, str) and isinstance(plain, int | float | str | None)):
            problem = f"{name}: {key!r} is {shown(value)}; must be a number or a word"
            raise TypeError(problem)
        figures[key] = plain
    return figures
