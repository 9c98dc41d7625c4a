"""What failed first when a run went wrong, from its records.

A failure is what a good walk does not show: a sole that slides, a motor at its limit
for long. Failures that follow each other within ``CHAIN`` belong together, and the
first of them is the first failure of the run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from atlas_drake.control.balance.support_polygon import SupportPolygon
from atlas_drake.control.estimation.attitude import rotation_matrix
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.frozen import Frozen, replace
from atlas_drake.records import TickRecord
from atlas_drake.records.groups import Balance
from atlas_drake.robot import Robot
from atlas_drake.systems.push_source import LOADED, UNLOADED

SLID, TIPPED = "sole slid", "sole tipped"
STUBBED, LATE = "foot stubbed", "touchdown late"
AT_LIMIT, SATURATED = "joint at its limit", "effort saturated"
UNSOLVED, DCM_LEFT = "QP unsolved", "DCM left the feet"
NONE = "none"
"""Where nothing failed."""
SIDES = ("left", "right")

WATCHED_LIMBS = ("l_leg", "r_leg", "back")
"""Limbs whose joints are watched, as far as the behavior alone moves them: an arm that
is flung against a stop does not fell a robot."""
CHAIN = 0.5
"""Time without a failure after which the next one begins a new chain [s]."""
BEARING = 0.2
"""Share of the weight on a sole from which it should rest where it is [-]."""
SLIP = 0.02
"""Horizontal way of a bearing sole that is a slide [m]."""
TIP = 0.3
"""Turn of a bearing sole out of the attitude in which it came to bear [rad]."""
MID_SWING = 0.5
"""Share of the swing before which a touch is a stub [-]."""
STUB = 0.05
"""Horizontal distance of a touch from the landing place that is a stub [m]."""
DELAY = 0.15
"""Time in the air after the planned touchdown that is late [s]."""
LIMIT_TIME = 0.05
"""Time at or beyond a joint's limit that counts [s]."""
SATURATED_TIME = 0.3
"""Time at the effort limit that counts; in each step of a good walk knees of
``atlas_v3`` are there for 0.27 s [s]."""
FULL_EFFORT = 0.999
"""Share of its limit from which an effort is saturated [-]."""
OUTSIDE = 0.05
"""Distance of the DCM outside the support, beyond the plan's, that is a loss [m]."""


@dataclass(frozen=True)
class Failure(Frozen):
    """One failure.

    Attributes:
        time: When it began [s].
        kind: One of the texts above.
        place: The joint or the foot concerned; empty for the whole body.
    """

    time: float
    kind: str
    place: str = ""


@dataclass(frozen=True)
class Landing(Frozen):
    """The landing that the behavior plans for a foot in the air.

    Attributes:
        foot: 0 for the left foot, 1 for the right foot.
        place: Horizontal place of the sole's center in W [m], shape (2,).
        remaining: Planned time until then [s]; 0 when it is late.
    """

    foot: int
    place: np.ndarray
    remaining: float


@dataclass(frozen=True)
class Signals:
    """What is watched, at one control tick.

    Attributes:
        time: Present time [s].
        margin: Distance of each joint from its nearest limit [rad], shape (n,).
        effort: Effort of each motor as a share of its limit [-], shape (n,).
        loads: Shares of the weight on the left and the right sole [-].
        soles: Positions of the soles' centers in W [m], shape (2, 3).
        normals: Upward normals of the soles in W, shape (2, 3).
        landing: The next planned landing; None without one.
        outside: Distance of the DCM outside the planned support, less that of its
            reference [m]; None without a plan.
        unsolved: Number of control ticks without a solution so far.
    """

    time: float
    margin: np.ndarray
    effort: np.ndarray
    loads: Sequence[float]
    soles: np.ndarray
    normals: np.ndarray
    landing: Landing | None
    outside: float | None
    unsolved: int


@dataclass(frozen=True)
class FootState(Frozen):
    """What is remembered of a foot.

    Attributes:
        in_air_since: Time since which the sole carries nothing [s]; None on the ground.
        place, normal: Of the sole when it came to bear, shape (3,); None before that.
        touchdown: Planned time of the next touchdown [s]; None if none is planned.
    """

    in_air_since: float | None = None
    place: np.ndarray | None = None
    normal: np.ndarray | None = None
    touchdown: float | None = None


@dataclass(frozen=True)
class WatchState(Frozen):
    """What is remembered from tick to tick.

    Attributes:
        feet: The left and the right foot.
        limit_since, full_since: Times since which each joint is at its limit, and each
            motor at its own [s]; infinity for those that are not. Shape (n,).
        unsolved: Number of control ticks without a solution so far.
        first: First failure of the latest chain; None without one.
        latest: Time of the latest failure [s].
    """

    feet: tuple[FootState, FootState]
    limit_since: np.ndarray
    full_since: np.ndarray
    unsolved: int = 0
    first: Failure | None = None
    latest: float = -math.inf


