"""A policy commands its joints beside a behavior and a person."""

import numpy as np
import pytest

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    PolicyUse,
    Scenario,
)
from atlas_drake.clients.policies.joining import policy_of
from atlas_drake.clients.policies.observation import TERMS
from atlas_drake.messages import Imu
from atlas_drake.messages.geometry import Quaternion
from atlas_drake.robot import load_robot
from atlas_drake.simulation.done import scenario_of_what_was_done
from tests.policy_networks import ARM, METADATA, save

PERIOD = 0.02
ROBOT = load_robot("atlas")
MINE = [ROBOT.joint_index(name) for name in ARM]


@pytest.fixture
def simulate(tmp_path):
    """A simulation with a policy; with a watchdog if that is wanted."""

    def make(bias, watchdog=False, start=0.1, **network):
        metadata = {**METADATA, **network.pop("metadata", {})}
        file = save(tmp_path / "p.onnx", bias, metadata=metadata, **network)
        use = PolicyUse(file=str(file), start=start, watchdog=watchdog)
        return AtlasSimulation(Scenario(policy=use))

    return make


def told_of(sim, kind):
    """The events of a kind."""
    return [event for event in sim.events if event.kind == kind]


@pytest.mark.slow
def test_it_moves_its_joints_and_no_others(simulate):
    sim = simulate([-0.4, 0.8])
    sim.advance(1.5)
    q = np.array(sim.atlas_state.position)
    np.testing.assert_allclose(q[MINE], [1.2 - 0.2, -0.6 + 0.2], atol=0.05)
    shares = sim.atlas_state.k_effort
    assert [i for i, share in enumerate(shares) if share] == sorted(MINE)
    assert sim.current_behavior is Behavior.STAND
    assert not sim.has_fallen


@pytest.mark.slow
def test_a_persons_joints_stay_the_persons(simulate):
    sim = simulate([0.0, 0.0])
    elbow = ROBOT.joint_index("l_arm_elx")
    sim.advance(0.3)
    command = AtlasCommand(position=list(sim.atlas_state.position))
    command.k_effort = list(sim.atlas_state.k_effort)
    command.position[elbow] += 0.3
    command.k_effort[elbow] = 255
    sim.publish(command)
    sim.advance(1.0)
    assert sim.atlas_state.position[elbow] == pytest.approx(
        command.position[elbow], abs=0.05
    )
    policy = policy_of(sim)
    assert policy.runs


@pytest.mark.slow
def test_it_gives_its_joints_up_once_somebody_takes_them(simulate):
    sim = simulate([0.0, 0.0])
    sim.advance(0.5)
    policy = policy_of(sim)
    assert policy.runs
    none = [0] * ROBOT.num_joints
    sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND, k_effort=none))
    sim.advance(0.5)
    assert not policy.runs
    told = told_of(sim, "policy")
    assert len(told) == 1
    assert "somebody else" in told[0].text
    assert not np.any(sim.atlas_state.k_effort)
    policy.take()
    sim.advance(0.1)
    assert policy.runs
    assert [sim.atlas_state.k_effort[i] for i in MINE] == [255, 255]


def test_what_is_no_number_is_never_applied(simulate):
    sim = simulate([np.nan, 0.0])
    sim.advance(0.5)
    assert "not a number" in told_of(sim, "policy")[0].text
    assert not np.any(sim.atlas_state.k_effort)


@pytest.mark.slow
def test_a_schedule_commands_beside_it_and_takes_its_joints(simulate, tmp_path):
    file = save(tmp_path / "p.onnx", [-0.4, 0.8], metadata=METADATA)
    stand = {"behavior": "STAND", "k_effort": [0] * ROBOT.num_joints}
    messages = [
        {"time": 0.5, "atlas_sim_interface_command": {"behavior": "MANIPULATE"}},
        {"time": 1.0, "atlas_sim_interface_command": stand},
    ]
    scenario = Scenario(policy=PolicyUse(file=str(file)), messages=messages)
    sim = AtlasSimulation(scenario)
    sim.advance(0.9)
    assert sim.current_behavior is Behavior.MANIPULATE
    assert [sim.atlas_state.k_effort[i] for i in MINE] == [255, 255]
    sim.advance(0.3)
    assert sim.current_behavior is Behavior.STAND
    assert not np.any(sim.atlas_state.k_effort)
    assert 1.0 <= told_of(sim, "policy")[0].time < 1.05


@pytest.mark.slow
def test_a_watchdog_that_is_switched_off_does_nothing(simulate):
    sim = simulate([-10.0, 0.0], watchdog=True)
    policy_of(sim).watch(False)
    sim.advance(0.5)
    assert policy_of(sim).runs
    assert not policy_of(sim).is_watched
    policy_of(sim).watch(True)
    sim.advance(0.1)
    assert not policy_of(sim).runs


