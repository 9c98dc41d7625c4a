"""Walking at a velocity: the command that a report and a velocity ask for.

Pure functions, the same for scripts, schedules, keys and a gamepad. The steps follow
from the report alone: from where the feet land to where the next steps lead.
"""

from __future__ import annotations

import functools
import math
import warnings
from dataclasses import replace
from typing import NamedTuple

from atlas_drake.control.feet.footstep import clip, longest_duration
from atlas_drake.messages import (
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
)
from atlas_drake.messages.checks import check_number
from atlas_drake.messages.footstep import LEFT, RIGHT
from atlas_drake.planning.footholds import (
    Foothold,
    Gait,
    foothold,
    middle_beside,
    step_data,
    step_from,
    way_to,
)
from atlas_drake.rotations import wrap_angle

SAME, SAME_YAW = 1e-3, 1e-3
"""Steps that differ by at most this are not sent again [m], [rad]."""
_SAME_SPEED = 1e-3
"""Velocities that differ by less are the same [m/s], [rad/s]."""
_ANY = 100.0
"""Beyond what any robot walks [m/s], [rad/s]."""
SIDE_BY_SIDE, SIDE_BY_SIDE_YAW = 0.01, 0.02
"""Tolerance with which a step puts the feet side by side [m], [rad]."""


def walk_at(
    report: AtlasSimInterfaceState,
    forward: float = 0.0,
    left: float = 0.0,
    turn: float = 0.0,
    gait: Gait | None = None,
) -> AtlasSimInterfaceCommand | None:
    """Returns the command with which the robot walks at a velocity, or goes on to.

    Call it about ten times a second and publish the result. From a behavior other than
    WALK the robot stands first. ``stop_walking`` ends the walk. The heights of steps
    are relative to the stance foot.

    Args:
        report: Latest report of the behaviors.
        forward: Speed ahead [m/s]; negative is backward.
        left: Speed to the left [m/s].
        turn: Rate of the turn to the left [rad/s].
        gait: Gait of the robot, ``controller_config().gait()`` of the scenario; None
            for Atlas' own. Steps take its duration, or less if the speed asks for it; a
            velocity beyond the robot's limits becomes the nearest within them, with a
            Python warning at the first call: ``nearest_velocity`` says which.

    Returns:
        The command; None if the robot already does what is asked for. All zero is a
        walk on the spot.

    Raises:
        InvalidMessageError: If a speed is not a finite number.
    """
    for name, value in (("forward", forward), ("left", left), ("turn", turn)):
        check_number(value, name)
    if report.current_behavior not in (Behavior.STAND, Behavior.WALK):
        return _stand(report)
    pace = pace_at(forward, left, turn, gait or Gait())
    if pace.velocity.differs_from(forward, left, turn):
        most = fastest(gait or Gait())
        text = f"walk_at walks at nearest_velocity(...) instead; at most {most}"
        warnings.warn(text, stacklevel=2)
    beginning = _beginning(report, RIGHT if (left or turn) < 0.0 else LEFT, pace.gait)
    if beginning is None:
        return None
    steps = _steps(beginning, pace)
    return None if _are_known(steps, report) else walk_command(steps)


def stop_walking(
    report: AtlasSimInterfaceState, gait: Gait | None = None
) -> AtlasSimInterfaceCommand | None:
    """Returns the command that ends a walk with the feet side by side, then STAND.

    Call it about ten times a second until the robot stands; strides shrink by the
    gait's ``stride_change``.

    Args:
        report: Latest report of the behaviors.
        gait: Gait of the robot; None for Atlas' own.

    Returns:
        The command to publish now; None if there is nothing to command.
    """
    if report.current_behavior != Behavior.WALK:
        return None
    if _closes(report, gait or Gait()):
        return _stand(report)
    return walk_at(report, gait=gait)


def walk_command(steps: list[AtlasBehaviorStepData]) -> AtlasSimInterfaceCommand:
    """Requests WALK with heights relative to the stance foot."""
    command = AtlasSimInterfaceCommand(behavior=Behavior.WALK)
    command.walk_params.step_queue = steps
    command.walk_params.use_relative_step_height = True
    return command


class Velocity(NamedTuple):
    """Velocity of a walk.

    Attributes:
        forward: Speed ahead [m/s]; negative is backward.
        left: Speed to the left [m/s].
        turn: Rate of the turn to the left [rad/s].
    """

    forward: float
    left: float
    turn: float

    def differs_from(self, forward: float, left: float, turn: float) -> bool:
        """Returns True if another velocity is not the same within rounding."""
        others = forward, left, turn
        return any(abs(a - b) > _SAME_SPEED for a, b in zip(self, others, strict=True))


