"""Hooks of a simulation: called between two chunks, they may command and go back."""

import queue
import threading

import pytest

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
)
from atlas_drake.simulation.atlas_simulation import CHUNK


@pytest.fixture(scope="module")
def simulation():
    return AtlasSimulation()


@pytest.fixture
def sim(simulation):
    simulation.reset(seed=0)
    yield simulation
    simulation.hooks.clear()


def test_hooks_are_called_in_their_order_before_each_chunk(sim):
    called = []
    sim.hooks.append(lambda sim: called.append(("first", round(sim.time, 9))))
    sim.hooks.append(lambda sim: called.append(("second", round(sim.time, 9))))
    sim.advance(2.5 * CHUNK)
    times = (0.0, CHUNK, 2 * CHUNK)
    assert called == [(name, time) for time in times for name in ("first", "second")]


def test_a_hook_commands_and_may_remove_itself(sim):
    def freeze(sim):
        sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))
        sim.hooks.remove(freeze)

    sim.hooks.append(freeze)
    sim.advance(0.05)
    assert sim.hooks == []
    assert sim.current_behavior is Behavior.FREEZE


def test_an_advance_lasts_as_long_after_a_hook_has_gone_back(sim):
    begin = sim.snapshot()
    visits = []

    def back_once(sim):
        visits.append(sim.time)
        if sim.time > 0.05 and len(visits) < 5:
            sim.restore(begin)

    sim.hooks.append(back_once)
    sim.advance(0.1)
    assert visits[3] == pytest.approx(0.06)
    assert sim.time == pytest.approx(0.04)


def test_a_run_that_begins_anew_goes_on_as_long(sim):
    def begin_anew(sim):
        if sim.time > 0.05:
            sim.reset(seed=0)

    sim.hooks.append(begin_anew)
    sim.advance_to(0.1)
    assert sim.time == pytest.approx(0.04)


def test_what_a_hook_raises_ends_the_advance_alone(sim):
    def stop(sim):
        raise KeyboardInterrupt

    sim.hooks.append(stop)
    with pytest.raises(KeyboardInterrupt):
        sim.advance(0.1)
    sim.hooks.clear()
    sim.advance(0.1)
    assert sim.time == pytest.approx(0.1)


def test_another_thread_hands_over_to_a_hook(sim):
    waiting, refused = queue.SimpleQueue(), []

    def other():
        for use in (lambda: sim.publish(AtlasCommand()), lambda: sim.advance(0.1)):
            try:
                use()
            except RuntimeError as error:
                refused.append("hooks" in str(error))
        waiting.put(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))

    def hand_over(sim):
        if sim.time == 0.0:
            thread = threading.Thread(target=other)
            thread.start()
            thread.join()
            sim.publish(waiting.get())

    sim.hooks.append(hand_over)
    sim.advance(0.05)
    assert refused == [True, True]
    assert sim.current_behavior is Behavior.FREEZE
    sim.hooks.clear()
    sim.publish(AtlasCommand())  # Between two advances any thread may.
