"""Runs of one simulation equal those of a new one: seeds, restarts, snapshots."""

import numpy as np
import pytest
from pydrake.geometry import Meshcat

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Block,
    InvalidMessageError,
    PlannedPush,
    Scenario,
    ScenarioError,
    Start,
)
from atlas_drake.scenario import Jitter, with_settings
from atlas_drake.scenario.timed_message import TimedMessage

HELD = Start(on_gantry=True)
MESSAGE = {"behavior": "MANIPULATE"}


def scenario(seed, **fields):
    """A run with everything that runs differ in: noise, jitter, pushes, messages."""
    return Scenario(
        seed=seed,
        noise="rough",
        state="estimated",
        ground_friction=0.8,
        friction_jitter=0.2,
        terrain=[
            Block(size=[2.0, 2.0, 0.2], position=[0.0, 0.0, 0.05]),
            Block(size=[0.5, 0.5, 0.2], position=[3.0, 0.0, 0.05], friction=0.3),
        ],
        jitter=Jitter(position=0.02, orientation=0.02, joints=0.02, mass=0.05),
        pushes=[PlannedPush(time=0.09, impulse=5.0, body="pelvis")],
        **fields,
    )


@pytest.fixture(scope="module")
def shared():
    message = TimedMessage(time=0.12, atlas_sim_interface_command=MESSAGE)
    return AtlasSimulation(scenario(1, messages=[message]))


@pytest.fixture
def sim(shared):
    shared.reset(seed=1)
    return shared


def disturb(sim):
    """The user takes an arm, and a push begins; both are pending at this instant."""
    k_effort = [0] * 28
    k_effort[20] = 200
    sim.publish(AtlasCommand(position=[0.3] * 28, k_effort=k_effort))
    with pytest.raises(InvalidMessageError):
        sim.publish(AtlasSimInterfaceCommand(behavior=99))
    sim.apply_push("utorso", [60.0, 20.0, 0.0], 0.1)


def record(sim, seconds=0.15):
    """All that can be seen of a run: states, messages, events, figures."""
    seen = []
    names = ("state", "behavior_state", "effort", "foot_wrenches")
    for _ in range(5):
        sim.advance(0.2 * seconds)
        seen += [sim.output(name).tobytes() for name in names]
        seen += [sim.imu, sim.atlas_state, sim.atlas_sim_interface_state]
    summary = sim.summary()
    for timing in ("wall_time", "real_time_factor", "controller_tick_ms"):
        del summary[timing]
    active = [push.body for push in sim.output("pushes").active]
    received = sim.output("commands").received
    return seen, list(sim.events), summary, sim.scenario, active, received


def total_mass(sim):
    return sim.plant.CalcTotalMass(sim.plant.GetMyContextFromRoot(sim.context))


@pytest.mark.slow
@pytest.mark.parametrize(
    "fields",
    [
        {"schedule": "tutorial"},
        {
            "start": Start(on_gantry=True, release_time=0.1),
            "initial_behavior": "FREEZE",
        },
    ],
    ids=["estimated", "on_gantry"],
)
def test_a_run_with_another_seed_is_that_of_a_new_simulation(fields):
    sim = AtlasSimulation(scenario(1, **fields))
    first = record(sim)
    if "start" not in fields:
        disturb(sim)
        sim.advance(0.3)
    sim.reset(seed=5)
    assert (sim.time, sim.events, sim.scenario.seed) == (0.0, [], 5)
    again = record(sim)
    assert again == record(AtlasSimulation(scenario(5, **fields)))
    assert again[0] != first[0]
    sim.reset(seed=1)
    assert record(sim) == first


@pytest.mark.slow
def test_a_restart_is_the_run_of_a_new_simulation(sim):
    sim.advance(0.05)
    other = scenario(
        7,
        messages=sim.scenario.messages,
        start=Start(position=[1.0, 2.0], yaw=0.5),
    )
    other = with_settings(other, ["jitter.mass=0.1", "pushes[0].time=0.02"])
    sim.restart(other)
    assert record(sim) == record(AtlasSimulation(other))
    sim.restart(scenario(1, messages=sim.scenario.messages))


