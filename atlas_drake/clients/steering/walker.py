"""Walking by hand: in a direction, or over a plan that is shown before it is sent.

The reports may be up to 0.1 s old, so that a command does not show in the next one.
"""

from __future__ import annotations

import math

from atlas_drake.clients.steering.reports import Publish
from atlas_drake.clients.steering.step_stream import StepStream
from atlas_drake.errors import InvalidMessageError
from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
    BehaviorStatus,
)
from atlas_drake.messages.checks import check_number
from atlas_drake.planning.footholds import (
    SIDEWAYS_SHARE,
    Foothold,
    Gait,
    foothold,
    step_data,
)
from atlas_drake.planning.footstep_planner import steps_to
from atlas_drake.planning.walk_at import stop_walking, walk_at

RESOLUTION = 0.25
"""Shares of a direction are rounded to this: the tremor of a stick sends no command."""
DEAD_ZONE = 0.2
"""Smaller shares of a direction count as 0."""
PATIENCE = 1.0
"""Time within which a requested walk begins; later it counts as refused [s]."""
GAIT = ("stride", "turn", "duration", "swing_height")
"""The settings of a gait."""
Direction = tuple[float, float, float]
"""Shares of the stride ahead, of the largest side step to the left, and of the turn to
the left, -1 to 1."""


