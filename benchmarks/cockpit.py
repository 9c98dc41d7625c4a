"""Measures what the page of the cockpit costs a run whose one viewer draws elsewhere.

Three simulations walk in turns as fast as they can: without a view, with Meshcat and
the overlays that the page shows at first, and with the page. The viewer is a process
that takes all that a browser gets, and draws nothing.
"""

from __future__ import annotations

import argparse
import asyncio
import multiprocessing
import statistics
import sys
import time

import aiohttp
from pydrake.geometry import Meshcat
from report import command_line, write_figures

from atlas_drake import AtlasSimInterfaceCommand, AtlasSimulation, Behavior
from atlas_drake.clients.cockpit.cockpit import SHOWN, Cockpit
from atlas_drake.clients.view.overlays import Overlays

ROUNDS = 6
BEFORE, WALK = 0.8, 5.0
"""Simulated time until the robot walks, and of the walk that is measured [s]."""
GOAL = 0.95
"""Least share of the speed with the same view and no page [-]."""


def speed(sim: AtlasSimulation, seconds: float) -> float:
    """Walks; returns the simulated seconds per second."""
    sim.reset(seed=0)
    walk = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    walk.walk_params.use_demo_walk = True
    sim.publish(walk)
    sim.advance(BEFORE)
    begin = time.perf_counter()
    sim.advance(seconds)
    return seconds / (time.perf_counter() - begin)


def view(url: str) -> None:
    """Takes what a page gets, until it is killed."""

    async def take(session: aiohttp.ClientSession, path: str) -> None:
        address = f"{url}{path}"
        async with session.ws_connect(
            address, origin=url.rstrip("/"), max_msg_size=0
        ) as socket:
            async for _message in socket:
                pass

    async def go() -> None:
        async with aiohttp.ClientSession() as session:
            await asyncio.gather(*(take(session, one) for one in ("socket", "meshcat")))

    asyncio.run(go())


def main() -> int:
    """The command line; status 1 when the goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--seconds", type=float, default=WALK, help="of each walk")
    options = command_line(parser)
    cockpit = Cockpit()
    sims = {
        "no view": AtlasSimulation(),
        "Meshcat": AtlasSimulation(view=Meshcat(), overlays=Overlays(SHOWN)),
        "the page": AtlasSimulation(view=cockpit.meshcat, overlays=cockpit.overlays),
    }
    cockpit.join(sims["the page"])
    spawned = multiprocessing.get_context("spawn")
    viewer = spawned.Process(target=view, args=(cockpit.web_url(),), daemon=True)
    viewer.start()
    try:
        while not cockpit.GetNumActiveConnections():
            sims["the page"].advance(0.02)
        runs: dict[str, list[float]] = {name: [] for name in sims}
        for _ in range(options.rounds):
            for name, sim in sims.items():
                runs[name].append(speed(sim, options.seconds))
    finally:
        viewer.kill()
        cockpit.close()
    median = {name: statistics.median(found) for name, found in runs.items()}
    for name, found in median.items():
        print(f"{name:10} {found:5.2f} x real time")
    share = median["the page"] / median["Meshcat"]
    met = share >= GOAL
    verdict = "met" if met else "NOT MET"
    print(f"the page beside Meshcat: {share:.3f}; goal >= {GOAL:g}: {verdict}")
    write_figures(options.json, {"median": median, "runs": runs, "share": share})
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
