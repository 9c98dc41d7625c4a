"""Events between two instants: whoever reads, and when, gets each of them once."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from atlas_drake.frozen import NOTHING, replace
from atlas_drake.messages import AtlasCommand, Behavior, accept
from atlas_drake.messages.commands import apply, commands_at_start
from atlas_drake.messages.controller_status import KEPT_EVENTS, ControllerStatus
from atlas_drake.messages.event import READ_WITHIN, Event, append_recent
from atlas_drake.robot import load_robot
from atlas_drake.systems.fall_monitor import Fall
from atlas_drake.systems.push_source import Push, PushState
from atlas_drake.systems.tick_events import Marks, events_between, marks_at

ROBOT = load_robot()
START = commands_at_start(ROBOT, Behavior.STAND)
OUTCOMES = {
    "message": accept(AtlasCommand(), ROBOT),
    "refusal": accept(AtlasCommand(position=[0.0]), ROBOT),
}
PERIOD = 0.005
"""Time between two instants [s]."""
OFTEN = int(READ_WITHIN / PERIOD) - 1
"""Most instants between two reads."""


class Run:
    """The systems that keep events, moved on from instant to instant."""

    def __init__(self, released=None):
        self.time = 0.0
        self.happened = []
        """Time and kind of all events so far."""
        self.commands, self.pushes, self.fall = START, PushState(), NOTHING
        self.status, self.released = ControllerStatus(), released

    def go_on(self, kinds):
        before, self.time = self.time, self.time + PERIOD
        if before < (self.released or 0.0) <= self.time:
            self.happened.append((self.released, "gantry"))
        for kind in kinds:
            if kind == "fall" and self.fall is not NOTHING:
                continue
            self.happened.append((self.time, kind))
            if kind in OUTCOMES:
                self.commands, _ = apply(
                    self.commands, OUTCOMES[kind], ROBOT, self.time
                )
            elif kind == "push":
                push = Push("utorso", np.zeros(3), self.time, 0.01)
                self.pushes = self.pushes.with_push(push)
            elif kind == "fall":
                self.fall = Fall(self.time, "tilt")
            else:
                event = Event(self.time, kind, "of the controller")
                self.status = replace(
                    self.status,
                    events=append_recent(self.status.events, event, KEPT_EVENTS),
                    event_count=self.status.event_count + 1,
                )

    def reset(self):
        """As the station does; the controller starts its count again."""
        self.status, self.fall = ControllerStatus(), NOTHING

    def marks(self):
        return marks_at(
            self.time,
            self.status.event_count,
            self.commands,
            self.pushes,
            self.fall,
            self.released,
        )

    def between(self, before, after):
        given = self.status, self.commands, self.pushes, self.fall
        return [(e.time, e.kind) for e in events_between(before, after, *given)]


KINDS = [*OUTCOMES, "push", "fall", "behavior"]
INSTANT = st.tuples(st.lists(st.sampled_from(KINDS), max_size=4), st.booleans())
DENSE = [(4 * KINDS, number == 40) for number in range(80)]
"""More than any system keeps; the reader comes as seldom as it may."""


@settings(deadline=None)
@example(instants=DENSE, released=None)
@given(
    instants=st.lists(INSTANT, max_size=80), released=st.none() | st.floats(0.001, 0.3)
)
def test_readers_at_any_instants_lose_and_double_nothing(instants, released):
    run = Run(released)
    read_at, seen, unread = Marks(), [], 0
    ticks, recorded = [Marks()], []
    for kinds, reads in instants:
        run.go_on(kinds)
        if len(ticks) > 1:  # A record may be read until the next tick.
            recorded += run.between(*ticks[-2:])
        ticks.append(run.marks())
        unread += 1
        if reads or unread == OFTEN:
            found = run.between(read_at, ticks[-1])
            assert found == sorted(found, key=lambda event: event[0])
            read_at, seen, unread = ticks[-1], seen + found, 0
            assert run.between(read_at, ticks[-1]) == []
    seen += run.between(read_at, run.marks())
    recorded += run.between(*ticks[-2:]) if instants else []
    assert sorted(seen) == sorted(recorded) == sorted(run.happened)


def test_a_reset_loses_nothing_that_comes_after_it():
    run = Run()
    run.go_on(["behavior", "behavior", "fall"])
    before = run.marks()
    run.reset()
    assert run.between(before, run.marks()) == []
    run.go_on(["behavior", "fall", "message"])
    assert sorted(run.between(before, run.marks())) == sorted(run.happened[3:])


def test_a_reader_ahead_of_the_run_gets_nothing():
    """As after a step back in time, to an older Context."""
    run, later = Run(), Run()
    for one, count in ((run, 1), (later, 3)):
        one.go_on(count * ["message", "refusal", "push"])
    assert run.between(later.marks(), run.marks()) == []


@pytest.mark.parametrize("released", [None, 1.0])
def test_a_gantry_that_still_holds_is_no_event(released):
    run = Run(released)
    run.go_on([])
    assert run.between(Marks(), run.marks()) == []
