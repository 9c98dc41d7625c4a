"""A push at a moment of the step as a trial; limits are in ``push_moments.yaml``.

All pushes of one seed begin from the same walk: its snapshots are stored when a trial
first comes by, and later trials go on from there, as if they had walked, to the bit.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakKeyDictionary

from atlas_drake import (
    AtlasBehaviorWalkFeedback,
    AtlasSimulation,
    Behavior,
    StepStream,
    steps_ahead,
)
from atlas_drake.config import as_plain
from atlas_drake.simulation.run_log import Snapshot

STRIDE, DURATION = 0.25, 0.63
"""Of each step [m], [s]."""
NUM_STEPS = 11
FIRST_PUSHED = 5
"""The push comes in this step, of the left foot, or in the next one."""
FIRST = "early"
SHARES = {FIRST: 0.1, "mid": 0.5, "late": 0.85}
"""Share of the swing at which a push begins; one in double support is in its middle."""
DOUBLE = "double"
STANDING = 1.0
"""Time in STAND before the first step, and after the last [s]."""
PUSH_DURATION = 0.1
"""[s]"""
LONGEST = 20.0
"""A robot that does not stand by then never will [s]."""
POLL = 0.1
"""Time between looks at the robot after the push [s]."""
KEPT = 8
"""Number of walks kept per simulation; each holds eight snapshots of 2.5 MB."""

Key = tuple[str, str]
"""Moment of the step, and the stance foot."""


@dataclass
class Walk:
    """One walk, as far as any trial has gone.

    Attributes:
        heading: Of the walk [rad].
        stored: The snapshots in order of time, each with the steps sent until then.
        lift_off, swing: Time and duration of the latest swing [s].
    """

    heading: float
    latest: tuple[Snapshot, StepStream]
    stored: dict[Key, tuple[Snapshot, StepStream]] = field(default_factory=dict)
    lift_off: float = 0.0
    swing: float = 0.0


_WALKS: WeakKeyDictionary[AtlasSimulation, dict[str, Walk]] = WeakKeyDictionary()


def pushed_walk(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, bool]:
    """A walk with a push on the chest.

    Args:
        sim: A robot that stands.
        parameters: ``speed``, impulse over the robot's mass [m/s]; ``direction``:
            forward, backward, outward (to the side of the swing foot, away from the
            stance foot) or inward (over the stance foot); ``moment``: early, mid or
            late in the swing, or double for the double support before it; ``stance``,
            the foot that stands then, left or right.

    Returns:
        Whether the robot stands in the end.
    """
    stance = str(parameters["stance"])
    heading, stream = _walked_to(sim, (str(parameters["moment"]), stance))
    angle = heading + _angle(str(parameters["direction"]), stance)
    force = float(parameters["speed"]) * sim.robot.mass / PUSH_DURATION
    force_W = [force * math.cos(angle), force * math.sin(angle), 0.0]
    sim.apply_push("trunk", force_W, PUSH_DURATION)
    while not sim.has_fallen and sim.time < LONGEST:
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance(POLL)
        if stream.is_over(sim.atlas_sim_interface_state):
            break
    if not sim.has_fallen:
        sim.advance(STANDING)
    return {"stands": not sim.has_fallen and sim.current_behavior is Behavior.STAND}


def _angle(direction: str, stance: str) -> float:
    """Direction from the heading, counter-clockwise [rad]."""
    left_swings = 1.0 if stance == "right" else -1.0
    return {
        "forward": 0.0,
        "backward": math.pi,
        "outward": 0.5 * math.pi * left_swings,
        "inward": -0.5 * math.pi * left_swings,
    }[direction]


def _walked_to(sim: AtlasSimulation, key: Key) -> tuple[float, StepStream]:
    """Brings the simulation to a moment of its walk; returns heading and steps."""
    walks = _WALKS.setdefault(sim, {})
    run = repr(as_plain(sim.scenario))
    if run not in walks:
        if len(walks) == KEPT:
            del walks[next(iter(walks))]
        walks[run] = _begun(sim)
    walk = walks[run]
    snapshot, stream = walk.stored.get(key, walk.latest)
    if sim.time != snapshot.time:
        sim.restore(snapshot)
    # A stored stream is copied: it goes on with each trial.
    stream = copy.copy(stream)
    for step in (FIRST_PUSHED, FIRST_PUSHED + 1):
        stance = ("right", "left")[(step - 1) % 2]
        for name in (DOUBLE, *SHARES):
            if key in walk.stored:
                return walk.heading, stream
            if (name, stance) not in walk.stored:
                _advance_to_moment(sim, walk, stream, step, name)
                walk.latest = sim.snapshot(), copy.copy(stream)
                walk.stored[name, stance] = walk.latest
    return walk.heading, stream


def _begun(sim: AtlasSimulation) -> Walk:
    """Stands for a while, and plans the walk."""
    sim.advance(STANDING)
    gait = sim.scenario.controller_config().gait(stride=STRIDE, duration=DURATION)
    distance = STRIDE * (NUM_STEPS - 1)
    steps = steps_ahead(sim.atlas_sim_interface_state, distance, gait)
    turn = steps[0].pose.orientation
    heading = 2.0 * math.atan2(turn.z, turn.w)
    return Walk(heading, (sim.snapshot(), StepStream(steps)))


def _advance_to_moment(
    sim: AtlasSimulation, walk: Walk, stream: StepStream, step: int, name: str
) -> None:
    """Walks on to the next moment, in a step or in the double support before it."""
    if name == DOUBLE:
        _until(sim, stream, lambda: len(sim.footsteps) == step - 1)
        timing = sim.scenario.controller_config().walk.timing
        sim.advance(0.5 * (timing.transfer(DURATION) - PUSH_DURATION))
        return
    if name == FIRST:
        _until(sim, stream, lambda: _feedback(sim).current_step_index == step)
        walk.lift_off, walk.swing = sim.time, _feedback(sim).t_step_rem
    begin = walk.lift_off + SHARES[name] * walk.swing
    _until(sim, stream, lambda: sim.time > begin - 1e-9, begin)


def _until(
    sim: AtlasSimulation,
    stream: StepStream,
    reached: Callable[[], bool],
    latest: float = LONGEST,
) -> None:
    """Walks until a condition holds, looked at in every control tick.

    Raises:
        RuntimeError: If the robot falls before, or it is too late.
    """
    while not reached():
        if sim.has_fallen or sim.time >= LONGEST:
            raise RuntimeError("the walk did not come to the push")
        sim.publish(stream.next_command(sim.atlas_sim_interface_state))
        sim.advance_to(min(sim.time + sim.scenario.control_period, latest))


def _feedback(sim: AtlasSimulation) -> AtlasBehaviorWalkFeedback:
    return sim.atlas_sim_interface_state.walk_feedback
