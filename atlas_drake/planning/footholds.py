"""Footholds relative to the stance foot.

Plane geometry, and the message of a step. Walks to a goal are planned in
``footstep_planner``, walks at a velocity in ``walk_at``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from atlas_drake.config import Configuration, Positive
from atlas_drake.control.feet.footstep import clip, longest_duration, outward
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.control.feet.swing_foot import SwingProfile
from atlas_drake.errors import shown
from atlas_drake.messages import AtlasBehaviorStepData, Pose
from atlas_drake.rotations import rotation_matrix, wrap_angle, yaw_of
from atlas_drake.units import Meters, Radians, Seconds

SIDEWAYS_SHARE = 0.5
"""Share of the stride for each pair of steps to the side. Geometry of the legs; the
stride is the setting."""

NEARING = 1.7
"""Square of the stride on a bend, over its radius times the distance by which the feet
may come nearer to each other [-]: 2 by geometry, less a margin for landing errors."""

STANCE_WIDTH = 0.24
"""Default distance between the soles' middles of feet side by side [m]."""

_ROUNDING = 1e-9
_TURN_MARGIN = 0.02
"""Distance from the limits of a turn that landing errors need [rad]."""


@dataclass(frozen=True, kw_only=True)
class UsualSteps(Configuration):
    """Default steps of a walk, for demonstrations and planners."""

    stride: Positive[Meters] = 0.20
    """Distance from one footprint to the next."""
    turn: Positive[Radians] = 0.15
    """Turn of each step on a bend or on the spot."""
    duration: Positive[Seconds] = 0.63
    """Duration of each step."""
    stride_change: Positive[Meters] = 0.20
    """Largest change of the stride from one step to the next: a walk begins and ends
    with shorter strides, because the robot has to gain and lose its speed."""