def test_a_restart_refuses_what_is_built_in(sim):
    for setting, field in (
        ("control_period=0.018", "control_period"),
        ("controller.gains.dcm_gain=3", "controller.gains.dcm_gain"),
        ("pushes[0].body=tail", "pushes"),
    ):
        with pytest.raises(ScenarioError) as caught:
            sim.restart(with_settings(sim.scenario, [setting]))
        assert caught.value.field.startswith(field)
    sim.advance(0.02)
    assert sim.scenario.pushes[0].body == "pelvis"


def test_friction_and_masses_are_drawn_anew(sim):
    def drawn():
        context = sim.plant.GetMyContextFromRoot(sim.context)
        query = sim.plant.get_geometry_query_input_port().Eval(context)
        inspector = query.inspector()
        friction = {
            inspector.GetName(key): inspector.GetProximityProperties(key)
            .GetProperty("material", "coulomb_friction")
            .static_friction()
            for key in inspector.GetAllGeometryIds()
            if inspector.GetFrameId(key) == inspector.world_frame_id()
            and inspector.GetProximityProperties(key) is not None
        }
        return friction, total_mass(sim)

    before = drawn()
    sim.reset(seed=2)
    after = drawn()
    assert before[1] != after[1]
    assert before[0]["ground"] != after[0]["ground"] == after[0]["terrain_0"]
    assert before[0]["terrain_1"] == after[0]["terrain_1"] == 0.3
    sim.reset(seed=1)
    assert drawn() == before


def test_a_new_run_may_begin_elsewhere(sim):
    sim.reset("USER", Start(position=[0.5, 0.0]), seed=4)
    assert sim.time == 0.0
    assert sim.current_behavior.name == "USER"
    assert sim.pelvis_pose.translation()[0] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("asked", "error", "problem"),
    [
        *[({"seed": s}, ScenarioError, "seed") for s in (-1, 2**64, 1.5, "3", True)],
        ({"seed": 2, "behavior": "WALK"}, InvalidMessageError, "behavior"),
        ({"seed": 2, "behavior": "USER", "pose": HELD}, ScenarioError, "on_gantry"),
        ({"seed": 2, "pose": Start(yaw=float("nan"))}, ScenarioError, "yaw"),
    ],
)
def test_a_run_that_cannot_begin_changes_nothing(sim, asked, error, problem):
    sim.advance(0.02)
    with pytest.raises(error, match=problem):
        sim.reset(**asked)
    assert sim.time == pytest.approx(0.02)
    assert sim.scenario.seed == 1


def test_a_log_holds_one_run(sim, tmp_path):
    foreign = sim.snapshot()
    with AtlasSimulation(log=tmp_path / "run.mcap") as logged:
        logged.advance(0.02)
        for leave in (
            lambda: logged.reset(seed=2),
            lambda: logged.restore(logged.snapshot()),
        ):
            with pytest.raises(ScenarioError, match="one run"):
                leave()
        assert logged.time == pytest.approx(0.02)
    with pytest.raises(ValueError, match="another simulation"):
        logged.restore(foreign)
    with pytest.raises(TypeError, match="snapshot"):
        sim.restore(foreign.context)
    logged.reset(seed=2)
    assert logged.time == 0.0


# At a control tick, at a physics step, and between two steps.
@pytest.mark.slow
@pytest.mark.parametrize("begin", [0.063, 0.066, 0.0701])
def test_a_restored_run_goes_on_to_the_bit(sim, begin):
    sim.advance_to(begin)
    disturb(sim)
    snapshot = sim.snapshot()
    assert snapshot.time == sim.time == begin
    straight = record(sim)
    kinds = [event.kind for event in straight[1]]
    assert (kinds.count("push"), kinds.count("command")) == (2, 1)
    for _ in range(2):
        sim.restore(snapshot)
        assert sim.time == begin
        assert record(sim) == straight


@pytest.mark.slow
def test_a_snapshot_survives_other_runs(sim):
    sim.advance(0.05)
    snapshot, mass = sim.snapshot(), total_mass(sim)
    straight = record(sim)
    sim.restore(snapshot)
    sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.FREEZE))
    sim.apply_push("utorso", [0.0, 90.0, 0.0], 0.1)
    assert record(sim) != straight
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


def demo_walk():
    walk = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    walk.walk_params.use_demo_walk = True
    return walk


def test_a_view_shows_the_restored_moment_at_once():
    meshcat, planned = Meshcat(), "/atlas_drake/shapes"
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
