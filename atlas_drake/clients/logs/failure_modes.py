"""What failed first when a run went wrong, from its records.

A failure is what a good walk does not show: a sole that slides, a motor at its limit
for long. Failures that follow each other within ``CHAIN`` belong together, and the
first of them is the first failure of the run.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from atlas_drake.messages.footstep import LOADED, UNLOADED
from atlas_drake.records import TickRecord
from atlas_drake.records.groups import Balance
from atlas_drake.robot import Robot
from atlas_drake.rotations import rotation_matrix
from atlas_drake.support_polygon import SupportPolygon
from atlas_drake.units import GRAVITY

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
"""Horizontal displacement of a bearing sole that is a slide [m]."""
TIP = 0.3
"""Rotation of a bearing sole since it came to bear that is a tip [rad]."""
MID_SWING = 0.5
"""Share of the swing before which a touch is a stub [-]."""
STUB = 0.05
"""Horizontal distance of a touch from the planned landing that is a stub [m]."""
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
class Failure:
    """One failure."""

    time: float  # When it began [s].
    kind: str  # One of the texts above.
    place: str = ""  # The joint or the foot; empty for the whole body.


class FailureWatch:
    """Finds the first failure of a run, record by record, until the robot falls.

    Attributes:
        first: The first failure of the latest chain; None without one.
    """

    def __init__(self, robot: Robot) -> None:
        """Watches a run of ``robot`` from its start."""
        self.first: Failure | None = None
        self._robot = robot
        self._joints = robot.indices(robot.plant).q
        self._watched = robot.limb(*WATCHED_LIMBS)
        self._feet = tuple(map(_Foot, range(len(SIDES))))
        # Infinity for joints that are not at a limit.
        self._limit_since = np.full(robot.num_joints, np.inf)
        self._full_since = np.full(robot.num_joints, np.inf)
        self._unsolved = 0
        self._latest = -math.inf
        self._fallen = False

    def update(self, record: TickRecord) -> None:
        """Takes the next record of the run."""
        self._fallen |= any(event.kind == "fall" for event in record.events)
        if self._fallen:
            return
        time, weight = round(record.time, 6), self._robot.mass * GRAVITY
        found = [
            *self._feet[0].failures(time, record, weight),
            *self._feet[1].failures(time, record, weight),
            *self._of_joints(time, record),
            *self._of_balance(time, record),
        ]
        if not found:
            return
        if self.first is None or time - self._latest > CHAIN:
            self.first = found[0]
        # A failure may be noticed long after it began.
        self.first = min(self.first, *found, key=lambda failure: failure.time)
        self._latest = time

    def _of_joints(self, time: float, record: TickRecord) -> Iterator[Failure]:
        robot, joints = self._robot, record.joints
        q = record.state.q[self._joints]
        ours = self._watched & (joints.k_effort == 0)
        margin = np.minimum(q - robot.position_lower, robot.position_upper - q)
        effort = np.abs(joints.effort) / robot.effort_limit
        self._limit_since = _since(self._limit_since, ours & (margin <= 0.0), time)
        self._full_since = _since(
            self._full_since, ours & (effort >= FULL_EFFORT), time
        )
        for since, duration, kind in (
            (self._limit_since, LIMIT_TIME, AT_LIMIT),
            (self._full_since, SATURATED_TIME, SATURATED),
        ):
            for joint in np.flatnonzero(time - since >= duration - 1e-9).tolist():
                yield Failure(float(since[joint]), kind, robot.joint_names[joint])

    def _of_balance(self, time: float, record: TickRecord) -> Iterator[Failure]:
        if record.controller.unsolved > self._unsolved:
            yield Failure(time, UNSOLVED)
        self._unsolved = record.controller.unsolved
        if _dcm_outside(record.balance) > OUTSIDE:
            yield Failure(time, DCM_LEFT)


def _since(before: np.ndarray, holds: np.ndarray, time: float) -> np.ndarray:
    """Returns the times since which conditions hold, infinity where they do not."""
    return np.where(holds, np.minimum(before, time), np.inf)


def _dcm_outside(balance: Balance) -> float:
    """Computes how far the DCM is outside the support, beyond the plan's [m]."""
    if balance.support is None or balance.omega is None or len(balance.support) < 3:
        return 0.0
    support = SupportPolygon(balance.support)
    outside = max(support.distance_outside(balance.dcm), 0.0)
    if balance.dcm_reference is None:
        return outside
    return outside - max(support.distance_outside(balance.dcm_reference), 0.0)


@dataclass
class _Foot:
    """What is remembered of a foot from tick to tick."""

    index: int  # 0 for the left foot, 1 for the right foot.
    has_stood: bool = False  # True if it has carried load: at first there is none.
    in_air_since: float | None = None  # [s]; None on the ground.
    stance: tuple[np.ndarray, np.ndarray] | None = None  # Position, normal on bearing.
    touchdown: float | None = None  # Planned time of the next one [s].

    def failures(
        self, time: float, record: TickRecord, weight: float
    ) -> Iterator[Failure]:
        """Yields the failures of this foot in a record, and takes the record over."""
        load = record.feet.loads[self.index] / weight
        p_WF = record.feet.positions[self.index]
        normal = rotation_matrix(record.feet.orientations[self.index])[:, 2]
        planned = record.footsteps[0] if record.footsteps else None
        # A foot that the behavior takes for landed is not that of the next landing.
        if planned is not None and planned.foot != self.index:
            planned = None
        side = SIDES[self.index]
        if self.stance is not None and load > BEARING:
            p_stance, normal_stance = self.stance
            if math.hypot(*(p_WF - p_stance)[:2]) > SLIP:
                yield Failure(time, SLID, side)
            if float(normal @ normal_stance) < math.cos(TIP):
                yield Failure(time, TIPPED, side)
        if self.in_air_since is not None and self.touchdown is not None:
            if load <= LOADED:
                if time - self.touchdown > DELAY:
                    yield Failure(self.touchdown, LATE, side)
            elif planned is not None:
                swing = self.touchdown - self.in_air_since
                early = time - self.in_air_since < MID_SWING * swing
                if early or math.hypot(*(p_WF[:2] - planned.p_WF[:2])) > STUB:
                    yield Failure(time, STUBBED, side)
        remaining = None if planned is None else record.time_to_touchdown
        self._remember(time, load, remaining)
        if load <= BEARING:
            self.stance = None
        elif self.stance is None:
            self.stance = p_WF, normal

    def _remember(self, time: float, load: float, remaining: float | None) -> None:
        """Keeps since when the foot is in the air, and when it should touch down."""
        if load > LOADED:
            self.has_stood, self.in_air_since = True, None
        elif self.in_air_since is None and load < UNLOADED and self.has_stood:
            self.in_air_since = time
        if self.in_air_since is None or remaining is None:
            self.touchdown = None
        elif remaining > 0.0 or self.touchdown is None:
            self.touchdown = time + remaining
