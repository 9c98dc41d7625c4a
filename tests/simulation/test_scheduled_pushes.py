"""Pushes of a scenario: when they begin, where to, and what refuses them."""

import pytest

from atlas_drake import AtlasSimulation, PlannedPush, Scenario, ScenarioError
from atlas_drake.scenario import load_scenario
from atlas_drake.systems.push_source import DOWN_FOR, LIFTED_FOR, FootLoad, PushState


def pushes(sim):
    return [e for e in sim.events if e.kind == "push"]


def test_a_push_comes_at_its_time_along_the_robots_heading(tmp_path):
    path = tmp_path / "pushed.yaml"
    path.write_text(
        "physics_step: 2e-3\ncontrol_period: 4e-3\nstart: {yaw: 1.5707963267948966}\n"
        "pushes:\n"
        "  - {time: 0.05, impulse: 8.0, direction: 1.5707963267948966}\n"
        "  - {time: 0.03, impulse: 3.0, body: pelvis, frame: world, duration: 0.03}\n"
    )
    sim = AtlasSimulation(load_scenario(path))
    sim.advance(0.1)
    first, second = pushes(sim)
    assert (first.time, second.time) == (0.03, 0.05)
    assert first.text == "push of [100.0, 0.0, 0.0] N on pelvis for 0.03 s"
    assert second.text.startswith("push of [-80.0, ")
    sim.reset(seed=1)
    sim.advance(0.1)
    assert [e.time for e in pushes(sim)] == [0.03, 0.05]


def test_a_push_comes_although_the_length_of_the_plants_quaternion_drifted():
    sim = AtlasSimulation(Scenario(pushes=[PlannedPush(time=0.02, impulse=1.0)]))
    context = sim.plant.GetMyMutableContextFromRoot(sim.context)
    q = sim.plant.GetPositions(context)
    q[:4] *= 1.0005
    sim.plant.SetPositions(context, q)
    sim.advance(0.05)
    assert pushes(sim)[0].text.startswith("push of [10.0, 0.0, 0.0] N")


def test_the_gait_is_detected_from_loads():
    foot = FootLoad()

    def look(time, load):
        nonlocal foot
        foot, phase = foot.after(time, load)
        return phase

    assert look(0.0, 0.5) is None
    # A jolt is no lift-off.
    assert look(0.1, 0.0) is None
    assert look(0.1 + 0.5 * LIFTED_FOR, 0.5) is None
    assert look(0.2, 0.0) is None
    assert look(0.2 + LIFTED_FOR, 0.0) == "lift_off"
    # Between the thresholds nothing happens, above them it does.
    assert look(0.5, 0.03) is None
    assert look(0.6, 0.1) == "touchdown"
    # A bounce is no second lift-off.
    assert look(0.61, 0.0) is None
    assert look(0.6 + 0.9 * DOWN_FOR, 0.0) is None
    assert look(0.7, 0.6) is None
    assert look(0.75, 0.0) is None
    assert look(0.75 + LIFTED_FOR, 0.0) == "lift_off"


def test_a_push_waits_for_its_foot_and_the_share_of_the_step():
    plan = PlannedPush(phase="touchdown", foot="right", fraction=0.5, delay=0.1)
    state = PushState(awaited=((plan, 1),))

    def step(state, begin, loads):
        for time, load in ((0.0, (0.5, 0.5)), (0.01, loads), (0.1, loads)):
            state = state.watched(begin + time, load, 0.6)
        return state.watched(begin + 0.4, (0.5, 0.5), 0.6)

    state = step(state, 0.0, (0, 1))
    assert (state.planned, state.awaited) == ((), ((plan, 1),))
    state = step(state, 1.0, (1, 0))
    assert state.planned == ((pytest.approx(1.4 + 0.1 + 0.3), plan),)
    assert state.awaited == ()


@pytest.mark.parametrize(
    ("push", "field"),
    [
        ({"impulse": -1.0, "time": 0.0}, "pushes[0].impulse"),
        ({"impulse": 1.0}, "pushes[0].time"),
        ({"time": 1.0, "phase": "lift_off"}, "pushes[0].time"),
        ({"phase": "landing"}, "pushes[0].phase"),
        ({"time": 1.0, "body": "tail"}, "pushes[0].body"),
    ],
)
def test_an_invalid_push_is_named(push, field):
    with pytest.raises(ScenarioError) as caught:
        AtlasSimulation(Scenario(pushes=[PlannedPush(**push)]))
    assert caught.value.field == field
