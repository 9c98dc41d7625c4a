"""Records of a run: at its start, after a reset, and with what a user adds."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import LeafSystem

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    InvalidMessageError,
    read_log,
)
from atlas_drake.behaviors.base import BehaviorProtocol
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.clients.cockpit.describe import columns_of
from atlas_drake.frozen import replace
from atlas_drake.messages.controller_status import ControllerStatus, Plan
from atlas_drake.messages.event import MESSAGE
from atlas_drake.systems.record_reader import add_listener

# ---- the start, a reset, events ----------------------------------------------


def test_before_the_first_tick_a_record_describes_the_present():
    sim = AtlasSimulation()
    begin, state = sim.record, sim.output("state")
    assert begin.time == 0.0
    np.testing.assert_array_equal(np.append(begin.state.q, begin.state.v), state)
    assert begin.request is None
    assert begin.events == ()
    assert begin.controller.tick_time is None
    with pytest.raises(ValueError, match="read-only"):
        begin.state.q[0] = 1.0
    sim.advance(0.02)
    sim.publish(AtlasSimInterfaceCommand(behavior="FREEZE"))
    sim.advance(0.02)
    moved = sim.record
    assert 0.02 < moved.time < sim.time
    assert moved.request is not None
    sim.reset()
    again = sim.record
    # Before the next tick, that is the robot as it was placed.
    assert again.time == sim.time
    np.testing.assert_allclose(again.state.q, begin.state.q, atol=1e-12)
    assert not again.state.v.any()
    assert again.behavior.current == begin.behavior.current
    assert (again.landed, again.footsteps) == ((), ())
    sim.advance(0.02)
    assert sim.record.time > again.time


def test_each_event_is_in_the_record_of_its_tick(tmp_path):
    records = []

    def listen(builder, station):
        add_listener(builder, station, "listener", records.append)

    sim = AtlasSimulation(extend=listen, log=tmp_path / "run.mcap")
    sim.advance_to(0.0305)
    sim.publish(AtlasSimInterfaceCommand(behavior="FREEZE"))
    with pytest.raises(InvalidMessageError):
        sim.publish(AtlasCommand(k_effort=[300] * 28))
    sim.apply_push("utorso", [5.0, 0.0, 0.0], 0.02)
    sim.advance_to(0.1)
    period = sim.scenario.control_period
    told = [(record.time, event) for record in records for event in record.events]
    assert [event.kind for _, event in told] == [
        MESSAGE,
        "refusal",
        "push",
        "behavior",
    ]
    for time, event in told:
        # Within the tick before: nothing is told early, late or twice.
        assert time - period - 1e-9 <= event.time <= time + 1e-9
    number = told[0][1].data["number"]
    assert records[-1].behavior.request_number == number
    assert records[-1].request == AtlasSimInterfaceCommand(behavior="FREEZE")
    # What comes after the last tick is in no record, and not lost.
    sim.publish(AtlasSimInterfaceCommand(behavior="STAND"))
    sim.close()
    log = read_log(tmp_path / "run.mcap")
    assert len(log.commands) == 2
    kept = [event for record in log.records() for event in record.events]
    assert kept == [event for _, event in told]


# ---- what a user adds --------------------------------------------------------


@dataclass(frozen=True)
class Mood:
    """A part of the feedback below."""

    valence: float


@dataclass(frozen=True)
class Waited:
    """Feedback of the behavior below."""

    ticks: int
    mood: Mood = Mood(0.5)
    name: str = ""


NAME = "calm, with half a character: \ud800"


class Waiting(BehaviorProtocol):
    """Holds the pose and counts its ticks."""

    def __init__(self, tools, config):
        self._freeze = tools.freeze

    def enter(self, *given):
        return (0, self._freeze.enter(*given))

    def update(self, state, *given, leaving):
        outcome = self._freeze.update(state[1], *given, leaving=leaving)
        return replace(outcome, state=(state[0] + 1, outcome.state))

    def feedback(self, state, status_flags):
        return Waited(state[0] // 4, name=NAME)


def test_feedback_of_a_users_behavior_needs_no_other_line(tmp_path, numbers_on_page):
    entry = BehaviorEntry(name="WAIT", number=100, make=Waiting)
    path = tmp_path / "run.mcap"
    with AtlasSimulation(behaviors=[entry], log=path) as sim:
        assert sim.record.feedback is None
        sim.advance(0.05)
        sim.publish(AtlasSimInterfaceCommand(behavior="WAIT"))
        sim.advance(0.1)
        last = sim.record
        values = numbers_on_page(sim, last)
        sim.publish(AtlasSimInterfaceCommand(behavior="FREEZE"))
        sim.advance(0.05)
        assert sim.record.feedback is None
    ticks = last.feedback["ticks"]
    assert ticks > 1
    assert last.feedback == {
        "ticks": ticks,
        "mood": {"valence": 0.5},
        "name": NAME[:-1] + "?",
    }
    assert values["feedback.ticks"] == ticks
    assert values["feedback.mood.valence"] == 0.5
    log = read_log(path)
    row = log.row_at(last.time)
    assert log.record(row) == last
    assert log.record(0).feedback is None
    assert log["feedback.ticks"][row] == ticks
    assert np.isnan(log["feedback.ticks"][0])
    # And the behavior is known to whoever reads the log alone.
    assert log.behavior(log["behavior.current"][row]).name == "WAIT"


@dataclass(frozen=True)
class Reach(Plan):
    """The plan of the controller below."""

    goal: np.ndarray = field(default_factory=lambda: np.array([0.3, 0.0]))
    urgency: float = 0.0


def reaching(robot, scenario):
    """A controller without effort, whose plan says more than others."""
    system = LeafSystem()
    system.DeclareVectorOutputPort(
        "behavior_effort", robot.num_joints, lambda _context, out: out.SetZero()
    )

    def status(context, out):
        plan = Reach(com_reference=[0.1, 0.2], urgency=context.get_time())
        out.set_value(ControllerStatus(plan=plan))

    system.DeclareAbstractOutputPort(
        "controller_status", lambda: AbstractValue.Make(ControllerStatus()), status
    )
    return system


def test_a_field_of_a_users_plan_needs_no_other_line(tmp_path, numbers_on_page):
    path = tmp_path / "run.mcap"
    with AtlasSimulation(controller=reaching, log=path) as sim:
        sim.advance(0.05)
        record = sim.record
    assert record.plan["goal"] == [0.3, 0.0]
    np.testing.assert_array_equal(record.balance.com_reference, [0.1, 0.2])
    shown = columns_of(sim.schema, record)
    assert {"plan.goal.0", "plan.goal.1", "plan.urgency"} <= {*shown}
    assert shown["balance.com_reference.x"]["unit"] == "m"
    values = numbers_on_page(sim, record)
    assert values["plan.goal.0"] == 0.3
    assert np.isnan(values["balance.dcm_reference.x"])
    assert "feedback.none" not in values
    log = read_log(path)
    assert log["plan.goal.0"].tolist() == [0.3] * len(log)
    urgency = [one.plan["urgency"] for one in log.records()]
    assert log["plan.urgency"].tolist() == urgency
