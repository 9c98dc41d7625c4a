"""Measures what a learned policy and an environment of Gymnasium cost.

The tick of a policy is its observation, its network and its command. The environments
are those of ``atlas_drake.clients.learning.tasks``, each on one core.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from report import command_line, write_figures

from atlas_drake.clients.learning.environment import AtlasEnv
from atlas_drake.clients.learning.export import save_policy
from atlas_drake.clients.learning.tasks import balance, walk
from atlas_drake.clients.policies.policy_joints import PolicyJoints, observation_of
from atlas_drake.clients.policies.reading import read_policy

TICK_GOAL, RATE_GOAL = 0.3, 3.0
"""Longest tick of a policy [ms]; least real-time factor of an environment."""
WALL_TIME = 10.0
"""For each environment [s]."""
TICKS = 2000


def rate(env: AtlasEnv, wall_time: float) -> tuple[float, float]:
    """Returns steps per second, and simulated time per wall time."""
    action = np.zeros(env.action_space.shape)
    action[0] = 0.3
    env.reset(seed=0)
    steps, simulated, begin = 0, 0.0, time.perf_counter()
    while (passed := time.perf_counter() - begin) < wall_time:
        *_, terminated, truncated, facts = env.step(action)
        steps += 1
        if terminated or truncated:
            simulated += facts["time"]
            env.reset()
    simulated += env.sim.time
    return steps / passed, simulated / passed


def tick_ms() -> float:
    """Returns the median time of a tick of a policy with two hidden layers [ms]."""
    env = balance(push=(0.0, 0.0))
    env.reset(seed=0)
    random = np.random.default_rng(0)
    sizes = [*env.observation_space.shape, 64, 64, *env.action_space.shape]
    layers = [
        (0.01 * random.standard_normal(two), np.zeros(two[1]))
        for two in itertools.pairwise(sizes)
    ]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "policy.onnx"
        save_policy(file, layers, env.description)
        policy = read_policy(file)
    joints = PolicyJoints(policy.description, env.sim.robot, policy.terms)
    state, imu = env.sim.atlas_state, env.sim.imu
    in_force = env.sim.output("commands").joints
    action, memory, seen = np.zeros(sizes[-1]), policy.network.start(), ()
    times = []
    for number in range(TICKS):
        begin = time.perf_counter()
        seen = joints.see(state, imu, action, np.zeros(3), number, seen)
        action, memory = policy.network.act(observation_of(seen), memory)
        joints.command(action, in_force)
        times.append(1e3 * (time.perf_counter() - begin))
    return statistics.median(times)


def main() -> int:
    """The command line; status 1 when a goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--wall-time", type=float, default=WALL_TIME, help="[s]")
    options = command_line(parser)
    tick = tick_ms()
    met = tick <= TICK_GOAL
    print(f"tick of a policy {tick:.2f} ms (goal <= {TICK_GOAL}: {_verdict(met)})")
    figures: dict[str, Any] = {"tick_ms": tick}
    for name, env in (("balance", balance()), ("walk", walk())):
        steps, ratio = rate(env, options.wall_time)
        figures[name] = {"steps_per_second": steps, "real_time_factor": ratio}
        enough = ratio >= RATE_GOAL
        met &= enough
        print(
            f"{name}: {steps:.0f} steps a second, {ratio:.1f} x real time "
            f"(goal >= {RATE_GOAL}: {_verdict(enough)})"
        )
    write_figures(options.json, figures)
    return 0 if met else 1


def _verdict(met: bool) -> str:
    return "met" if met else "NOT MET"


if __name__ == "__main__":
    sys.exit(main())
