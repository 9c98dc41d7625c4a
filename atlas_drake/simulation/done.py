"""Writes down what was done in a run, as a scenario that does it again.

A scenario's message acts on behaviors from the control tick after its time on, and on
joints at its time. A message by hand is therefore written with the last tick before
it, and acts on behaviors with the same bits, on joints up to a tick earlier. Of several
messages of one instant each but the first acts a tick later. A push at a tick has the
same bits, too; one between two ticks is spread over all of that tick.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from atlas_drake.messages import AtlasSimInterfaceCommand
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.event import MESSAGE, PUSH, Event
from atlas_drake.records.plain import to_plain
from atlas_drake.scenario import Scenario
from atlas_drake.scenario.timed_message import TimedMessage
from atlas_drake.systems.pushes import PlannedPush

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation
    from atlas_drake.simulation.run_log import Done

_SAME_TICK = 1e-6
"""Times closer than this share of a control period are the same."""


def scenario_of_what_was_done(sim: AtlasSimulation) -> Scenario:
    """Returns the scenario of a run in which the same is done until now.

    It begins with the tick of the last reset, or one tick before, if something was sent
    at that tick. Messages and pushes of a schedule, and messages of a policy, are among
    those that were done.

    Raises:
        ScenarioError: If too much was done to be kept.
    """
    beginning, done = sim.beginning, sim.done()
    period = beginning.scenario.control_period
    first = _ticks_before(beginning.time, period)
    sent = [
        (_tick_of(one, period) - first, _timed(one.event, sim.behaviors))
        for one in done
        if one.event.kind == MESSAGE
    ]
    wait = 1 if any(tick < 0 for tick, _ in sent) else 0
    begin = (first - wait) * period
    return replace(
        beginning.scenario,
        schedule="none",
        policy=None,
        duration=max(_since(begin, sim.time), period),
        messages=[
            replace(message, time=round((tick + wait) * period, 9))
            for tick, message in sent
            if message is not None
        ],
        pushes=[
            PlannedPush(**event.data, time=max(_since(begin, event.time), 0.0))
            for event in (one.event for one in done)
            if event.kind == PUSH
        ],
    )


def _tick_of(done: Done, period: float) -> int:
    """Returns the number of the tick at which a scenario sends a message."""
    time = done.event.time
    if done.is_published:
        return _ticks_before(time, period) - 1
    return math.floor(time / period + _SAME_TICK)


def _ticks_before(time: float, period: float) -> int:
    """Returns the number of ticks before a time [s], which is that of the next tick."""
    return math.ceil(time / period - _SAME_TICK)


def _since(begin: float, time: float) -> float:
    """Returns the time since ``begin`` [s], without rounding errors of the sum."""
    return round(time - begin, 9)


def _timed(event: Event, catalog: BehaviorCatalog) -> TimedMessage | None:
    """Returns a message as a scenario has it; None for one that asks for nothing."""
    message = event.data["message"]
    plain = brief(to_plain(message), to_plain(type(message)()))
    if isinstance(message, AtlasSimInterfaceCommand):
        asked = catalog.entry(catalog.find(message.behavior)).name
        plain = {**plain, "behavior": asked}
        return TimedMessage(atlas_sim_interface_command=plain)
    return TimedMessage(atlas_command=plain) if plain else None


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