def nearest_velocity(
    forward: float = 0.0,
    left: float = 0.0,
    turn: float = 0.0,
    gait: Gait | None = None,
) -> Velocity:
    """Returns the velocity at which ``walk_at`` walks: the nearest within the limits.

    Args:
        forward: Speed ahead [m/s]; negative is backward.
        left: Speed to the left [m/s].
        turn: Rate of the turn to the left [rad/s].
        gait: Gait of the robot; None for Atlas' own.
    """
    return pace_at(forward, left, turn, gait or Gait()).velocity


class Fastest(NamedTuple):
    """Largest velocities of a robot, each by itself.

    Attributes:
        ahead: [m/s].
        back: [m/s], positive.
        aside: To either side [m/s].
        turn: Either way [rad/s].
    """

    ahead: float
    back: float
    aside: float
    turn: float

    def __str__(self) -> str:
        """The velocities in words."""
        return (
            f"{self.ahead:.2f} m/s ahead, {self.back:.2f} m/s back, "
            f"{self.aside:.2f} m/s aside and {self.turn:.2f} rad/s"
        )


@functools.lru_cache(maxsize=8)
def fastest(gait: Gait) -> Fastest:
    """Returns the largest velocities that ``walk_at`` accepts; cached for its warning.

    Args:
        gait: Gait of the robot.
    """
    return Fastest(
        nearest_velocity(forward=_ANY, gait=gait).forward,
        -nearest_velocity(forward=-_ANY, gait=gait).forward,
        nearest_velocity(left=_ANY, gait=gait).left,
        nearest_velocity(turn=_ANY, gait=gait).turn,
    )


class Pace(NamedTuple):
    """Steps of a velocity."""

    gait: Gait  # With the duration of the steps
    stride: float  # Distance ahead of each step [m]
    shift: float  # Side step to the left of each pair of steps [m]
    turn: float  # Turn to the left of each step [rad]

    @property
    def velocity(self) -> Velocity:
        """Velocity of these steps."""
        per_step = 1.0 / self.gait.duration
        return Velocity(
            self.stride * per_step, 0.5 * self.shift * per_step, self.turn * per_step
        )


def pace_at(forward: float, left: float, turn: float, gait: Gait) -> Pace:
    """Returns the steps of a velocity, or of the nearest that the robot can walk."""
    limits = gait.limits
    gait = _narrow_if_needed(gait, left)
    backward = limits.backward / limits.forward if forward < 0.0 else 1.0
    stride_rate = abs(forward) / backward  # Per second
    widest = limits.width.greatest - gait.stance_width - SIDE_BY_SIDE
    quickest = limits.duration.least
    duration = gait.duration
    if left:
        duration = min(duration, 0.5 * widest / abs(left))
        apart = gait.stance_width + 2.0 * abs(left) * duration
        duration = min(duration, longest_duration(apart, limits))
    if stride_rate or turn:
        # Turning takes the feet apart lengthways as well.
        apart_rate = stride_rate + gait.stance_width * abs(turn)
        duration = min(duration, gait.nearest(turn=0.0).longest_stride / apart_rate)
    if forward and turn:
        longest = gait.longest_on_bend(abs(turn / forward))
        duration = min(duration, longest / abs(forward))
    if turn:
        duration = min(duration, gait.turning_duration(turn))
    duration = max(duration, quickest)
    paced = gait.nearest(
        stride=stride_rate * duration, turn=abs(turn) * duration, duration=duration
    )
    shift = clip(2.0 * left * paced.duration, -widest, widest)
    ahead = limits.longest_ahead(gait.stance_width + abs(shift))
    longest = min(backward * paced.stride, ahead)
    return Pace(
        paced,
        clip(forward * paced.duration, -longest, longest),
        shift,
        clip(turn * paced.duration, -paced.turn, paced.turn),
    )


def _narrow_if_needed(gait: Gait, left: float) -> Gait:
    """Returns the gait, with the feet near each other if side steps need the room."""
    limits = gait.limits
    room = limits.width.greatest - gait.stance_width - SIDE_BY_SIDE
    # A side step takes two steps.
    if 2.0 * abs(left) * limits.duration.least <= room:
        return gait
    return replace(gait, stance_width=limits.width.least + SIDE_BY_SIDE)


class _Beginning(NamedTuple):
    """Where the next steps begin."""

    step_index: int  # Of the first one
    foot: int  # Foot of the first one
    feet: tuple[Foothold, Foothold]  # Left and right sole before it
    stride: float  # Stride of the step before it [m]


