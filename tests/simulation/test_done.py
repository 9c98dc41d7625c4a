"""What was done in a run can be done again by a scenario."""

import numpy as np
import pytest
from pydrake.common.yaml import yaml_load

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasBehaviorWalkParams,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    PlannedPush,
    Scenario,
    ScenarioError,
    Start,
)
from atlas_drake.records.plain import message_from, to_plain
from atlas_drake.scenario import scenario_from
from atlas_drake.scenario.differences import scenario_yaml
from atlas_drake.simulation import run_log
from atlas_drake.simulation.done import brief, scenario_of_what_was_done


class ByHand:
    """Drives between two physics steps after a control tick."""

    def __init__(self, sim):
        self.sim = sim
        self.period = sim.scenario.control_period
        self.offset = 0.5 * sim.scenario.physics_step
        self.tick = 0

    def go(self, ticks):
        self.tick += ticks
        self.sim.advance_to(self.tick * self.period + self.offset)

    def go_to_tick(self):
        """Stops at the next tick itself, where pushes begin with the same bits."""
        self.tick += 1
        self.sim.advance_to(self.tick * self.period)

    def ask(self, behavior, **fields):
        self.sim.publish(AtlasSimInterfaceCommand(behavior=behavior, **fields))


@pytest.fixture(scope="module")
def shared():
    return AtlasSimulation()


@pytest.fixture
def by_hand(shared):
    shared.reset(seed=0)
    driven = ByHand(shared)
    driven.go(2)
    return driven


def done(sim):
    """What was done as the fields of a scenario's file."""
    return yaml_load(data=scenario_yaml(scenario_of_what_was_done(sim)))


def replayed(sim):
    """The simulation of the file of what was done, at its end."""
    scenario = scenario_from(done(sim))
    again = AtlasSimulation(scenario)
    again.advance_to(scenario.duration)
    return again


def state_of(sim):
    return sim.plant.GetPositionsAndVelocities(
        sim.plant.GetMyContextFromRoot(sim.context)
    )


def times(fields):
    return [one["time"] for name in ("messages", "pushes") for one in fields[name]]


@pytest.mark.slow
def test_a_short_run_by_hand_ends_in_the_same_bits(by_hand):
    by_hand.ask("WALK", walk_params=AtlasBehaviorWalkParams(use_demo_walk=True))
    by_hand.go_to_tick()
    by_hand.sim.apply_push("utorso", [20.0, 30.0, -10.0], 0.1)
    by_hand.go_to_tick()
    by_hand.ask("STAND")
    by_hand.go(20)
    again = replayed(by_hand.sim)
    assert again.time == pytest.approx(by_hand.sim.time)
    np.testing.assert_array_equal(state_of(again), state_of(by_hand.sim))


@pytest.mark.slow
def test_messages_and_pushes_of_a_schedule_come_again_with_the_same_bits():
    schedule = [
        {"time": 0.0, "atlas_sim_interface_command": {"behavior": "MANIPULATE"}},
        {"time": 0.05, "atlas_sim_interface_command": {"behavior": "STAND"}},
        {"time": 0.05, "atlas_command": {"k_effort": 100, "position": 0.1}},
    ]
    pushes = [{"time": 0.03, "impulse": 7.0, "direction": 1.0, "lift": 0.3}]
    sim = AtlasSimulation(scenario_from({"messages": schedule, "pushes": pushes}))
    sim.advance_to(0.2)
    assert len(sim.commands) == 3
    again = replayed(sim)
    np.testing.assert_array_equal(state_of(again), state_of(sim))


@pytest.mark.slow
def test_the_commands_of_the_tutorial_are_done_again():
    sim = AtlasSimulation(Scenario(schedule="tutorial"))
    sim.advance_to(2.1)
    fields = done(sim)
    assert "schedule" not in fields
    assert len(fields["messages"]) == 1
    again = replayed(sim)
    np.testing.assert_array_equal(state_of(again), state_of(sim))


def first_change(sim):
    """Time of the first behavior since the last reset [s]."""
    return [event.time for event in sim.events if event.kind == "behavior"][-1]


def test_ticks_count_from_a_reset(by_hand):
    begin = by_hand.tick + 1  # The first tick after the reset.
    by_hand.sim.reset()
    by_hand.go(3)
    by_hand.ask("MANIPULATE")
    by_hand.go(4)
    again = replayed(by_hand.sim)
    passed = first_change(by_hand.sim) - begin * by_hand.period
    assert first_change(again) == pytest.approx(passed)


