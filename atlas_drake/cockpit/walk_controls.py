"""Walking: by direction, key by key, or over a plan that is shown before it is sent."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from atlas_drake.control.feet.footstep import clip
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
from atlas_drake.planning.step_stream import StepStream
from atlas_drake.planning.walk_at import stop_walking, walk_at

if TYPE_CHECKING:
    from atlas_drake.simulation import AtlasSimulation

RESOLUTION = 0.25
"""Shares of a direction are rounded to this: the tremor of a stick sends no command."""
DEAD_ZONE = 0.2
"""Smaller shares of a direction count as 0."""
PATIENCE = 1.0
"""Time within which a requested walk begins; later it counts as refused [s]."""


class Direction(NamedTuple):
    """Direction of the walk: shares of the stride and of the turn per step, -1 to 1.

    Attributes:
        forward: Negative is backward.
        left: Negative is to the right.
        turn: Positive is to the left.
    """

    forward: float = 0.0
    left: float = 0.0
    turn: float = 0.0

    def velocity(self, gait: Gait) -> tuple[float, float, float]:
        """Returns the speeds ahead and to the left [m/s], and the turn [rad/s].

        Args:
            gait: Gait of which these are shares.
        """
        longest = gait.stride if self.forward > 0.0 else gait.backward_stride
        widest = 0.5 * SIDEWAYS_SHARE * gait.stride
        full = (longest, widest, gait.turn)
        forward, left, turn = (
            part * most / gait.duration for part, most in zip(self, full, strict=True)
        )
        return forward, left, turn


class WalkControls:
    """Walks in a direction until told otherwise, or over a plan."""

    def __init__(self, sim: AtlasSimulation) -> None:
        """Takes the usual gait of the simulation's robot."""
        self._sim = sim
        self._gait = sim.scenario.controller_config().gait()
        self._direction: Direction | None = None
        self._asked_at: float | None = None  # Time at which a walk was requested [s].
        self._has_begun = self._is_stopping = False
        self._plan: tuple[AtlasBehaviorStepData, ...] = ()
        self._stream: StepStream | None = None

    @property
    def gait(self) -> Gait:
        """Gait of the next steps."""
        return self._gait

    @property
    def direction(self) -> Direction | None:
        """Direction of the walk; None without one."""
        return self._direction

    @property
    def plan(self) -> tuple[AtlasBehaviorStepData, ...]:
        """Steps that are shown and not sent."""
        return self._plan

    @property
    def ground(self) -> float:
        """Height of the lower sole [m]."""
        feet = self._sim.atlas_sim_interface_state.foot_pos_est
        return min(foot.position.z for foot in feet)

    # ---- by direction --------------------------------------------------------

    def steer(self, forward: float = 0.0, left: float = 0.0, turn: float = 0.0) -> None:
        """Walks in a direction; all zero is a walk on the spot.

        Args:
            forward: Share of the stride, -1 to 1; negative is backward.
            left: Share of the largest side step, -1 to 1.
            turn: Share of the turn per step, -1 to 1; positive is to the left.
        """
        shares = [
            _share(check_number(value, name, -1.0, 1.0))
            for name, value in (("forward", forward), ("left", left), ("turn", turn))
        ]
        self._stream = None
        self._direction, self._is_stopping = Direction(*shares), False
        if self._sim.current_behavior != Behavior.WALK:
            self._has_begun, self._asked_at = False, None

    def stop(self) -> None:
        """Ends the walk with the feet side by side; STAND follows."""
        is_steered = self._direction is not None or self._is_stopping
        if not is_steered and self._sim.current_behavior == Behavior.WALK:
            self._sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND))
        self._stream, self._direction, self._is_stopping = None, None, is_steered

    def let_go(self) -> None:
        """Forgets the walk, without a command: another behavior was asked for."""
        self._stream, self._direction, self._asked_at = None, None, None
        self._has_begun = self._is_stopping = False

    def set_gait(self, **values: float) -> dict[str, float]:
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
        return {name: getattr(self._gait, name) for name in GAIT}

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
        report = self._sim.atlas_sim_interface_state
        if yaw is None:
            left, right = map(foothold, report.foot_pos_est)
            yaw = math.atan2(y - 0.5 * (left.y + right.y), x - 0.5 * (left.x + right.x))
        try:
            steps = steps_to(report, x, y, check_number(yaw, "yaw"), self._gait)
        except ValueError as error:
            raise InvalidMessageError("x, y", (x, y), str(error)) from error
        self._plan = tuple(steps)
        return len(steps)

    def move_step(self, index: int, x: float, y: float) -> None:
        """Moves a step of the plan that is shown.

        Args:
            index: Number of the step, counted from 1.
            x: New place of the sole in W [m].
            y: Likewise [m].
        """
        place = int(check_number(index, "index", 1, len(self._plan), whole=True)) - 1
        old = self._plan[place]
        sole = Foothold(
            check_number(x, "x"), check_number(y, "y"), foothold(old.pose).yaw
        )
        moved = step_data(old.step_index, old.foot_index, sole, self._gait)
        moved.pose.position.z = old.pose.position.z
        self._plan = (*self._plan[:place], moved, *self._plan[place + 1 :])

    def send_plan(self) -> None:
        """Walks over the plan that is shown, from STAND or from any walk's end."""
        if not self._plan:
            raise InvalidMessageError("plan", 0, "there is no plan to send")
        self.let_go()
        self._stream = StepStream(self._plan)
        self._plan = ()
        if self._sim.current_behavior != Behavior.STAND:
            self._sim.publish(AtlasSimInterfaceCommand(behavior=Behavior.STAND))

    def drop_plan(self) -> None:
        """Shows no plan any more."""
        self._plan = ()

    # ---- as time goes on -----------------------------------------------------

    def update(self) -> None:
        """Sends the next steps, if it is time."""
        if self._stream is None and self._direction is None and not self._is_stopping:
            return
        report = self._sim.atlas_sim_interface_state
        if report.behavior_feedback.status_flags & BehaviorStatus.ERROR_FALLING:
            self.let_go()
        if self._stream is not None:
            self._follow_plan(self._stream)
            return
        command = self._next_command(report)
        if command is not None:
            self._sim.publish(command)

    def _next_command(
        self, report: AtlasSimInterfaceState
    ) -> AtlasSimInterfaceCommand | None:
        """Returns the command of the walk by direction to send now, if any."""
        current = report.current_behavior
        if self._is_stopping and current == Behavior.WALK:
            return stop_walking(report, self._gait)
        if current == Behavior.WALK:
            self._has_begun = True
        elif self._is_stopping or self._has_begun or self._is_refused(report):
            # A walk that ended or was refused begins only on another request.
            self.let_go()
        if self._direction is None:
            return None
        return walk_at(report, *self._direction.velocity(self._gait), self._gait)

    def _is_refused(self, report: AtlasSimInterfaceState) -> bool:
        """Returns True if the robot does not obey; it may have to stand up first."""
        now = report.header.stamp or 0.0
        is_standing_up = (
            report.desired_behavior == Behavior.STAND != report.current_behavior
        )
        if self._asked_at is None or is_standing_up:
            self._asked_at = now
        return now > self._asked_at + PATIENCE

    def _follow_plan(self, stream: StepStream) -> None:
        report = self._sim.atlas_sim_interface_state
        if stream.is_over(report):
            self._stream = None
            return
        if report.current_behavior not in (Behavior.STAND, Behavior.WALK):
            return
        command = stream.next_command(report)
        if command is not None:
            self._sim.publish(command)


GAIT = ("stride", "turn", "duration", "swing_height")
"""The settings of a gait."""


def _share(value: float) -> float:
    if abs(value) < DEAD_ZONE:
        return 0.0
    return clip(RESOLUTION * round(value / RESOLUTION), -1.0, 1.0)


def marks_of(
    steps: Sequence[AtlasBehaviorStepData],
) -> tuple[tuple[int, float, float, float], ...]:
    """Returns foot, x, y [m] and yaw [rad] of each step."""
    return tuple((s.foot_index, *foothold(s.pose)) for s in steps)
