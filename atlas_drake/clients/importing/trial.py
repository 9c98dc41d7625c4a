"""What an imported robot does: it stands, walks and is pushed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from atlas_drake.clients import session
from atlas_drake.clients.importing.files import write_controller
from atlas_drake.clients.importing.gentler import find_gentler, what_bounds
from atlas_drake.clients.importing.motions import (
    LONGEST,
    SETTLES,
    advance,
    stands,
    walk,
)
from atlas_drake.errors import WaitTimeoutError
from atlas_drake.planning.walk_at import fastest
from atlas_drake.robot import ATLAS, TRUNK
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation

STANDS = 5.0
"""Time of standing in the first trial [s]."""
PUSHES, PUSH_DURATION = (0.2, 0.3, 0.4, 0.5), 0.1
"""Changes of speed by pushes, of a robot of Atlas' height [m/s]; duration of a push
[s]."""
LONGEST_PUSHES = 30.0
"""Wall time after which no further push is tried [s]."""
DIRECTIONS = {
    "forward": (1.0, 0.0),
    "backward": (-1.0, 0.0),
    "left": (0.0, 1.0),
    "right": (0.0, -1.0),
}
NEAR_LIMIT = 0.9
"""Share of its effort limit from which a joint is near it [-]."""


@dataclass
class Trial:
    """What happened.

    Attributes:
        stands: Whether it stood on its feet.
        walks: Whether it took all steps, to their places, and stood again.
        landing: Largest distance of a landed foot from its place [m].
        near_limit: Peak share of its effort limit, by joint, while standing and
            walking.
        stride: Usual stride [m].
        duration: Usual duration of a step [s].
        speeds: Largest velocities that ``walk_at`` accepts, in words.
        pushes: Largest change of speed that it bears, by direction [m/s].
        events: Texts of warnings and falls.
        moments: Times in the log of standing and of a swing [s].
        bound: What bounds a robot that does not walk with its usual gait, in words.
        gentler: Steps with which such a robot walks, in words; empty if with none.
        failed: Gentler steps with which it does not walk, in words.
    """

    stands: bool = False
    walks: bool = False
    landing: float = math.nan
    near_limit: dict[str, float] = field(default_factory=dict)
    stride: float = math.nan
    duration: float = math.nan
    speeds: str = ""
    pushes: dict[str, float] = field(default_factory=dict)
    events: list[str] = field(default_factory=list)
    moments: list[float] = field(default_factory=list)
    bound: str = ""
    gentler: str = ""
    failed: list[str] = field(default_factory=list)

    @property
    def steps(self) -> str:
        """The steps of the robot's gait, in words."""
        return f"steps of {self.stride:.3f} m in {self.duration:.2f} s"


def try_robot(model: Path, log: Path, say: Callable[[str], object]) -> Trial:
    """Simulates a robot, with a log of the first trial.

    If the robot stands and does not walk, gentler gaits are tried. The first with which
    it walks is written into its file, and everything is tried with it.

    Args:
        model: The robot's YAML file.
        log: File of the log.
        say: Takes a line on what is tried.
    """
    trial = _first_trial(model, log, say, STANDS)
    if trial.stands and not trial.walks:
        usual = trial.steps
        bound = what_bounds(model, say)
        gentler, values, failed = find_gentler(model, say)
        if gentler:
            why = f"Its trial failed with {usual}, and went well with {gentler} steps."
            write_controller(model, values, why)
            trial = _first_trial(model, log, say, SETTLES)
        trial.bound = f"for {usual}, {bound}"
        trial.gentler, trial.failed = gentler, failed
    if trial.stands:
        _try_pushes(model, trial, say)
    return trial


def _first_trial(
    model: Path, log: Path, say: Callable[[str], object], standing: float
) -> Trial:
    """Lets a robot stand for some time [s], and walk, with a log."""
    trial = Trial()
    with session.AtlasSimulation(Scenario(model=str(model)), log=log) as sim:
        gait = sim.scenario.controller_config().gait()
        trial.stride, trial.duration = gait.stride, gait.duration
        trial.speeds = str(fastest(gait))
        say("standing")
        advance(sim, standing)
        trial.stands = stands(sim)
        trial.moments = [sim.time]
        if trial.stands:
            say("walking")
            begins = sim.time
            trial.walks = walk(sim)
            errors = [step["error_m"] for step in sim.footsteps]
            trial.landing = max(errors, default=math.nan)
            trial.moments.append(begins + 1.0 + 2.5 * gait.duration)
            shares = sim.output("peaks")[: sim.robot.num_joints]
            trial.near_limit = {
                name: float(share)
                for name, share in zip(sim.robot.joint_names, shares, strict=True)
                if share > NEAR_LIMIT
            }
        trial.moments = [min(moment, sim.time) for moment in trial.moments]
        trial.events = [
            f"{event.time:.2f} s: {event.text}"
            for event in sim.events
            if event.kind in ("warning", "fall", "falling")
        ]
    return trial


def _try_pushes(model: Path, trial: Trial, say: Callable[[str], object]) -> None:
    deadline = time.monotonic() + LONGEST_PUSHES
    with session.AtlasSimulation(Scenario(model=str(model))) as sim:
        advance(sim, SETTLES)
        standing = sim.snapshot()
        # The pushes then have the Froude number of Atlas'.
        scale = math.sqrt(sim.robot.com_height / ATLAS.height)
        for name, direction in DIRECTIONS.items():
            for speed in PUSHES:
                if time.monotonic() > deadline:
                    return
                say(f"a push of {speed * scale:.2f} m/s {name}")
                sim.restore(standing)
                if not _bears(sim, speed * scale, direction):
                    trial.pushes.setdefault(name, 0.0)
                    break
                trial.pushes[name] = round(speed * scale, 3)


def _bears(sim: AtlasSimulation, speed: float, direction: tuple[float, float]) -> bool:
    force = np.append(direction, 0.0) * speed * sim.robot.mass / PUSH_DURATION
    sim.apply_push(TRUNK, force, PUSH_DURATION)
    advance(sim, SETTLES)
    with suppress(WaitTimeoutError):
        sim.wait_until(lambda sim: stands(sim) or sim.has_fallen, LONGEST - SETTLES)
    return stands(sim)
