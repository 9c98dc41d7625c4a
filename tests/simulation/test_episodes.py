"""Further runs of one simulation with other seeds equal those of new simulations."""

import numpy as np
import pytest

from atlas_drake import (
    AtlasSimulation,
    Block,
    InvalidMessageError,
    Scenario,
    ScenarioError,
    Start,
)
from atlas_drake.messages import AtlasSimInterfaceCommand
from atlas_drake.scenario import Jitter

HELD = Start(on_gantry=True)


def jittered(seed, **fields):
    return Scenario(
        seed=seed,
        noise="rough",
        ground_friction=0.8,
        friction_jitter=0.2,
        terrain=[
            Block(size=[2.0, 2.0, 0.2], position=[0.0, 0.0, 0.05]),
            Block(size=[0.5, 0.5, 0.2], position=[3.0, 0.0, 0.05], friction=0.3),
        ],
        jitter=Jitter(position=0.02, orientation=0.02, joints=0.02, mass=0.05),
        **fields,
    )


@pytest.fixture(scope="module")
def shared():
    return AtlasSimulation(jittered(1))


@pytest.fixture
def sim(shared):
    shared.reset(seed=1)
    return shared


def disturb(sim):
    """A run with everything that a run remembers."""
    walk = AtlasSimInterfaceCommand(behavior=AtlasSimInterfaceCommand.MANIPULATE)
    sim.publish(walk)
    with pytest.raises(InvalidMessageError):
        sim.publish(AtlasSimInterfaceCommand(behavior=99))
    sim.apply_push("utorso", [80.0, 20.0, 0.0], 0.2)
    sim.advance(0.3)


def record(sim):
    """All that can be seen of 0.2 s: states, messages, events, figures."""
    seen = []
    for _ in range(5):
        sim.advance(0.04)
        seen.append(
            [
                *(sim.output(name) for name in ("state", "behavior_state", "effort")),
                sim.output("foot_wrenches"),
                np.array(sim.atlas_state.position),
                sim.imu.linear_acceleration.to_array(),
            ]
        )
    summary = sim.summary()
    timing = ("wall_time", "real_time_factor", "controller_tick_ms")
    plain = {key: value for key, value in summary.items() if key not in timing}
    assert len(sim.tick_seconds) == 23
    return seen, plain, sim.output("commands").received


def same(one, other):
    for ours, theirs in zip(one[0], other[0], strict=True):
        for mine, yours in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(mine, yours)
    assert one[1:] == other[1:]


@pytest.mark.slow
@pytest.mark.parametrize(
    "fields",
    [
        {"state": "estimated", "schedule": "tutorial"},
        {
            "start": Start(on_gantry=True, release_time=0.1),
            "initial_behavior": "FREEZE",
        },
    ],
    ids=["estimated", "gantry"],
)
def test_a_run_with_another_seed_is_that_of_a_new_simulation(fields):
    sim = AtlasSimulation(jittered(1, **fields))
    first = record(sim)
    if "start" not in fields:
        disturb(sim)
    sim.reset(seed=5)
    assert sim.time == 0.0
    assert sim.events == []
    assert sim.scenario.seed == 5
    fresh = AtlasSimulation(jittered(5, **fields))
    again = record(sim)
    same(again, record(fresh))
    assert not np.array_equal(again[0][-1][0], first[0][-1][0])
    sim.reset(seed=1)
    same(record(sim), first)


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
        return friction, sim.plant.CalcTotalMass(context)

    before = drawn()
    sim.reset(seed=2)
    after = drawn()
    assert before[1] != after[1]
    for name in ("ground", "terrain_0"):
        assert before[0][name] != after[0][name]
        assert after[0][name] == sim._run.variation.ground_friction
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
        ({"seed": 2, "behavior": "USER", "pose": HELD}, ScenarioError, "gantry"),
        ({"seed": 2, "pose": Start(yaw=float("nan"))}, ScenarioError, "yaw"),
    ],
)
def test_a_run_that_cannot_begin_changes_nothing(sim, asked, error, problem):
    sim.advance(0.02)
    with pytest.raises(error, match=problem):
        sim.reset(**asked)
    assert sim.time == pytest.approx(0.02)
    assert sim.scenario.seed == 1


def test_a_log_holds_one_run(tmp_path):
    with AtlasSimulation(jittered(1), log=tmp_path / "run.mcap") as sim:
        sim.advance(0.02)
        with pytest.raises(ScenarioError, match="one run"):
            sim.reset(seed=2)
        assert sim.time == pytest.approx(0.02)
    sim.reset(seed=2)
    assert sim.time == 0.0