class FailureWatch:
    """Finds the first failure of a run, record by record, until the robot falls."""

    def __init__(self, robot: Robot) -> None:
        """Watches a run of ``robot`` from its start."""
        self._robot = robot
        self._joints = robot.indices(robot.plant).q
        self._watched = robot.limb(*WATCHED_LIMBS)
        self._state = initial(robot.num_joints)
        self._fallen = False

    @property
    def first(self) -> Failure | None:
        """The first failure of the latest chain; None without one."""
        return self._state.first

    def update(self, record: TickRecord) -> None:
        """Takes the next record of the run."""
        self._fallen |= any(event.kind == "fall" for event in record.events)
        if not self._fallen:
            signals = self._signals(record)
            self._state = watch(self._state, signals, self._robot.joint_names)

    def _signals(self, record: TickRecord) -> Signals:
        robot, joints = self._robot, record.joints
        q = record.state.q[self._joints]
        ours = self._watched & (joints.k_effort == 0)
        margin = np.minimum(q - robot.position_lower, robot.position_upper - q)
        effort = np.abs(joints.effort) / robot.effort_limit
        weight = robot.mass * GRAVITY
        return Signals(
            time=round(record.time, 6),
            margin=np.where(ours, margin, np.inf),
            effort=np.where(ours, effort, 0.0),
            loads=[load / weight for load in record.feet.loads],
            soles=np.array(record.feet.positions),
            normals=np.array(
                [rotation_matrix(q_WF)[:, 2] for q_WF in record.feet.orientations]
            ),
            landing=_landing(record),
            outside=_outside(record.balance),
            unsolved=record.controller.unsolved,
        )


def _landing(record: TickRecord) -> Landing | None:
    """Returns the next landing that the behavior plans."""
    if not record.footsteps:
        return None
    first = record.footsteps[0]
    return Landing(first.foot, first.p_WF[:2], record.time_to_touchdown)


def _outside(balance: Balance) -> float | None:
    """Computes how far the DCM is outside the support, beyond the plan's [m]."""
    if balance.support is None or balance.omega is None or len(balance.support) < 3:
        return None
    support = SupportPolygon(balance.support)
    outside = max(support.distance_outside(balance.dcm), 0.0)
    if balance.dcm_reference is None:
        return outside
    return outside - max(support.distance_outside(balance.dcm_reference), 0.0)


def initial(num_joints: int) -> WatchState:
    """Returns the state at the start of a run."""
    never = np.full(num_joints, np.inf)
    return WatchState((FootState(), FootState()), never, never)


def watch(state: WatchState, now: Signals, names: Sequence[str]) -> WatchState:
    """Returns the state after one more tick.

    Args:
        state: The state before.
        now: Signals of the tick.
        names: Names of the joints.
    """
    found: list[Failure] = []
    feet = []
    for foot, side in enumerate(SIDES):
        found += _of_foot(state.feet[foot], now, foot, side)
        feet.append(_foot_after(state.feet[foot], now, foot))
    limit_since = _since(state.limit_since, now.margin <= 0.0, now.time)
    full_since = _since(state.full_since, now.effort >= FULL_EFFORT, now.time)
    for since, least, kind in (
        (limit_since, LIMIT_TIME, AT_LIMIT),
        (full_since, SATURATED_TIME, SATURATED),
    ):
        for joint in np.flatnonzero(now.time - since >= least - 1e-9).tolist():
            found.append(Failure(float(since[joint]), kind, names[joint]))
    if now.unsolved > state.unsolved:
        found.append(Failure(now.time, UNSOLVED))
    if now.outside is not None and now.outside > OUTSIDE:
        found.append(Failure(now.time, DCM_LEFT))
    first, latest = state.first, state.latest
    if found:
        if first is None or now.time - latest > CHAIN:
            first = found[0]
        # A failure may be noticed long after it began.
        first = min(first, *found, key=lambda failure: failure.time)
        latest = now.time
    return replace(
        state,
        feet=(feet[0], feet[1]),
        limit_since=limit_since,
        full_since=full_since,
        unsolved=now.unsolved,
        first=first,
        latest=latest,
    )


def _since(before: np.ndarray, holds: np.ndarray, time: float) -> np.ndarray:
    """Returns the times since which conditions hold, infinity where they do not."""
    return np.where(holds, np.minimum(before, time), np.inf)


def _of_foot(foot: FootState, now: Signals, index: int, side: str) -> Iterator[Failure]:
    """Yields the failures of one foot."""
    load, landing = now.loads[index], now.landing
    if foot.place is not None and foot.normal is not None and load > BEARING:
        way = now.soles[index] - foot.place
        if math.hypot(way[0], way[1]) > SLIP:
            yield Failure(now.time, SLID, side)
        if float(now.normals[index] @ foot.normal) < math.cos(TIP):
            yield Failure(now.time, TIPPED, side)
    if foot.in_air_since is None or foot.touchdown is None:
        return
    if load <= LOADED:
        if now.time - foot.touchdown > DELAY:
            yield Failure(foot.touchdown, LATE, side)
        return
    # A foot that the behavior takes for landed is not that of the next landing.
    if landing is not None and landing.foot == index:
        away = now.soles[index][:2] - landing.place
        swing = foot.touchdown - foot.in_air_since
        early = now.time - foot.in_air_since < MID_SWING * swing
        if early or math.hypot(*away) > STUB:
            yield Failure(now.time, STUBBED, side)


def _foot_after(foot: FootState, now: Signals, index: int) -> FootState:
    """Returns the state of a foot after a tick."""
    load, landing = now.loads[index], now.landing
    since, touchdown = foot.in_air_since, None
    if load > LOADED:
        since = None
    elif since is None and load < UNLOADED:
        since = now.time
    if since is not None and landing is not None and landing.foot == index:
        touchdown = now.time + landing.remaining
        if landing.remaining <= 0.0 and foot.touchdown is not None:
            touchdown = foot.touchdown
    if load <= BEARING:
        return FootState(since, None, None, touchdown)
    if foot.place is None:
        return FootState(since, now.soles[index], now.normals[index], touchdown)
    return FootState(since, foot.place, foot.normal, touchdown)
