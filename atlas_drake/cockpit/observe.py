"""Reads what the page shows from records, and from the operator of a run."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from atlas_drake.cockpit.joint_controls import GAINS
from atlas_drake.cockpit.operator import Operator
from atlas_drake.cockpit.pelvis_controls import COORDINATES
from atlas_drake.cockpit.state import Point, RunState, events_after
from atlas_drake.cockpit.walk_controls import GAIT, marks_of
from atlas_drake.control.estimation.attitude import rotation_matrix
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorWalkFeedback,
    BehaviorStatus,
)
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.records import TickRecord
from atlas_drake.rotations import yaw_of

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

LATELY = 2.0
"""Wall time over which the real-time factor is taken [s]."""
TICKS = 50
"""Number of control ticks whose median is shown."""


class Observer:
    """Reads states of one simulation."""

    def __init__(self, sim: AtlasSimulation, operator: Operator) -> None:
        """Reads a simulation, and what its operator intends."""
        self._sim, self._operator = sim, operator
        self._clock: deque[tuple[float, float]] = deque()
        self._run = 0
        self._last_time = 0.0

    def read(self, events_seen: int) -> RunState:
        """Reads the present state, with the events after the first ``events_seen``."""
        sim, operator = self._sim, self._operator
        if sim.time < self._last_time or len(sim.events) < events_seen:
            self._run += 1
            events_seen = 0
            self._clock.clear()
        self._last_time = sim.time
        new = events_after(sim.events, events_seen)
        return replace(
            state_of(sim.record, sim.behaviors),
            time=sim.time,
            rate=self._rate(),
            pace=sim.realtime_rate,
            paused=operator.clock.paused,
            tick_ms=_median_ms(sim.tick_seconds),
            fallen=sim.has_fallen,
            refusals=operator.modes.refusals(),
            poses=operator.joints.poses,
            direction=operator.walk.direction,
            gait={name: getattr(operator.walk.gait, name) for name in GAIT},
            plan=marks_of(operator.walk.plan),
            overlays=operator.view.shown,
            events=new,
            event_count=events_seen + len(new),
            run=self._run,
            samples=operator.plots.take(),
            recording=operator.recording.is_on,
        )

    def _rate(self) -> float:
        """Returns the simulated seconds per second, lately."""
        now = time.perf_counter()
        self._clock.append((now, self._sim.time))
        while now - self._clock[0][0] > LATELY:
            self._clock.popleft()
        passed = now - self._clock[0][0]
        return (self._sim.time - self._clock[0][1]) / passed if passed > 0.0 else 0.0


def state_of(record: TickRecord, catalog: BehaviorCatalog) -> RunState:
    """Reads from a record what the page shows; nobody commands, time stands still."""
    joints, balance, feet = record.joints, record.balance, record.feet
    flags = BehaviorStatus(record.behavior.status_flags)
    clamped = record.manipulate.clamped
    poses = zip(feet.positions, feet.orientations, strict=True)
    tick_time = record.controller.tick_time
    x, y, z = map(float, record.pelvis.position)
    return RunState(
        time=record.time,
        rate=0.0,
        pace=1.0,
        paused=True,
        tick_ms=1e3 * (tick_time or 0.0),
        behavior=catalog.find(record.behavior.current).name,
        desired=catalog.find(record.behavior.desired).name,
        fallen=bool(flags & BehaviorStatus.ERROR_FALLING),
        refusals={},
        k_effort=tuple(joints.k_effort.astype(int).tolist()),
        position=tuple(joints.position.tolist()),
        set_point=tuple(joints.position_setpoint.tolist()),
        effort=tuple(joints.effort.tolist()),
        gains={name: tuple(getattr(record.gains, name).tolist()) for name in GAINS},
        poses=(),
        direction=None,
        gait={},
        pelvis={name: getattr(clamped, name) for name in COORDINATES},
        robot=(x, y, z, _heading(record.pelvis.orientation)),
        ground=min(float(p_WF[2]) for p_WF in feet.positions),
        com=place_of(balance.com),
        dcm=place_of(balance.dcm),
        cop=None if balance.cop is None else place_of(balance.cop),
        support=()
        if balance.support is None
        else tuple(map(place_of, balance.support)),
        feet=tuple(
            (float(p_WF[0]), float(p_WF[1]), _heading(q_WF)) for p_WF, q_WF in poses
        ),
        loads=feet.loads,
        steps=_coming_steps(record.walk),
        plan=(),
        overlays=frozenset(),
    )


def _heading(wxyz: np.ndarray) -> float:
    """Returns the heading of a pose with this quaternion [rad]."""
    return float(yaw_of(rotation_matrix(wxyz / np.linalg.norm(wxyz))))


def _coming_steps(
    walk: AtlasBehaviorWalkFeedback,
) -> tuple[tuple[int, float, float, float], ...]:
    """Returns the steps of a walk to come: foot, x, y [m] and yaw [rad] of each."""
    if not walk.is_active:
        return ()
    first = max(walk.current_step_index, 1)
    return marks_of(
        [
            step
            for step in walk.step_queue_saturated
            if step.step_index != NO_STEP and step.step_index >= first
        ]
    )


def place_of(place: Sequence[float] | np.ndarray) -> Point:
    """Returns x and y [m], rounded for the page."""
    return round(float(place[0]), 4), round(float(place[1]), 4)


def _median_ms(ticks: Sequence[float]) -> float:
    return 1e3 * float(np.median(ticks[-TICKS:])) if len(ticks) else 0.0