def test_a_reset_forgets_what_was_done(by_hand):
    by_hand.sim.apply_push("utorso", [20.0, 0.0, 0.0], 0.1)
    by_hand.ask("MANIPULATE")
    by_hand.sim.reset(seed=4)
    by_hand.sim.advance(by_hand.period)
    fields = done(by_hand.sim)
    assert fields["seed"] == 4
    assert not fields.keys() & {"pushes", "messages"}
    assert by_hand.sim.commands == []


def test_a_reset_elsewhere_begins_there(by_hand):
    by_hand.sim.reset("FREEZE", Start(position=[1.0, 2.0], yaw=0.5))
    fields = done(by_hand.sim)
    assert fields["initial_behavior"] == "FREEZE"
    again = AtlasSimulation(scenario_from(fields))
    np.testing.assert_allclose(state_of(again), state_of(by_hand.sim), atol=1e-12)


def test_going_back_over_a_reset_gives_no_negative_times(by_hand):
    snapshot = by_hand.sim.snapshot()
    by_hand.go(3)
    by_hand.sim.reset()
    by_hand.ask("FREEZE")
    by_hand.go(3)
    by_hand.sim.restore(snapshot)
    by_hand.ask("MANIPULATE")
    by_hand.sim.apply_push("utorso", [20.0, 0.0, 0.0], 0.1)
    by_hand.sim.advance(3 * by_hand.period)
    fields = done(by_hand.sim)
    assert len(times(fields)) == 2
    assert min(times(fields)) >= 0.0
    assert first_change(replayed(by_hand.sim)) == pytest.approx(
        first_change(by_hand.sim)
    )


def test_going_back_forgets_what_came_at_that_instant_and_after(by_hand):
    sim = by_hand.sim
    by_hand.ask("MANIPULATE")
    by_hand.go(1)
    snapshot = sim.snapshot()
    by_hand.ask("FREEZE")
    sim.apply_push("utorso", [20.0, 0.0, 0.0], 0.1)
    by_hand.go(3)
    by_hand.ask("STAND")
    for _ in range(2):
        sim.restore(snapshot)
        fields = done(sim)
        assert len(fields["messages"]) == len(sim.commands) == 1
        assert "pushes" not in fields
        by_hand.ask("FREEZE")
        sim.advance(0.02)


@pytest.mark.slow
def test_what_was_sent_at_a_reset_comes_a_tick_later(by_hand):
    by_hand.sim.reset(seed=0)
    by_hand.ask("MANIPULATE")
    by_hand.sim.advance(5 * by_hand.period)
    again = replayed(by_hand.sim)
    assert times(done(by_hand.sim) | {"pushes": []}) == [0.0]
    later = first_change(again) - first_change(by_hand.sim)
    assert later == pytest.approx(by_hand.period)


def test_only_accepted_commands_are_kept_and_a_message_of_nothing_is_not_written(
    by_hand,
):
    sim = by_hand.sim
    with pytest.raises(ValueError, match="FLY"):
        by_hand.ask("FLY")
    by_hand.ask(3, k_effort=[100] * sim.robot.num_joints)
    sim.publish(AtlasCommand())
    assert [one.message.k_effort[:1] for one in sim.commands] == [(100,), ()]
    assert [one.time for one in sim.commands] == [sim.time] * 2
    (message,) = done(sim)["messages"]
    assert message["atlas_sim_interface_command"]["behavior"] == "STAND"


def test_too_much_is_not_written(by_hand, monkeypatch):
    monkeypatch.setattr(run_log, "KEPT", 2)
    by_hand.sim.reset(seed=0)
    for behavior in ("STAND", "FREEZE", "STAND"):
        by_hand.ask(behavior)
    assert len(by_hand.sim.commands) == 2
    with pytest.raises(ScenarioError, match="messages"):
        scenario_of_what_was_done(by_hand.sim)


def test_a_brief_message_is_the_message():
    message = AtlasSimInterfaceCommand(behavior=4)
    message.walk_params.step_queue[1] = AtlasBehaviorStepData(step_index=7)
    message.k_effort = [0, 255]
    plain = brief(to_plain(message), to_plain(AtlasSimInterfaceCommand()))
    assert len(str(plain)) < 200
    made = message_from(AtlasSimInterfaceCommand, plain)
    assert to_plain(made) == to_plain(message)


@pytest.mark.parametrize("push", [{"impulse": 1.0}, {"lift": 1.0}, {"direction": 1.0}])
def test_a_force_is_given_alone(push):
    planned = PlannedPush(time=0.0, force_W=[1.0, 0.0, 0.0], **push)
    with pytest.raises(ScenarioError, match="force_W"):
        Scenario(pushes=[planned]).validate()
