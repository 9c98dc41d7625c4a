"""Writes down what is done by hand, as a scenario that does it again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from atlas_drake.messages import AtlasCommand, AtlasSimInterfaceCommand
from atlas_drake.records.plain import to_plain
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.pushes import PlannedPush
from atlas_drake.scenario.timed_message import TimedMessage

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation
    from atlas_drake.simulation.run_log import Snapshot

Done = TimedMessage | PlannedPush


class Recorded:
    """A simulation whose commands are written down; all else is the simulation's own.

    A scenario's message acts from the tick of control after its time on, and joints
    hear it at once. A message by hand is therefore written with the last tick before
    it, and acts on behaviors with the same bits, on joints up to a tick earlier. Of
    several messages of one instant each but the first acts a tick later. A push at a
    tick has the same bits, too; one between two ticks is spread over all of that tick.
    """

    _done: list[tuple[float, Done]]

    def __init__(self, sim: AtlasSimulation) -> None:
        """Writes down what goes to ``sim`` from now on."""
        self._sim = sim
        self._begin()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._sim, name)

    def publish(self, message: AtlasCommand | AtlasSimInterfaceCommand) -> None:
        """Sends a message as the simulation does, and writes it down."""
        self._sim.publish(message)
        plain = brief(to_plain(message), to_plain(type(message)()))
        name = "atlas_command"
        if isinstance(message, AtlasSimInterfaceCommand):
            name = "atlas_sim_interface_command"
            catalog = self._sim.behaviors
            asked = catalog.entry(catalog.find(message.behavior)).name
            plain = {**plain, "behavior": asked}
        if plain:
            self._write(TimedMessage(**{name: plain}))

    def apply_push(self, body: str, force_W: Sequence[float], duration: float) -> None:
        """Pushes as the simulation does, and writes it down."""
        push = planned_push(body, force_W, duration)
        self._sim.apply_push(body, push.force(0.0), duration)
        self._write(push)

    def reset(self, **how: Any) -> None:
        """Resets the simulation; what was done before is forgotten."""
        self._sim.reset(**how)
        self._begin()

    def restart(self, scenario: Scenario) -> None:
        """Begins a new run; what was done before is forgotten."""
        self._sim.restart(scenario)
        self._begin()

    def restore(self, snapshot: Snapshot) -> None:
        """Goes to a snapshot; what was done after it is forgotten."""
        self._sim.restore(snapshot)
        self._done = [one for one in self._done if one[0] <= self._sim.time]

    def as_scenario(self) -> Scenario:
        """Returns the scenario of the run with all that was done until now.

        It begins with the tick of the last reset, and ends now. What was sent right
        then needs a tick before it, by which all comes later.
        """
        scenario, period = self._sim.scenario, self._sim.scenario.control_period
        first = _tick(self._since, period)
        sent = [
            (_tick(time, period) - first - 1, done)
            for time, done in self._done
            if isinstance(done, TimedMessage)
        ]
        wait = 1 if any(tick < 0 for tick, _ in sent) else 0
        begin = (first - wait) * period
        return replace(
            scenario,
            schedule="none" if first else scenario.schedule,
            duration=max(_since(begin, self._sim.time), period),
            messages=_later(scenario.messages, begin)
            + [
                replace(done, time=round((tick + wait) * period, 9))
                for tick, done in sent
            ],
            pushes=_later(scenario.pushes, begin)
            + [
                replace(done, time=max(_since(begin, time), 0.0))
                for time, done in self._done
                if isinstance(done, PlannedPush)
            ],
        )

    def _begin(self) -> None:
        self._since = self._sim.time
        self._done = []

    def _write(self, done: Done) -> None:
        self._done.append((self._sim.time, done))


def _tick(time: float, period: float) -> int:
    """Returns the number of the first tick that is not before a time [s]."""
    return math.ceil(time / period - 1e-6)


def _since(begin: float, time: float) -> float:
    """Returns the time since ``begin`` [s], without rounding errors of the sum."""
    return round(time - begin, 9)


def _later(planned: Sequence[Any], begin: float) -> list[Any]:
    """Returns what a scenario plans, counted from a time in its run [s]."""
    if begin <= 0.0:
        return list(planned)
    timed = [one for one in planned if one.time is not None and one.time >= begin]
    return [replace(one, time=_since(begin, one.time)) for one in timed]


def planned_push(body: str, force_W: Sequence[float], duration: float) -> PlannedPush:
    """Returns a push as a scenario has it, at time 0."""
    x, y, z = map(float, np.asarray(force_W) * duration)
    return PlannedPush(
        impulse=math.hypot(x, y),
        direction=math.atan2(y, x),
        lift=z,
        frame="world",
        body=body,
        duration=duration,
        time=0.0,
    )


def brief(plain: Any, blank: Any) -> Any:
    """Returns what a message has beyond a blank one, both as plain data."""
    if isinstance(plain, dict) and isinstance(blank, dict):
        return {
            name: brief(value, blank.get(name))
            for name, value in plain.items()
            if value != blank.get(name)
        }
    if isinstance(plain, list) and blank and isinstance(blank, list):
        if not isinstance(blank[0], dict):
            return plain
        used = [i for i, one in enumerate(plain) if one not in blank[i : i + 1]]
        return [brief(one, blank[0]) for one in plain[: max(used, default=-1) + 1]]
    return plain