def _beginning(
    report: AtlasSimInterfaceState, foot: int, gait: Gait
) -> _Beginning | None:
    """Returns where the steps begin that can still be changed; None at a walk's end.

    ``foot`` takes the first step of a walk.
    """
    feet = [foothold(pose) for pose in report.foot_pos_est]
    if report.current_behavior != Behavior.WALK:
        return _Beginning(1, foot, (feet[LEFT], feet[RIGHT]), 0.0)
    index = first_open_step(report)
    known = _known_steps(report)
    if not known:
        return None
    for step in known:
        if step.step_index < index:
            feet[step.foot_index] = foothold(step.pose)
    odd = (index - known[0].step_index) % 2
    foot = known[0].foot_index ^ odd
    stride, _ = _way(feet, 1 - foot, gait) if index > 1 else (0.0, 0.0)
    return _Beginning(index, foot, (feet[LEFT], feet[RIGHT]), stride)


def first_open_step(report: AtlasSimInterfaceState) -> int:
    """Returns the index of the first step that can still be changed safely.

    In single support it is the step after the present one. In double support the weight
    already shifts for the next step, so it is the step after that.
    """
    if report.current_behavior != Behavior.WALK:
        return 1
    current = report.walk_feedback.current_step_index
    return current + (1 if _in_air(report) else 2)


def _in_air(report: AtlasSimInterfaceState) -> AtlasBehaviorStepData | None:
    current = report.walk_feedback.current_step_index
    steps = (step for step in _known_steps(report) if step.step_index == current)
    return next(steps, None)


def _known_steps(report: AtlasSimInterfaceState) -> list[AtlasBehaviorStepData]:
    """Returns the steps that WALK is going to take, the one in the air first."""
    queue = report.walk_feedback.step_queue_saturated
    return [step for step in queue if step.step_index > 0]


def _way(feet: list[Foothold], foot: int, gait: Gait) -> tuple[float, float]:
    """Returns how far ``foot`` is ahead, and to the left, of feet side by side [m]."""
    stance, landed = (middle_beside(feet[f], f, gait) for f in (1 - foot, foot))
    return way_to(stance, landed, wrap_angle(landed.yaw - stance.yaw))


def _steps(beginning: _Beginning, pace: Pace) -> list[AtlasBehaviorStepData]:
    first, foot, soles, stride = beginning
    feet = list(soles)
    gait = pace.gait
    steps = []
    for place in range(NUM_REQUIRED_WALK_STEPS):
        change = pace.stride - stride
        stride += clip(change, -gait.stride_change, gait.stride_change)
        feet[foot] = step_from(
            feet[1 - foot], foot, gait, stride, pace.shift, pace.turn
        )
        steps.append(step_data(first + place, foot, feet[foot], gait))
        foot = 1 - foot
    return steps


def _are_known(
    steps: list[AtlasBehaviorStepData], report: AtlasSimInterfaceState
) -> bool:
    """Returns True if WALK is going to take these steps, but for the last one."""
    known = {step.step_index: step for step in _known_steps(report)}
    return report.current_behavior == Behavior.WALK and all(
        step.step_index in known and _are_same(step, known[step.step_index])
        for step in steps[: NUM_REQUIRED_WALK_STEPS - 1]
    )


def _are_same(one: AtlasBehaviorStepData, other: AtlasBehaviorStepData) -> bool:
    a, b = foothold(one.pose), foothold(other.pose)
    return (
        math.hypot(a.x - b.x, a.y - b.y) < SAME
        and abs(wrap_angle(a.yaw - b.yaw)) < SAME_YAW
        and abs(one.duration - other.duration) < SAME
    )


def _closes(report: AtlasSimInterfaceState, gait: Gait) -> bool:
    """Returns True if the step in the air puts the feet side by side."""
    step = _in_air(report)
    if step is None:
        return False
    feet = [foothold(pose) for pose in report.foot_pos_est]
    feet[step.foot_index] = foothold(step.pose)
    turned = wrap_angle(feet[LEFT].yaw - feet[RIGHT].yaw)
    apart = math.hypot(*_way(feet, step.foot_index, gait))
    return apart < SIDE_BY_SIDE and abs(turned) < SIDE_BY_SIDE_YAW


def _stand(report: AtlasSimInterfaceState) -> AtlasSimInterfaceCommand | None:
    if report.desired_behavior == Behavior.STAND:
        return None
    return AtlasSimInterfaceCommand(behavior=Behavior.STAND)
