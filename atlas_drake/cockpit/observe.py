"""Reads the state of a run for the page, from the simulation's public ports."""

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
from atlas_drake.control.balance.feedback import dcm, pendulum_frequency
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.control.wrenches import center_of_pressure
from atlas_drake.messages import NO_STEP, AtlasSimInterfaceState, Behavior
from atlas_drake.planning.footholds import foothold
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
        self._model = WholeBodyModel(sim.robot)
        self._scratch = self._model.create_context()
        self._clock: deque[tuple[float, float]] = deque()
        self._run = 0
        self._last_time = 0.0

    def read(self, events_seen: int) -> RunState:
        """Reads the present state, with the events after the first ``events_seen``."""
        sim, operator = self._sim, self._operator
        report, status = sim.atlas_sim_interface_state, sim.output("controller_status")
        joints, state = sim.output("commands").joints, sim.output("state")
        terms = self._model.evaluate(self._scratch, state)
        feet = [foothold(pose) for pose in report.foot_pos_est]
        ground = min(foot.p_WF[2] for foot in terms.feet)
        wrenches = sim.output("foot_wrenches")
        cop = center_of_pressure([foot.p_WF for foot in terms.feet], wrenches)
        omega = pendulum_frequency(float(terms.com[2] - ground))
        if sim.time < self._last_time or len(sim.events) < events_seen:
            self._run += 1
            events_seen = 0
            self._clock.clear()
        self._last_time = sim.time
        new = events_after(sim.events, events_seen)
        support = status.plan.support
        direction = operator.walk.direction
        clamped = report.manipulate_feedback.clamped
        x, y, z = map(float, terms.p_WP)
        return RunState(
            time=sim.time,
            rate=self._rate(),
            pace=sim.realtime_rate,
            paused=operator.clock.paused,
            tick_ms=_median_ms(sim.tick_seconds),
            behavior=Behavior(report.current_behavior).name,
            desired=Behavior(report.desired_behavior).name,
            fallen=sim.has_fallen,
            refusals=operator.modes.refusals(),
            k_effort=tuple(joints.k_effort.astype(int).tolist()),
            position=tuple(terms.q.tolist()),
            set_point=tuple(joints.position.tolist()),
            effort=tuple(sim.output("effort").tolist()),
            gains={name: tuple(getattr(joints, name).tolist()) for name in GAINS},
            poses=operator.joints.poses,
            direction=direction,
            gait={name: getattr(operator.walk.gait, name) for name in GAIT},
            pelvis={name: getattr(clamped, name) for name in COORDINATES},
            robot=(x, y, z, float(yaw_of(terms.R_WP))),
            ground=float(ground),
            com=place_of(terms.com),
            dcm=place_of(dcm(terms, omega)),
            cop=None if cop is None else place_of(cop),
            support=() if support is None else tuple(map(place_of, support)),
            feet=tuple((foot.x, foot.y, foot.yaw) for foot in feet),
            loads=(float(wrenches[5]), float(wrenches[11])),
            steps=coming_steps(report),
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


def coming_steps(
    report: AtlasSimInterfaceState,
) -> tuple[tuple[int, float, float, float], ...]:
    """Returns the steps of a walk to come: foot, x, y [m] and yaw [rad] of each."""
    walk = report.walk_feedback
    if not walk.is_active:
        return ()
    return marks_of(
        [
            step
            for step in walk.step_queue_saturated
            if step.step_index != NO_STEP
            and step.step_index >= max(walk.current_step_index, 1)
        ]
    )


def place_of(place: Sequence[float] | np.ndarray) -> Point:
    """Returns x and y [m], rounded for the page."""
    return round(float(place[0]), 4), round(float(place[1]), 4)


def _median_ms(ticks: Sequence[float]) -> float:
    return 1e3 * float(np.median(ticks[-TICKS:])) if len(ticks) else 0.0