def test_its_velocity_can_be_asked_for_in_the_run(simulate):
    sim = simulate([0.0, 0.0])
    policy = policy_of(sim)
    policy.steer((0.3, 0.0, -0.1))
    sim.advance(0.2)
    np.testing.assert_allclose(policy.velocity, [0.3, 0.0, -0.1])
    sim.reset(seed=1)
    np.testing.assert_allclose(policy.velocity, 0.0)


def test_a_simulation_without_a_policy_has_none():
    assert policy_of(AtlasSimulation()) is None


@pytest.mark.slow
def test_an_event_is_told_once_also_after_going_back(simulate):
    sim = simulate([np.nan, 0.0])
    before = sim.snapshot()
    sim.advance(0.5)
    after = sim.snapshot()
    sim.restore(before)
    assert not told_of(sim, "policy")
    sim.restore(after)
    sim.advance(0.1)
    assert len(told_of(sim, "policy")) == 1


def test_a_scenario_of_what_was_done_has_its_messages_and_not_the_policy(simulate):
    sim = simulate([0.0, 0.0])
    sim.advance(0.4)
    done = scenario_of_what_was_done(sim)
    assert done.policy is None
    assert len(done.messages) > 10


@pytest.mark.slow
def test_a_memory_counts_from_the_start_and_a_new_run_repeats_it(simulate):
    sim = simulate([0.0, 0.0], recurrent=True)
    ends = []
    for _ in range(2):
        sim.advance(1.1)
        ends.append(sim.plant.GetPositions(sim.part("plant")[1]).tolist())
        command = np.array(sim.output("commands").joints.position)[MINE]
        # An action every 20 ms from 0.1 s on, a hundredth more each time.
        np.testing.assert_allclose(command, [1.2 + 0.25, -0.6 + 0.125], atol=1e-4)
        sim.reset(seed=0)
    assert ends[0] == ends[1]


def test_a_history_begins_with_copies_and_ends_with_the_latest(simulate):
    # The action is the latest value of the joint minus the oldest one.
    weight = np.zeros((10, 2))
    weight[4, 0], weight[0, 0] = 1.0, -1.0
    history = {"observation_history_lengths": "3,1,1"}
    sim = simulate([0.0, 0.0], seen=10, weight=weight, metadata=history)
    sent, measured = [], []
    sim.advance_to(0.099)
    for _ in range(10):
        measured.append(sim.atlas_state.position[MINE[0]])
        sim.advance(PERIOD)
        sent.append(sim.output("commands").joints.position[MINE[0]])
    moved = [measured[k] - measured[max(k - 2, 0)] for k in range(10)]
    assert abs(moved[9]) > 1e-3
    np.testing.assert_allclose(sent, 1.2 + 0.5 * np.array(moved), atol=2e-3)


def test_a_watchdog_takes_the_joints_of_a_policy_that_wants_too_much(simulate):
    sim = simulate([10.0, 0.0], watchdog=True)
    sim.advance(0.3)
    assert not np.any(sim.atlas_state.k_effort)
    assert sim.current_behavior is Behavior.STAND
    told = told_of(sim, "watchdog")
    assert len(told) == 1
    assert "r_arm_shx" in told[0].text


@pytest.mark.slow
def test_a_watchdog_waits_for_two_periods_and_not_longer(simulate):
    sim = simulate([0.0, 0.0], watchdog=True)
    sim.advance(0.5)
    policy_of(sim).stop()
    sim.advance(2.0 * PERIOD - 0.01)
    assert not told_of(sim, "watchdog")
    sim.advance(0.05)
    assert "ms old" in told_of(sim, "watchdog")[0].text
    assert not np.any(sim.atlas_state.k_effort)


@pytest.mark.parametrize(
    ("q", "down"),
    [
        (Quaternion(), [0.0, 0.0, -1.0]),
        (Quaternion(x=1.0, w=0.0), [0.0, 0.0, 1.0]),
        (Quaternion(y=0.5**0.5, w=0.5**0.5), [1.0, 0.0, 0.0]),
    ],
)
def test_gravity_points_down_in_the_frame_of_the_pelvis(q, down):
    from atlas_drake.clients.policies.observation import Seen

    zero = np.zeros(2)
    seen = Seen(Imu(orientation=q), zero, zero, zero, np.zeros(3), 0.2, 0.8)
    gravity = TERMS["projected_gravity"](seen)
    np.testing.assert_allclose(gravity, down, atol=1e-12)
    np.testing.assert_allclose(TERMS["phase"](seen), [1.0, 0.0], atol=1e-12)
