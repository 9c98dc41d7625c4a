"""Plays a scenario and keeps the record of every control tick; no test is here."""

from dataclasses import dataclass, field

import numpy as np

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Behavior, Scenario
from atlas_drake.messages.event import Event
from atlas_drake.records import TickRecord

SIDE = np.array([1.0, -1.0])
"""Side of the left and the right foot along y."""


@dataclass
class Run:
    """What a played scenario was, tick by tick."""

    sim: AtlasSimulation
    records: list[TickRecord] = field(default_factory=list)

    def advance(self, seconds: float) -> None:
        """Goes on for so long; ends where the robot falls."""
        period, end = self.sim.scenario.control_period, self.sim.time + seconds
        while self.sim.time < end - 0.5 * period and not self.sim.has_fallen:
            self.sim.advance(period)
            self.records.append(self.sim.record)

    def until(self, condition, seconds: float = 15.0) -> None:
        """Goes on until ``condition`` is true of the latest record."""
        end = self.sim.time + seconds
        while not condition(self.sim.record):
            assert self.sim.time < end, "it did not come to that"
            assert not self.sim.has_fallen, "the robot fell"
            self.advance(self.sim.scenario.control_period)

    def ask(self, behavior: str) -> None:
        """Asks for a behavior."""
        self.sim.publish(AtlasSimInterfaceCommand(behavior=behavior))

    def events(self, kind: str) -> list[Event]:
        """All events of a kind."""
        return [event for event in self.sim.events if event.kind == kind]

    def at(self, time: float) -> TickRecord:
        """The record of the tick at ``time`` [s]."""
        return min(self.records, key=lambda record: abs(record.time - time))


def play(message=None, seconds=None, **scenario) -> Run:
    """Plays a scenario from a message on, until the robot stands again."""
    run = Run(AtlasSimulation(Scenario(**scenario)))
    run.advance(0.05)
    if message is not None:
        run.sim.publish(message)
        run.advance(0.05)
    if seconds is None:
        run.until(stands)
    else:
        run.advance(seconds)
    return run


def stands(record: TickRecord) -> bool:
    """True if STAND is active."""
    return record.behavior.current == Behavior.STAND


def loads(record: TickRecord) -> np.ndarray:
    """The vertical forces on left and right foot [N]."""
    return np.array([record.feet.left_force[2], record.feet.right_force[2]])
