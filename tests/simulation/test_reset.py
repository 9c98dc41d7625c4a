"""Falls, resets and the gantry: the beginning of a run, and its continuation."""

import numpy as np
import pytest

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    BehaviorStatus,
    InvalidMessageError,
    Scenario,
    ScenarioError,
    Start,
    read_log,
)


@pytest.fixture(scope="module")
def shared():
    return AtlasSimulation()


@pytest.fixture
def sim(shared):
    shared.reset(seed=0)
    return shared


def asking(behavior, **fields):
    return AtlasSimInterfaceCommand(behavior=behavior, **fields)


def flags(sim):
    return sim.atlas_sim_interface_state.behavior_feedback.status_flags


def touching(sim, but):
    """Bodies that touch the world, but for those given."""
    results = sim.output("contact_results")
    world = sim.plant.world_body().name()
    names = set()
    for k in range(results.num_point_pair_contacts()):
        info = results.point_pair_contact_info(k)
        pair = {
            sim.plant.get_body(index).name()
            for index in (info.bodyA_index(), info.bodyB_index())
        }
        # A shin may well touch the other foot.
        if world in pair:
            names |= pair
    return names - set(but) - {world}


@pytest.mark.slow
def test_a_fall_turns_on_damping_mode_and_a_reset_stands_the_robot_up():
    sim = AtlasSimulation()
    feet = [foot.body for foot in sim.robot.file.feet]
    sim.publish(AtlasCommand(position=[0.4] * 28, kp_position=[7.0] * 28))
    sim.advance(0.2)
    sim.apply_push("utorso", [800.0, 200.0, 0.0], 0.4)
    while not sim.has_fallen:
        assert sim.time < 3.0
        assert not touching(sim, feet)
        sim.advance(0.02)
    # It lies on the ground some time later, and the simulation goes on.
    sim.advance(4.0)
    assert touching(sim, feet)
    assert flags(sim) & BehaviorStatus.ERROR_FALLING
    assert sim.summary()["fell"]
    assert not sim.summary()["success"]
    assert [event.kind for event in sim.events].count("fall") == 1
    assert np.isfinite(sim.output("state")).all()
    effort = np.abs(np.array(sim.atlas_state.effort)) / sim.robot.effort_limit
    assert effort.max() < 0.05
    assert np.abs(sim.atlas_state.velocity).max() < 0.5
    before = sim.time
    sim.reset()
    assert sim.time == before
    assert not sim.has_fallen
    assert sim.current_behavior is Behavior.STAND
    # Nothing that was in force is, and the old message is not taken for a new one.
    sim.advance(2.0)
    np.testing.assert_array_equal(sim.atlas_state.kp_position, sim.robot.default_kp)
    assert sim.pelvis_pose.translation()[2] > 0.8
    assert np.abs(sim.atlas_state.velocity).max() < 0.05
    assert not flags(sim) & BehaviorStatus.ERROR_FALLING
    assert not sim.has_fallen
    # The summary forgets nothing.
    assert sim.summary()["fell"]
    assert [event.kind for event in sim.events].count("reset") == 1
    # And it takes commands as before.
    sim.publish(asking("FREEZE"))
    sim.advance(0.1)
    assert sim.current_behavior is Behavior.FREEZE


@pytest.mark.parametrize("behavior", ["STAND", "freeze", Behavior.USER])
def test_a_reset_puts_the_robot_where_it_is_asked_to(sim, behavior):
    sim.advance(0.02)
    sim.reset(behavior, Start(position=[2.0, -1.0], yaw=0.5))
    X_WP = sim.pelvis_pose
    np.testing.assert_allclose(X_WP.translation()[:2], [2.0, -1.0])
    assert np.arctan2(*X_WP.rotation().matrix()[1::-1, 0]) == pytest.approx(0.5)
    sim.advance(0.1)
    assert (
        sim.current_behavior
        is Behavior[str(getattr(behavior, "name", behavior)).upper()]
    )
    share = 255 if behavior is Behavior.USER else 0
    assert set(sim.atlas_state.k_effort) == {share}


def test_a_reset_that_cannot_be_done_changes_nothing(sim):
    sim.advance(0.02)
    before = sim.output("state")
    with pytest.raises(InvalidMessageError, match="behavior: is 'WALK'; must be"):
        sim.reset("WALK")
    with pytest.raises(ScenarioError, match=r"pose.position: is \[1.0\]"):
        sim.reset(pose=Start(position=[1.0]))
    with pytest.raises(ScenarioError, match=r"start\.on_gantry"):
        sim.reset("USER", Start(on_gantry=True))
    with pytest.raises(ScenarioError, match="there is no gantry to release"):
        sim.release()
    np.testing.assert_array_equal(sim.output("state"), before)


@pytest.mark.slow
def test_a_robot_on_the_gantry_hangs_until_it_is_released_and_then_stands():
    sim = AtlasSimulation(
        Scenario(initial_behavior="USER", start=Start(on_gantry=True))
    )
    begin = sim.pelvis_pose.translation()
    sim.advance(2.0)
    np.testing.assert_allclose(sim.pelvis_pose.translation(), begin, atol=0.01)
    assert not touching(sim, ())
    assert not sim.has_fallen
    sim.release()
    sim.advance(2.5)
    # The gantry is off, and the feet carry the robot.
    loads = sim.atlas_state.l_foot.force.z + sim.atlas_state.r_foot.force.z
    assert loads == pytest.approx(sim.robot.mass * 9.81, rel=0.1)
    sim.publish(asking("STAND", k_effort=[0] * 28))
    sim.advance(2.0)
    assert sim.current_behavior is Behavior.STAND
    assert not sim.has_fallen
    assert sim.pelvis_pose.translation()[2] > 0.8


def test_the_gantry_releases_at_its_time_after_each_start_in_it():
    start = Start(on_gantry=True, release_time=0.05)
    sim = AtlasSimulation(Scenario(initial_behavior="FREEZE", start=start))
    sim.advance(0.1)
    sim.reset()
    sim.advance(0.1)
    sim.reset("STAND", Start())
    sim.advance(0.1)
    events = [event for event in sim.events if event.kind == "gantry"]
    assert [event.time for event in events] == pytest.approx([0.05, 0.15])


def test_a_gantry_needs_a_behavior_that_hangs():
    with pytest.raises(ScenarioError, match="initial_behavior"):
        AtlasSimulation(Scenario(start=Start(on_gantry=True)))


@pytest.mark.slow
def test_a_reset_takes_the_footsteps_away_in_records_and_in_the_log(tmp_path):
    path = tmp_path / "run.mcap"
    with AtlasSimulation(log=path) as sim:
        walk = asking("WALK")
        walk.walk_params.use_demo_walk = True
        sim.publish(walk)
        sim.wait_until(lambda sim: sim.record.landed, timeout=3.0)
        sim.reset()
        sim.advance(0.1)
        last = sim.record
        assert last.landed == ()
        assert len(sim.footsteps) == 1  # Of the whole run.
    log = read_log(path)
    (reset,) = (one.row for one in log.logged if one.event.kind == "reset")
    assert log.record(reset - 1).landed
    assert log.record(reset).landed == ()
    assert log.record(len(log) - 1) == last