@dataclass(frozen=True)
class Gait:
    """Parameters of a walk; defaults are Atlas' values.

    ``ControllerConfig.gait`` returns those of a robot and a scenario.

    Attributes:
        stride: Distance from one footprint to the next; at most 0.35 for Atlas.
        turn: Mean turn of a step; at most 0.5 for Atlas.
        duration: Duration of each step; at most 3.0 for Atlas, less with a stride
            that takes the feet far apart, about 1.4 with the longest.
        stride_change: Largest change of the stride from one step to the next.
        swing_height: Apex of the swing above the middle of its ends.
        limits: Limits of one step of the robot.
        stance_width: Distance between the soles' middles of feet side by side.

    Raises:
        ValueError: If the robot cannot walk like that; it names field and value.
    """

    stride: Meters = UsualSteps.stride
    turn: Radians = UsualSteps.turn
    duration: Seconds = UsualSteps.duration
    stride_change: Meters = UsualSteps.stride_change
    swing_height: Meters = SwingProfile.height
    limits: StepLimits = field(default_factory=StepLimits, repr=False)
    stance_width: Meters = field(default=STANCE_WIDTH, repr=False)

    def nearest(self, **desired: float) -> Gait:
        """Returns the feasible gait nearest to values that may be beyond the limits.

        Args:
            **desired: Values of stride, turn, duration and swing_height other than
                this gait's.
        """
        limits = self.limits
        turn = clip(desired.get("turn", self.turn), 0.01, self.sharpest_turn)
        # The longest stride depends on the turn, and the longest duration on both.
        turning = replace(self, stride=0.01, turn=turn, duration=limits.duration.least)
        values: dict[str, Any] = {
            name: clip(desired.get(name, getattr(self, name)), low, high)
            for name, low, high in turning.bounds()
        }
        quickest = replace(turning, **{**values, "duration": limits.duration.least})
        longest = longest_duration(quickest._farthest_apart, self.limits)
        return replace(quickest, duration=min(values["duration"], longest))

    def at_speed(self, speed: float, curvature: float = 0.0) -> Gait:
        """Returns the gait that walks ahead at a speed, at its own pace if possible.

        Up to the longest stride the duration stays; beyond, steps become quicker. On a
        bend each step turns as far as its stride needs.

        Args:
            speed: Stride per duration [m/s].
            curvature: Turn of the way per distance [rad/m], not negative.

        Raises:
            ValueError: If the robot cannot walk ahead so fast; it names the fastest.
        """
        quickest = self.limits.duration.least
        longest = self.longest_on_bend(curvature)
        fastest = longest / quickest
        if not 0.0 < speed <= fastest + _ROUNDING:
            text = f"speed is {shown(speed)}, and not above 0 and at most {fastest:.2f}"
            if curvature:
                text += f" with a radius of {1.0 / curvature:.2f} m"
            raise ValueError(text)
        stride = clip(speed * self.duration, 0.01, longest)
        duration = clip(stride / speed, quickest, self.duration)
        turn = self.turn
        if curvature:
            turn = clip(stride * curvature, 0.01, self.limits.toe_in)
        return replace(self, stride=stride, duration=duration, turn=turn)

    def longest_on_bend(self, curvature: float) -> float:
        """Computes the longest stride on a bend [m].

        Args:
            curvature: Turn of the way per distance [rad/m], not negative.
        """
        if curvature == 0.0:
            return self.longest_stride
        limits, width = self.limits, self.stance_width
        # A step turns by stride times curvature, which takes the feet apart lengthways
        # as well; and the outer foot's next place may not come too near the inner one.
        apart = (limits.forward - 0.01) / (1.0 + width * curvature)
        near = NEARING * (width - limits.width.least) / curvature
        return min(apart, limits.toe_in / curvature, math.sqrt(near))

    def turning_at(self, rate: float) -> Gait:
        """Returns the gait that turns on the spot at a rate, as for ``at_speed``.

        Args:
            rate: Turn of a step per duration [rad/s].

        Raises:
            ValueError: If the robot cannot turn so fast; it names the fastest.
        """
        quickest = self.limits.duration.least
        fastest = self.sharpest_turn / quickest
        if not 0.0 < rate <= fastest + _ROUNDING:
            text = f"rate is {shown(rate)}, and not above 0 and at most {fastest:.2f}"
            raise ValueError(text)
        duration = self.turning_duration(rate)
        return replace(self, turn=max(rate * duration, 0.01), duration=duration)

    def turning_duration(self, rate: float) -> float:
        """Returns the duration of steps that turn at a rate [s].

        Both feet turn alike, if need be in quicker steps; only the quickest have the
        outward foot turn farther.

        Args:
            rate: Turn of a step per duration, not 0 [rad/s].
        """
        alike = self.limits.toe_in / abs(rate)
        return max(min(self.duration, alike), self.limits.duration.least)

    @property
    def sharpest_turn(self) -> float:
        """Largest mean turn of a step [rad].

        Hips turn farther outward than inward.
        """
        limits = self.limits
        most = limits.toe_in + max(limits.toe_in, limits.toe_out)
        return 0.5 * most - _TURN_MARGIN

    def turn_of(self, foot: int, turn: float) -> float:
        """Returns the turn of a step [rad].

        The outward foot makes up for what is beyond the inward one's limit.

        Args:
            foot: LEFT or RIGHT.
            turn: Mean turn of a step to the left [rad].
        """
        beyond = max(abs(turn) - self.limits.toe_in + _TURN_MARGIN, 0.0)
        return turn + outward(foot) * beyond

    @property
    def longest_stride(self) -> float:
        """Longest stride with this gait's turn [m]."""
        # Turning takes the feet apart lengthways as well.
        return self.limits.forward - self.stance_width * self.turn - 0.01

    @property
    def backward_stride(self) -> float:
        """Stride when walking backward, of which the legs can do less [m]."""
        return self.stride * self.limits.backward / self.limits.forward

    @property
    def half_width(self) -> float:
        """Distance of each foot from the middle between both [m]."""
        return 0.5 * self.stance_width

    def bounds(self) -> tuple[tuple[str, float, float], ...]:
        """Least and greatest value of each field."""
        limits = self.limits
        return (
            ("stride", 0.01, self.longest_stride),
            ("stride_change", 0.01, math.inf),
            ("turn", 0.01, self.sharpest_turn),
            ("swing_height", *limits.swing_height),
            ("duration", *limits.duration),
        )

    def __post_init__(self) -> None:
        for name, low, high in self.bounds():
            value = getattr(self, name)
            if not low - _ROUNDING <= value <= high + _ROUNDING:
                text = f"gait.{name} is {value!r}, and not between {low} and {high:.2f}"
                raise ValueError(text)
        longest = longest_duration(self._farthest_apart, self.limits)
        if self.duration > longest + _ROUNDING:
            text = f"gait.duration is {self.duration!r}, and not at most {longest:.2f}"
            apart = f"a stride of {self.stride!r} takes feet up to"
            raise ValueError(f"{text}: {apart} {self._farthest_apart:.2f} m apart")

    @property
    def _farthest_apart(self) -> float:
        """Upper bound of the distance between the feet in any step [m].

        The bound is the distance in a full stride with a side step and an inward turn.
        """
        aside = SIDEWAYS_SHARE * self.stride
        turned = 2.0 * self.stride * aside * math.sin(0.5 * self.turn)
        return math.sqrt(self.stride**2 + (self.stance_width + aside) ** 2 + turned)


