"""Atlas learns to keep its balance in user mode, where no behavior helps it.

Augmented random search over a linear policy of hips and ankles: what is tried is one
matrix, the same for both legs; what improves the reward under random pushes is kept.
Writes balance.onnx, which `atlas-drake run --policy` runs, and its learning curve.

    python examples/learning/balance.py --minutes 40
    atlas-drake run --policy balance.onnx --set initial_behavior=USER
"""

from __future__ import annotations

import argparse
import functools
import json
import multiprocessing
import os
import time
from pathlib import Path

import numpy as np

from atlas_drake.clients.learning.environment import AtlasEnv
from atlas_drake.clients.learning.export import save_policy
from atlas_drake.clients.learning.tasks import balance

JOINTS, SENSED = 4, 6  # Of a leg; numbers of gyroscope and gravity.
SHAPE = (SENSED + 2 * JOINTS, JOINTS)  # Of what is learned: positions, velocities.
TRIED, KEPT = 10, 5  # Pairs of directions in an iteration; those that count.
NOISE, STEP = 0.1, 0.08  # Size of what is tried, and of a change.
RUNS = 2  # Of each candidate.
HELD_OUT = 1_000_000  # Seeds from here on are for the judgement alone.


def weights(theta: np.ndarray) -> np.ndarray:
    """Expands what is learned to the policy's matrix, the same for both legs."""
    sensed, position, velocity = np.split(theta, [SENSED, SENSED + JOINTS])
    both = [np.tile(0.5 * part, (2, 1)) for part in (position, velocity)]
    return np.tile(np.concatenate([sensed, *both]), (1, 2))


@functools.cache
def environment() -> AtlasEnv:
    """Builds the environment of this process."""
    return balance()


def judge(job: tuple[np.ndarray, list[int]]) -> tuple[float, float]:
    """Returns mean reward, and the share of runs without a fall."""
    theta, seeds = job
    policy, env, rewards, stood = weights(theta), environment(), 0.0, 0
    for seed in seeds:
        observation, _ = env.reset(seed=seed)
        terminated = truncated = False
        while not (terminated or truncated):
            action = observation @ policy
            observation, reward, terminated, truncated, _ = env.step(action)
            rewards += reward
        stood += not terminated
    return rewards / len(seeds), stood / len(seeds)


def improved(
    theta: np.ndarray, pool: multiprocessing.pool.Pool, random: np.random.Generator
) -> np.ndarray:
    """Tries directions, both ways and with the same pushes, and follows the best."""
    seeds = random.integers(HELD_OUT, size=RUNS).tolist()
    directions = random.standard_normal((TRIED, *SHAPE))
    jobs = [(theta + way * NOISE * d, seeds) for d in directions for way in (1, -1)]
    rewards = np.array(pool.map(judge, jobs, chunksize=1))[:, 0].reshape(TRIED, 2)
    best = np.argsort(-rewards.max(axis=1))[:KEPT]
    gains = rewards[best, 0] - rewards[best, 1]
    change = np.tensordot(gains, directions[best], axes=1)
    return theta + STEP / (KEPT * (rewards[best].std() + 1e-9)) * change


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=40.0, help="of learning")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument("--trials", type=int, default=100, help="of the judgement")
    parser.add_argument("--seed", type=int, default=0, help="of what is tried")
    parser.add_argument("--out", type=Path, default=Path("balance.onnx"))
    options = parser.parse_args()
    random, theta = np.random.default_rng(options.seed), np.zeros(SHAPE)
    held_out = [[HELD_OUT + i] for i in range(options.trials)]
    curve: list[dict[str, float]] = []
    begin = time.monotonic()
    with multiprocessing.Pool(options.jobs) as pool:

        def judged(theta: np.ndarray) -> float:
            results = pool.map(judge, [(theta, seeds) for seeds in held_out])
            return float(np.mean(results, axis=0)[1])

        print(f"without the policy {judged(theta):.0%} stand", flush=True)
        iteration = 0
        try:
            while (passed := time.monotonic() - begin) < 60.0 * options.minutes:
                theta, iteration = improved(theta, pool, random), iteration + 1
                results = pool.map(judge, [(theta, [i]) for i in range(8)])
                reward = float(np.mean(results, axis=0)[0])
                curve.append({"minutes": passed / 60.0, "reward": reward})
                print(f"{passed:5.0f} s  {iteration:3}  {reward:.1f}", flush=True)
        except KeyboardInterrupt:
            print("stopped: what was learned until now is kept")
        share = judged(theta)
    description = balance(push=(0.0, 0.0)).description
    save_policy(options.out, [(weights(theta), np.zeros(2 * JOINTS))], description)
    options.out.with_suffix(".json").write_text(json.dumps(curve))
    print(f"with the policy {share:.0%} of {options.trials} stand; {options.out}")


if __name__ == "__main__":
    main()
