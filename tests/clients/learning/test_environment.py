"""Environments of Gymnasium, and what is learned there as a policy."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from atlas_drake import AtlasSimulation, Behavior, PolicyUse, Scenario

gymnasium = pytest.importorskip("gymnasium", reason="the extra gym is not installed")

from gymnasium.utils.env_checker import check_env  # noqa: E402

from atlas_drake.clients.learning.actions import (  # noqa: E402
    Footsteps,
    JointTargets,
    WalkVelocity,
)
from atlas_drake.clients.learning.environment import AtlasEnv  # noqa: E402
from atlas_drake.clients.learning.export import save_policy  # noqa: E402
from atlas_drake.clients.learning.tasks import BALANCE, balance  # noqa: E402
from atlas_drake.clients.policies.reading import read_policy  # noqa: E402
from atlas_drake.errors import ScenarioError  # noqa: E402

ARM = ("r_arm_shx", "r_arm_elx")
TERMS = [
    {"name": "joint_pos", "scale": [2.0]},
    {"name": "joint_vel", "scale": [0.1], "history": 2},
    "actions",
]


def make(action=None, observation=TERMS, **changes):
    """An environment of the standing Atlas that rewards nothing."""
    action = action or JointTargets(ARM)
    usual = {"observation": observation, "reward": lambda _record: 0.0}
    return AtlasEnv(action=action, **usual | changes)


def test_gymnasiums_own_checks_pass():
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*infinity")
        check_env(balance(duration=0.5), skip_render_check=True)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_bits_and_another_one_others():
    env = balance(duration=1.0)
    ends = []
    for seed in (4, 5, 4):
        env.reset(seed=seed)
        for _ in range(20):
            observation, *_ = env.step(np.full(8, 0.1))
        ends.append(observation)
    np.testing.assert_array_equal(ends[0], ends[2])
    assert (ends[0] != ends[1]).any()


@pytest.mark.slow
def test_a_fall_terminates_and_the_end_of_time_truncates():
    env = balance(push=(2.0, 2.1), duration=3.0)
    env.reset(seed=1)
    while True:
        *_, terminated, truncated, facts = env.step(np.zeros(8))
        if terminated or truncated:
            break
    assert (terminated, truncated) == (True, False)
    assert facts["time"] < 3.0
    env = make(duration=0.1)
    env.reset(seed=1)
    ends = [env.step(np.zeros(2))[2:4] for _ in range(5)]
    assert ends == [(False, False)] * 4 + [(False, True)]


def test_a_share_of_the_joints_stays_the_behaviors():
    env = make(JointTargets(ARM, k_effort=100))
    env.reset(seed=0)
    env.step(np.zeros(2))
    shares = np.array(env.sim.atlas_state.k_effort)
    assert sorted(set(shares.tolist())) == [0, 100]
    assert (shares > 0).sum() == 2


@pytest.mark.slow
def test_a_velocity_walks():
    env = make(WalkVelocity(), ["projected_gravity"], period=0.1)
    env.reset(seed=0)
    for _ in range(20):
        env.step(np.array([0.5, 0.0, 0.0]))
    assert env.sim.current_behavior is Behavior.WALK


@pytest.mark.slow
def test_an_action_of_footsteps_lasts_for_a_step():
    env = make(Footsteps(), ["projected_gravity"])
    env.reset(seed=0)
    times = [env.step(np.array([0.5, 0.0, 0.0]))[4]["time"] for _ in range(4)]
    gaps = np.diff(times)
    assert (gaps[1:] > 0.3).all()  # Before is the first transfer of weight.
    assert (gaps[1:] < 1.0).all()
    assert env.sim.footsteps


def test_a_term_that_nobody_knows_is_named():
    with pytest.raises(ScenarioError, match="there is no term 'mood'"):
        make(observation=["mood"])


@pytest.mark.slow
def test_what_is_learned_runs_as_a_policy_with_the_same_numbers(tmp_path):
    env = make(observation=TERMS[:2])
    random = np.random.default_rng(1)
    weights = 0.1 * random.standard_normal((6, 2)), np.array([0.3, -0.2])
    file = tmp_path / "arm.onnx"
    save_policy(file, [weights], env.description)
    observation, _ = env.reset(seed=0)
    policy = read_policy(file)
    unscaled = observation / np.array([2.0, 2.0, 0.1, 0.1, 0.1, 0.1])
    action, _ = policy.network.act(unscaled, policy.network.start())
    np.testing.assert_allclose(action, observation @ weights[0] + weights[1], atol=1e-5)
    sim = AtlasSimulation(Scenario(policy=PolicyUse(file=str(file))))
    sim.advance(0.5)
    assert sim.atlas_state.k_effort[sim.robot.joint_index(ARM[0])] == 255


def test_layers_that_do_not_fit_are_refused(tmp_path):
    wrong = (np.zeros((6, 3)), np.zeros(3))
    with pytest.raises(ScenarioError, match="do not fit"):
        save_policy(tmp_path / "x.onnx", [wrong], make().description)


@pytest.mark.slow
def test_the_example_learns_and_its_policy_runs(tmp_path, run_program):
    out = tmp_path / "balance.onnx"
    program = Path(__file__).parents[3] / "examples" / "learning" / "balance.py"
    brief = ["--minutes", "0.01", "--jobs", "1", "--trials", "1", "--out", str(out)]
    status, told = run_program(program, *brief)
    assert status == 0
    assert "with the policy" in told
    user = PolicyUse(file=str(out), start=0.0)
    sim = AtlasSimulation(Scenario(initial_behavior="USER", policy=user))
    sim.advance(1.0)
    assert not sim.has_fallen


@pytest.mark.slow
def test_several_run_in_processes_of_their_own():
    envs = gymnasium.make_vec(
        f"atlas_drake.clients.learning.tasks:{BALANCE}",
        num_envs=2,
        vectorization_mode="async",
        duration=0.4,
    )
    try:
        first, _ = envs.reset(seed=3)
        after, rewards, *_ = envs.step(np.zeros((2, 8), np.float32))
        assert first.shape == after.shape == (2, 22)
        assert (rewards > 0.0).all()
        again, _ = envs.reset(seed=3)
        np.testing.assert_array_equal(first, again)
    finally:
        envs.close()
