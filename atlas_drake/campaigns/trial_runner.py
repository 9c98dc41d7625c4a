"""Runs trials, one after the other, in one process.

The simulations stay built: if two trials differ only in the fields that
``scenario.differences.OF_A_RUN`` names, the second restarts the simulation of the
first, with the same result bit for bit.
"""

from __future__ import annotations

import gc
import logging
import math
import time
import traceback
from collections.abc import Callable, Mapping
from typing import Any

from atlas_drake.behaviors.registration import registered
from atlas_drake.campaigns.campaign import Campaign
from atlas_drake.campaigns.conditions import unmet
from atlas_drake.campaigns.metrics import METRICS, Figures
from atlas_drake.campaigns.plan import Trial, parameters_of, scenario_of
from atlas_drake.campaigns.shipped_trials import TRIALS
from atlas_drake.campaigns.sources import Sources
from atlas_drake.config import as_float, as_plain, checked, is_number, plain_number
from atlas_drake.errors import shown
from atlas_drake.records import TickRecord
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.differences import built_in_difference
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.systems.record_reader import add_listener

LISTENER = "metrics"
"""Name of the system that feeds records to the metrics."""
KEPT = 4
"""Number of simulations that a process keeps, such as one for each robot."""


class TrialRunner:
    """Runs the trials of one campaign; can be pickled."""

    def __init__(self, campaign: Campaign, sources: Sources) -> None:
        """Finds the functions.

        Raises:
            ScenarioError: If there is no such function, or a file fails, or the
                controller lacks a field that the campaign sets.
        """
        self._campaign, self._sources = campaign, sources
        campaign.check_values(registered(sources.all_parts().get("behaviors", ())))
        self._find_functions()

    def _find_functions(self) -> None:
        campaign, sources = self._campaign, self._sources
        self._trial = sources.function(campaign.trial, "trial", TRIALS)
        self._metrics = [
            sources.function(name, f"metrics[{index}]", METRICS)
            for index, name in enumerate(campaign.metrics)
        ]
        self._kept: list[tuple[Scenario, AtlasSimulation]] = []
        self._updates: list[Callable[[TickRecord], None]] = []

    def __getstate__(self) -> dict[str, Any]:
        """Leaves out functions and simulations; the other process makes its own."""
        # Drake's configurations cannot be pickled.
        return {"campaign": as_plain(self._campaign), "sources": self._sources}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        self._campaign = checked(Campaign, state["campaign"])
        self._sources = state["sources"]
        self._find_functions()

    def __call__(self, trial: Trial) -> dict[str, Any]:
        """Runs a trial.

        Returns:
            The trial's record, ready for JSON, with the error if one was raised.
        """
        begin = time.perf_counter()
        record: dict[str, Any] = {
            "trial": trial.number,
            "seed": trial.seed,
            "values": trial.values,
        }
        self._built = False
        try:
            sim = self._simulation(scenario_of(self._campaign, trial))
            record |= self.judged(sim, trial)
        except BaseException:  # SystemExit, too, ends the trial and not the process.
            # After an error the state of a simulation is unknown.
            self._kept.clear()
            gc.collect()
            record |= failed(traceback.format_exc())
        record["machine"] = {
            "wall_time_s": time.perf_counter() - begin,
            "built_anew": self._built,
        }
        return record

    def judged(self, sim: AtlasSimulation, trial: Trial) -> dict[str, Any]:
        """Runs a trial in a simulation at its start; returns success and figures."""
        parameters = parameters_of(self._campaign, trial)
        # Records are heard from the start of the run, by metrics of this trial alone.
        fed = {
            name: metric(sim.robot)
            for name, metric in zip(self._campaign.metrics, self._metrics, strict=True)
            if isinstance(metric, type)
        }
        self._updates[:] = [metric.update for metric in fed.values()]
        figures = _plain(self._trial(sim, parameters), self._campaign.trial)
        if fed:
            listener: Any = sim.diagram.GetSubsystemByName(LISTENER)
            listener.flush(listener.GetMyContextFromRoot(sim.context))
        for name, metric in zip(self._campaign.metrics, self._metrics, strict=True):
            result = fed[name].result if name in fed else metric
            more = _plain(result(sim), name)
            for key in figures.keys() & more.keys():
                raise ValueError(f"{name}: there is a figure {key} already")
            figures |= more
        missed = unmet(self._campaign.success, figures)
        return {
            "success": not missed,
            "missed": missed,
            "figures": figures,
            "error": None,
        }

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
        quiet()
        given = {**self._sources.all_parts(), **arguments}
        extend = given.pop("extend", None)
        robot = load_robot(scenario.model)

        def extend_all(builder: Any, station: Any) -> None:
            for metric in self._metrics:
                if hasattr(metric, "extend"):
                    metric.extend(builder, station, robot)
            if any(isinstance(metric, type) for metric in self._metrics):
                add_listener(builder, station, LISTENER, self._update)
            if extend is not None:
                extend(builder, station)

        return AtlasSimulation(scenario, extend=extend_all, **given)

    def _update(self, record: TickRecord) -> None:
        """Feeds a record to the metrics of the present trial."""
        for update in self._updates:
            update(record)


def failed(why: str) -> dict[str, Any]:
    """Returns the result of a trial that an error ended."""
    return {"success": False, "missed": [], "figures": {}, "error": why}


def quiet() -> None:
    """Silences per-trial log output."""
    logging.getLogger("atlas_drake").propagate = False
    logging.getLogger("drake").setLevel(logging.ERROR)


def _plain(given: object, name: str) -> Figures:
    """Converts figures to plain values, and infinity and NaN to None.

    Raises:
        TypeError: If a user's function returns anything but figures.
    """
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise TypeError(f"{name} must return figures by name, returned {shown(given)}")
    figures: Figures = {}
    for key, value in given.items():
        if not isinstance(key, str):
            raise TypeError(f"{name}: the name of a figure is {shown(key)}")
        plain = plain_number(value)
        number = as_float(plain)
        if number is not None and not math.isfinite(number):
            plain = None
        if not (plain is None or is_number(plain) or isinstance(plain, bool | str)):
            raise TypeError(
                f"{name}: {key} is {shown(value)}; must be a number, a word or None"
            )
        figures[key] = plain
    return figures
