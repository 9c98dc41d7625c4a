"""What is done by hand can be done again by a scenario."""

import numpy as np
import pytest
from pydrake.common.yaml import yaml_load

from atlas_drake import AtlasSimulation
from atlas_drake.cockpit.operator import Operator
from atlas_drake.cockpit.record import brief, planned_push
from atlas_drake.messages import AtlasBehaviorStepData, AtlasSimInterfaceCommand
from atlas_drake.records.plain import message_from, to_plain
from atlas_drake.scenario import scenario_from


class ByHand:
    """Drives between two physics steps after a control tick."""

    def __init__(self):
        self.sim = AtlasSimulation()
        self.operator = Operator(self.sim)
        self.period = self.sim.scenario.control_period
        self.offset = 0.5 * self.sim.scenario.physics_step
        self.tick = 0
        self.go(2)

    def go(self, ticks):
        for _ in range(ticks):
            self.tick += 1
            self.sim.advance_to(self.tick * self.period + self.offset)
            self.operator.update(self.sim.time)

    def go_to_tick(self):
        """Stops at the next tick itself, where pushes begin with the same bits."""
        self.tick += 1
        self.sim.advance_to(self.tick * self.period)


def replayed(text):
    scenario = scenario_from(yaml_load(data=text))
    sim = AtlasSimulation(scenario)
    sim.advance_to(scenario.duration)
    return sim


def state_of(sim):
    return sim.plant.GetPositionsAndVelocities(
        sim.plant.GetMyContextFromRoot(sim.context)
    )


def test_a_short_run_by_hand_ends_in_the_same_bits():
    by_hand = ByHand()
    by_hand.operator.modes.request("MANIPULATE")
    by_hand.go_to_tick()
    by_hand.operator.pushes.push("utorso", [2.0, 3.0, -1.0])
    by_hand.go(20)
    again = replayed(by_hand.operator.scenario.done())
    assert again.time == by_hand.sim.time
    np.testing.assert_array_equal(state_of(again), state_of(by_hand.sim))


def first_change(sim):
    """Time of the first behavior since the last reset [s]."""
    times = [event.time for event in sim.events if event.kind == "behavior"]
    return times[-1]


def test_ticks_count_from_a_reset():
    by_hand = ByHand()
    begin = by_hand.tick + 1  # The first tick after the reset.
    by_hand.operator.clock.reset()
    by_hand.go(3)
    by_hand.operator.modes.request("MANIPULATE")
    by_hand.go(4)
    again = replayed(by_hand.operator.scenario.done())
    passed = first_change(by_hand.sim) - begin * by_hand.period
    assert first_change(again) == pytest.approx(passed)


def test_a_reset_forgets_what_was_done():
    by_hand = ByHand()
    by_hand.operator.pushes.push("utorso", [2.0, 0.0, 0.0])
    by_hand.operator.clock.reset(seed=4)
    by_hand.go_to_tick()
    fields = yaml_load(data=by_hand.operator.scenario.done())
    assert fields["seed"] == 4
    assert "pushes" not in fields


def test_going_back_forgets_what_came_after():
    by_hand = ByHand()
    snapshot = by_hand.sim.snapshot()
    by_hand.operator.joints.share(["l_arm_shx"], 255)
    by_hand.go(3)
    by_hand.operator.joints.share(["r_arm_shx"], 255)
    by_hand.operator._record.restore(snapshot)
    fields = yaml_load(data=by_hand.operator.scenario.done())
    assert len(fields["messages"]) == 1


def test_a_brief_message_is_the_message():
    message = AtlasSimInterfaceCommand(behavior=4)
    message.walk_params.step_queue[1] = AtlasBehaviorStepData(step_index=7)
    message.k_effort = [0, 255]
    plain = brief(to_plain(message), to_plain(AtlasSimInterfaceCommand()))
    assert len(str(plain)) < 200
    made = message_from(AtlasSimInterfaceCommand, plain)
    assert to_plain(made) == to_plain(message)


def test_a_push_keeps_its_force():
    force = np.array([-20.0, 30.0, 4.0])
    push = planned_push("utorso", force, 0.1)
    np.testing.assert_allclose(push.force(heading=2.0), force)