class Foothold(NamedTuple):
    """A sole on the ground in W, or the middle between two [m], [rad]."""

    x: float
    y: float
    yaw: float


def foothold(pose: Pose) -> Foothold:
    """Returns place and heading of a sole."""
    yaw = yaw_of(rotation_matrix(pose.orientation.to_wxyz()))
    return Foothold(pose.position.x, pose.position.y, wrap_angle(yaw))


def middle_beside(sole: Foothold, foot: int, gait: Gait) -> Foothold:
    """Computes the middle between the feet if the other foot stood beside ``foot``."""
    return moved(sole, 0.0, -outward(foot) * gait.half_width, 0.0)


def sole_beside(middle: Foothold, foot: int, gait: Gait) -> Foothold:
    """Computes the place of a foot for a ``middle`` between both feet."""
    return moved(middle, 0.0, outward(foot) * gait.half_width, 0.0)


def moved(place: Foothold, ahead: float, left: float, turn: float) -> Foothold:
    """Moves a place ahead and round a turn [rad], then to the new left [m].

    ``ahead`` [m] is along the heading half-way through the turn.
    """
    yaw, half = place.yaw + turn, place.yaw + 0.5 * turn
    return Foothold(
        place.x + ahead * math.cos(half) - left * math.sin(yaw),
        place.y + ahead * math.sin(half) + left * math.cos(yaw),
        yaw,
    )


def way_to(place: Foothold, goal: Foothold, turn: float) -> tuple[float, float]:
    """Computes the ``ahead`` and ``left`` with which ``moved`` reaches ``goal`` [m].

    The heading of the goal is ignored; ``turn`` is less than a right angle [rad].
    """
    half = place.yaw + 0.5 * turn
    dx, dy = goal.x - place.x, goal.y - place.y
    along = dx * math.cos(half) + dy * math.sin(half)
    across = dy * math.cos(half) - dx * math.sin(half)
    # The new left leans back by half the turn.
    left = across / math.cos(0.5 * turn)
    return along + left * math.sin(0.5 * turn), left


def step_from(
    stance: Foothold, foot: int, gait: Gait, stride: float, shift: float, turn: float
) -> Foothold:
    """Computes the foothold of a step relative to the stance foot.

    ``stride`` is ahead of the stance foot [m], ``turn`` that of the middle between the
    feet, on the spot and on average [rad]. Only the foot on the side of ``shift`` [m]
    takes it; the other foot then closes up.
    """
    left = shift if shift * outward(foot) > 0.0 else 0.0
    beside = middle_beside(stance, 1 - foot, gait)
    middle = moved(beside, stride, left, gait.turn_of(foot, turn))
    return sole_beside(middle, foot, gait)


def step_data(
    index: int, foot: int, place: Foothold, gait: Gait
) -> AtlasBehaviorStepData:
    """Makes the message of a step, at the height z = 0."""
    step = AtlasBehaviorStepData()
    step.step_index, step.foot_index = index, foot
    step.duration, step.swing_height = gait.duration, gait.swing_height
    step.pose.position.x, step.pose.position.y = place.x, place.y
    step.pose.orientation.z = math.sin(0.5 * place.yaw)
    step.pose.orientation.w = math.cos(0.5 * place.yaw)
    return step
