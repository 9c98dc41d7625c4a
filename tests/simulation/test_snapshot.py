"""A stored snapshot: a run goes on from it as it did before, to the bit."""

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    PlannedPush,
    Scenario,
    ScenarioError,
)
from atlas_drake.scenario import Jitter
from atlas_drake.scenario.timed_message import TimedMessage


def scenario(**fields):
    """A run with everything that a snapshot holds: noise, jitter, pushes, messages."""
    return Scenario(
        noise="rough",
        state="estimated",
        jitter=Jitter(mass=0.05, joints=0.01),
        friction_jitter=0.1,
        pushes=[PlannedPush(time=0.09, impulse=5.0, body="pelvis")],
        messages=[
            TimedMessage(
                time=0.12, atlas_sim_interface_command={"behavior": "MANIPULATE"}
            )
        ],
        **fields,
    )


@pytest.fixture(scope="module")
def shared():
    return AtlasSimulation(scenario(seed=1))


@pytest.fixture
def sim(shared):
    shared.reset(seed=1)
    return shared


def disturb(sim):
    """The user takes an arm, and a push begins; both are pending at this instant."""
    k_effort = [0] * 28
    k_effort[20] = 200
    sim.publish(AtlasCommand(position=[0.3] * 28, k_effort=k_effort))
    sim.apply_push("utorso", [60.0, 20.0, 0.0], 0.1)


def record(sim, seconds=0.15):
    """All that can be seen of a run: states, messages, events, figures."""
    seen = []
    for _ in range(5):
        sim.advance(0.2 * seconds)
        numbers = [sim.output(name) for name in ("state", "effort", "foot_wrenches")]
        seen += [part.tobytes() for part in numbers]
        seen += [sim.imu, sim.atlas_state, sim.atlas_sim_interface_state]
    summary = sim.summary()
    for timing in ("wall_time", "real_time_factor", "controller_tick_ms"):
        del summary[timing]
    active = [push.body for push in sim.output("pushes").active]
    return seen, list(sim.events), summary, sim.scenario, active


# At a control tick, at a physics step, and between two steps.
@pytest.mark.parametrize("begin", [0.063, 0.066, 0.0701])
def test_a_restored_run_goes_on_to_the_bit(sim, begin):
    sim.advance_to(begin)
    disturb(sim)
    snapshot = sim.snapshot()
    assert snapshot.time == sim.time == begin
    straight = record(sim)
    kinds = [event.kind for event in straight[1]]
    assert kinds.count("push") == 2
    assert kinds.count("command") == 1
    for _ in range(2):
        sim.restore(snapshot)
        assert sim.time == begin
        assert record(sim) == straight


def test_a_moment_survives_a_run_with_another_seed(sim):
    sim.advance(0.05)
    snapshot, mass = sim.snapshot(), total_mass(sim)
    straight = record(sim)
    sim.reset(seed=2)
    sim.advance(0.1)
    assert total_mass(sim) != mass
    sim.restore(snapshot)
    assert total_mass(sim) == mass
    assert record(sim) == straight
    # A reset puts the robot where that run began.
    sim.reset()
    again = sim.output("state")
    sim.reset(seed=1)
    np.testing.assert_array_equal(sim.output("state"), again)


def total_mass(sim):
    return sim.plant.CalcTotalMass(sim.plant.GetMyContextFromRoot(sim.context))


def test_a_run_that_goes_another_way_leaves_the_moment_alone(sim):
    sim.advance(0.02)
    snapshot = sim.snapshot()
    straight = record(sim)
    sim.restore(snapshot)
    sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))
    sim.apply_push("utorso", [0.0, 90.0, 0.0], 0.1)
    assert record(sim) != straight
    sim.restore(snapshot)
    assert record(sim) == straight


def test_what_cannot_be_restored_changes_nothing(sim, tmp_path):
    snapshot = sim.snapshot()
    sim.advance(0.02)
    other = AtlasSimulation(log=tmp_path / "run.mcap")
    with pytest.raises(ScenarioError, match="one run"):
        other.restore(other.snapshot())
    other.close()
    with pytest.raises(ValueError, match="another simulation"):
        other.restore(snapshot)
    with pytest.raises(TypeError, match="what snapshot"):
        sim.restore(snapshot.context)
    assert (sim.time, other.time) == (0.02, 0.0)


def test_a_view_shows_the_restored_moment_at_once():
    meshcat, planned = Meshcat(), "/atlas_drake/footsteps/0"
    sim = AtlasSimulation(view=meshcat)
    sim.advance(0.01)
    snapshot = sim.snapshot()
    sim.publish(demo_walk())
    sim.advance(0.05)
    assert meshcat.HasPath(planned)
    sim.restore(snapshot)
    assert not meshcat.HasPath(planned)
    sim.advance(0.05)
    assert sim.current_behavior is Behavior.STAND


def demo_walk():
    walk = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    walk.walk_params.use_demo_walk = True
    return walk


@pytest.mark.slow
def test_two_seconds_of_walking_are_repeated_to_the_bit(sim):
    sim.advance(0.5)
    sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND))
    sim.wait_until(lambda sim: sim.current_behavior is Behavior.STAND)
    sim.publish(demo_walk())
    sim.advance(1.7)
    disturb(sim)
    snapshot = sim.snapshot()
    straight = record(sim, 2.0)
    assert sim.current_behavior is Behavior.WALK
    sim.reset("USER", seed=7)
    sim.advance(0.3)
    sim.restore(snapshot)
    assert record(sim, 2.0) == straight
