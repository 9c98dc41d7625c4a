"""What an imported robot does: it stands, walks, takes longer strides and pushes."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from atlas_drake.behaviors.scaling import ATLAS
from atlas_drake.messages import Behavior
from atlas_drake.planning.footstep_planner import steps_ahead
from atlas_drake.planning.step_stream import StepStream
from atlas_drake.robot import TRUNK
from atlas_drake.scenario import Scenario
from atlas_drake.simulation import AtlasSimulation

STANDS, STEPS = 5.0, 6
"""Time of standing [s], and number of steps, of the first trial."""
SETTLES = 1.5
"""Time in which a robot stands before a trial, and after a push [s]."""
PUSHES, PUSH_DURATION = (0.2, 0.3, 0.4, 0.5), 0.1
"""Speeds by which pushes change that of a robot of Atlas' height [m/s]; their duration
[s]."""
STRIDES = (1.5, 2.0)
"""Strides that are tried, in usual ones [-]."""
DIRECTIONS = {
    "forward": (1.0, 0.0),
    "backward": (-1.0, 0.0),
    "left": (0.0, 1.0),
    "right": (0.0, -1.0),
}
LONGEST = 12.0
"""A robot that does not stand again by then never will [s]."""
NEAR_LIMIT = 0.9
"""Share of its effort limit from which a joint is near it [-]."""
PIECE = 0.05


@dataclass
class Trial:
    """What happened.

    Attributes:
        stands: Whether it stood on its feet.
        walks: Whether it took all steps and stood again.
        landing: Largest distance of a landed foot from its place [m].
        pushed: Whether it bore the first push.
        near_limit: Peak share of its effort limit, by joint, while standing and
            walking.
        stride: Usual stride [m].
        duration: Usual duration of a step [s].
        strides: Strides that it walks [m].
        pushes: Largest change of speed that it bears, by direction [m/s].
        events: Texts of warnings and falls.
        moments: Times in the log of standing and of a swing [s].
        real_time: Simulated time per wall time of the first trial [-].
    """

    stands: bool = False
    walks: bool = False
    landing: float = math.nan
    pushed: bool = False
    near_limit: dict[str, float] = field(default_factory=dict)
    stride: float = math.nan
    duration: float = math.nan
    strides: list[float] = field(default_factory=list)
    pushes: dict[str, float] = field(default_factory=dict)
    events: list[str] = field(default_factory=list)
    moments: list[float] = field(default_factory=list)
    real_time: float = math.nan


def try_robot(
    model: Path, log: Path, deadline: float, say: Callable[[str], object]
) -> Trial:
    """Simulates a robot, with a log of the first trial.

    Args:
        model: The robot's YAML file.
        log: File of the log.
        deadline: ``time.monotonic`` after which nothing further is tried.
        say: Takes a line on what is tried.
    """
    trial, began = Trial(), time.perf_counter()
    with AtlasSimulation(Scenario(model=str(model)), log=log) as sim:
        gait = sim.scenario.controller_config().gait()
        trial.stride, trial.duration = gait.stride, gait.duration
        say("standing")
        _advance(sim, STANDS)
        trial.stands = _stands(sim)
        trial.moments = [sim.time]
        if trial.stands:
            say("walking")
            begins = sim.time
            trial.walks = _walk(sim, gait.stride, STEPS)
            errors = [step["error_m"] for step in sim.footsteps]
            trial.landing = max(errors, default=math.nan)
            trial.moments.append(begins + 1.0 + 2.5 * gait.duration)
            shares = sim.output("peaks")[: sim.robot.num_joints]
            trial.near_limit = {
                name: float(share)
                for name, share in zip(sim.robot.joint_names, shares, strict=True)
                if share > NEAR_LIMIT
            }
        if trial.walks:
            say("a push")
            trial.pushed = _bears(sim, PUSHES[0] * _scale(sim), DIRECTIONS["forward"])
        trial.real_time = sim.time / (time.perf_counter() - began)
        trial.moments = [min(moment, sim.time) for moment in trial.moments]
        trial.events = [
            f"{event.time:.2f} s: {event.text}"
            for event in sim.events
            if event.kind in ("warning", "fall", "falling")
        ]
    if trial.walks:
        _try_strides(model, trial, deadline, say)
    if trial.stands:
        _try_pushes(model, trial, deadline, say)
    return trial


def _try_strides(
    model: Path, trial: Trial, deadline: float, say: Callable[[str], object]
) -> None:
    trial.strides = [trial.stride]
    for share in STRIDES:
        if time.monotonic() > deadline:
            return
        with AtlasSimulation(Scenario(model=str(model))) as sim:
            longest = sim.scenario.controller_config().gait().longest_stride
            stride = min(share * trial.stride, longest)
            say(f"strides of {stride:.2f} m")
            _advance(sim, SETTLES)
            if not _walk(sim, stride, STEPS):
                return
        trial.strides.append(stride)
        if stride == longest:
            return


def _try_pushes(
    model: Path, trial: Trial, deadline: float, say: Callable[[str], object]
) -> None:
    with AtlasSimulation(Scenario(model=str(model))) as sim:
        _advance(sim, SETTLES)
        standing, scale = sim.snapshot(), _scale(sim)
        open_ = dict(DIRECTIONS)
        for speed in PUSHES:
            for name, direction in list(open_.items()):
                if time.monotonic() > deadline:
                    return
                say(f"a push of {speed * scale:.2f} m/s {name}")
                sim.restore(standing)
                if _bears(sim, speed * scale, direction):
                    trial.pushes[name] = round(speed * scale, 3)
                else:
                    trial.pushes.setdefault(name, 0.0)
                    del open_[name]


def _scale(sim: AtlasSimulation) -> float:
    """Returns the root of the robot's height over Atlas': pushes as Froude has them."""
    return math.sqrt(sim.robot.com_height / ATLAS.height)


def _bears(sim: AtlasSimulation, speed: float, direction: tuple[float, float]) -> bool:
    force = np.append(direction, 0.0) * speed * sim.robot.mass / PUSH_DURATION
    sim.apply_push(TRUNK, force, PUSH_DURATION)
    end = sim.time + LONGEST
    _advance(sim, SETTLES)
    while not _stands(sim) and not sim.has_fallen and sim.time < end:
        sim.advance(PIECE)
    return _stands(sim)


def _walk(sim: AtlasSimulation, stride: float, steps: int) -> bool:
    """Walks; returns True if the robot stands again after all steps."""
    gait = sim.scenario.controller_config().gait(stride=stride)
    report = sim.atlas_sim_interface_state
    landed = len(sim.footsteps)
    stream = StepStream(steps_ahead(report, stride * (steps - 1), gait))
    end = sim.time + LONGEST
    while not (sim.has_fallen or stream.is_over(sim.atlas_sim_interface_state)):
        if sim.time > end:
            return False
        command = stream.next_command(sim.atlas_sim_interface_state)
        if command is not None:
            sim.publish(command)
        sim.advance(PIECE)
    return _stands(sim) and len(sim.footsteps) - landed >= steps


def _stands(sim: AtlasSimulation) -> bool:
    return sim.current_behavior is Behavior.STAND and not sim.has_fallen


def _advance(sim: AtlasSimulation, seconds: float) -> None:
    end = sim.time + seconds
    while sim.time < end - 1e-9 and not sim.has_fallen:
        sim.advance(min(PIECE, end - sim.time))