class Walker:
    """Walks in a direction until told otherwise, or over a plan."""

    def __init__(
        self, gait: Gait, publish: Publish, report: AtlasSimInterfaceState
    ) -> None:
        """Begins without a walk."""
        self._gait, self._publish, self._report = gait, publish, report
        self._is_news = True  # Whether a report or a request is still to be answered.
        self._plan: tuple[AtlasBehaviorStepData, ...] = ()
        self._stream: StepStream | None
        self._direction: Direction | None
        self._asked_at: float | None  # Time at which a walk was requested [s].
        self._is_sent: bool  # True once WALK was requested.
        self._has_begun: bool  # True once the robot walked.
        self._is_stopping: bool
        self.forget_walk()

    @property
    def direction(self) -> Direction | None:
        """Direction of the walk; None without one."""
        return self._direction

    @property
    def gait_in_force(self) -> dict[str, float]:
        """The settings of the next steps: stride, turn, duration and swing height."""
        return {name: getattr(self._gait, name) for name in GAIT}

    @property
    def plan_marks(self) -> tuple[tuple[int, float, float, float], ...]:
        """Foot, x, y [m] and yaw [rad] of each step that is planned and not sent."""
        return tuple((step.foot_index, *foothold(step.pose)) for step in self._plan)

    @property
    def walks(self) -> bool:
        """True if the robot walks, or is about to as far as is known."""
        return self._is_sent or self._report.current_behavior == Behavior.WALK

    # ---- by direction --------------------------------------------------------

    def walk(self, forward: float = 0.0, left: float = 0.0, turn: float = 0.0) -> None:
        """Walks in a direction until told otherwise; all zero is a walk on the spot.

        Args:
            forward: Share of the stride, -1 to 1; negative is backward.
            left: Share of the largest side step, -1 to 1.
            turn: Share of the turn per step, -1 to 1; positive is to the left.
        """
        direction = (
            _share(forward, "forward"),
            _share(left, "left"),
            _share(turn, "turn"),
        )
        if not self._is_steered:
            self.forget_walk()
        self._direction, self._is_stopping = direction, False
        if self._report.current_behavior != Behavior.WALK:
            self._has_begun, self._asked_at = False, None
        self._is_news = True

    def stop_walking(self) -> None:
        """Ends the walk with the feet side by side; STAND follows."""
        if self._is_steered:
            self._direction, self._is_stopping = None, True
            self._is_news = True
        elif self.walks:
            self.forget_walk()
            self._publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND))

    def gait(self, **values: float) -> dict[str, float]:
        """Changes the gait of the next steps.

        Args:
            **values: Of stride [m], turn [rad], duration [s], swing_height [m].

        Returns:
            The values in force: the nearest that the robot can walk.
        """
        for name, value in values.items():
            if name not in GAIT:
                raise InvalidMessageError(name, value, f"there are {', '.join(GAIT)}")
            check_number(value, name, 0.0)
        self._gait = self._gait.nearest(**values)
        return self.gait_in_force

    # ---- by plan -------------------------------------------------------------

    def plan_to(self, x: float, y: float, yaw: float | None = None) -> int:
        """Plans steps to a place and shows them; ``send_plan`` sends them.

        Args:
            x: Of the goal in W [m].
            y: Likewise [m].
            yaw: Heading at the goal [rad]; None for the heading of the way.

        Returns:
            The number of steps.
        """
        x, y = check_number(x, "x"), check_number(y, "y")
        if yaw is None:
            left, right = map(foothold, self._report.foot_pos_est)
            yaw = math.atan2(y - 0.5 * (left.y + right.y), x - 0.5 * (left.x + right.x))
        yaw = check_number(yaw, "yaw")
        try:
            self._plan = tuple(steps_to(self._report, x, y, yaw, self._gait))
        except ValueError as error:
            raise InvalidMessageError("x, y", (x, y), str(error)) from error
        return len(self._plan)

    def move_step(self, index: int, x: float, y: float) -> None:
        """Moves a step of the plan that is shown.

        Args:
            index: Number of the step, counted from 1.
            x: New place of the sole in W [m].
            y: Likewise [m].
        """
        place = int(check_number(index, "index", 1, len(self._plan), whole=True)) - 1
        x, y = check_number(x, "x"), check_number(y, "y")
        old = self._plan[place]
        sole = Foothold(x, y, foothold(old.pose).yaw)
        moved = step_data(old.step_index, old.foot_index, sole, self._gait)
        moved.pose.position.z = old.pose.position.z
        self._plan = (*self._plan[:place], moved, *self._plan[place + 1 :])

    def send_plan(self) -> None:
        """Walks over the plan that is shown, once the robot stands."""
        if not self._plan:
            raise InvalidMessageError("plan", 0, "there is no plan to send")
        self.forget_walk()
        self._stream = StepStream(self._plan)
        self._plan = ()
        if self._report.current_behavior != Behavior.STAND:
            self._publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND))
        self._is_news = True

    def drop_plan(self) -> None:
        """Shows no plan any more."""
        self._plan = ()

    # ---- as time goes on -----------------------------------------------------

    def see_report(self, report: AtlasSimInterfaceState) -> None:
        """Takes the latest report."""
        self._report, self._is_news = report, True

    def forget_walk(self) -> None:
        """Forgets the walk, without a command: another behavior was asked for."""
        self._stream, self._direction, self._asked_at = None, None, None
        self._is_sent = self._has_begun = self._is_stopping = False

    def walk_on(self) -> None:
        """Sends the next steps if it is time, once for each report and request."""
        if not self._is_news:
            return
        self._is_news = False
        command = self._next_command() if self._goes_on() else None
        if command is not None:
            self._is_sent |= command.behavior == Behavior.WALK
            self._publish(command)

    @property
    def _is_steered(self) -> bool:
        return self._direction is not None or self._is_stopping

    def _goes_on(self) -> bool:
        """Returns True if there is a walk; forgets one that ended or was refused."""
        if not self._is_steered and self._stream is None:
            return False
        report = self._report
        flags = report.behavior_feedback.status_flags
        has_fallen = flags & BehaviorStatus.ERROR_FALLING
        if report.current_behavior == Behavior.WALK and not has_fallen:
            # A plan waits for the end of a walk that goes on.
            self._has_begun = self._is_sent or self._stream is None
        elif has_fallen or self._has_begun or self._is_refused():
            self.forget_walk()
            return False
        return True

    def _next_command(self) -> AtlasSimInterfaceCommand | None:
        report = self._report
        if self._stream is not None:
            stands = report.current_behavior == Behavior.STAND
            is_due = stands or self._is_sent
            return self._stream.next_command(report) if is_due else None
        if self._direction is not None:
            return walk_at(report, *_velocity(self._direction, self._gait), self._gait)
        if report.current_behavior != Behavior.WALK and not self._is_sent:
            self.forget_walk()  # Nothing was sent that could still begin.
        return stop_walking(report, self._gait)

    def _is_refused(self) -> bool:
        """Returns True if the robot does not obey; it may have to stand up first."""
        report = self._report
        now = report.header.stamp or 0.0
        is_standing_up = (
            report.desired_behavior == Behavior.STAND != report.current_behavior
        )
        if self._asked_at is None or is_standing_up:
            self._asked_at = now
        return now > self._asked_at + PATIENCE


def _share(value: float, name: str) -> float:
    value = check_number(value, name, -1.0, 1.0)
    return 0.0 if abs(value) < DEAD_ZONE else RESOLUTION * round(value / RESOLUTION)


def _velocity(direction: Direction, gait: Gait) -> tuple[float, float, float]:
    """Returns the speeds ahead and to the left [m/s], and the turn [rad/s]."""
    forward, left, turn = direction
    longest = gait.stride if forward > 0.0 else gait.backward_stride
    widest = 0.5 * SIDEWAYS_SHARE * gait.stride
    return (
        forward * longest / gait.duration,
        left * widest / gait.duration,
        turn * gait.turn / gait.duration,
    )
