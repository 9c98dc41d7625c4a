"""Footstep plans: a distance ahead, a turn, an arc, or to a pose.

Each function takes the latest report of a standing robot and returns steps for
``walk_params.step_queue``, in order and counted from 1, from the present footholds to
feet side by side; none if there is nothing to do. They are within the limits of the
gait's robot: Atlas, unless another gait is given. ``step_stream`` sends more steps than
the queue holds. The ground is assumed to be level; obstacles are not detected.

With ``speed`` stride and duration follow from it (``Gait.at_speed``). Strides grow and
shrink by at most ``Gait.stride_change`` from step to step: the speed is that between
the first and the last steps.

Each raises ``ValueError`` if a number is beyond MAX_DISTANCE or MAX_TURN or none, the
report has no place for a foot, or the feet are not on one level. The constants are
bounds of what is sensible and tolerances; the settings are in ``Gait``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, replace

from atlas_drake.control.feet.footstep import clip, longest_duration, outward
from atlas_drake.errors import shown
from atlas_drake.messages import AtlasBehaviorStepData, AtlasSimInterfaceState
from atlas_drake.messages.footstep import LEFT, RIGHT
from atlas_drake.planning.footholds import (
    SIDEWAYS_SHARE,
    Foothold,
    Gait,
    foothold,
    middle_beside,
    moved,
    sole_beside,
    step_data,
    way_to,
)
from atlas_drake.rotations import mean_yaw, wrap_angle

FAR = 0.8
"""Distance to a pose beyond which the robot turns and walks ahead; to a nearer pose it
walks without turning first, also backward and sideways [m]."""
CLOSING = 0.02
"""Greatest decrease of the distance between the feet from the side-by-side stance
[m]."""
MAX_DISTANCE = 1000.0
"""Longest distance of a plan, ahead or along each axis of the world [m]."""
MAX_TURN = 1000.0
"""Largest angle of a plan [rad]."""
WORLD = 1e6
"""Greatest distance of the feet from the world's origin [m]."""
UNEVEN = 0.02
"""Difference in height of the feet above which the ground is not level [m]."""
REACHED, REACHED_YAW = 1e-6, 1e-6
"""Tolerance for rounding with which a place counts as reached [m], [rad]."""
SIDE_BY_SIDE, SIDE_BY_SIDE_YAW = 0.03, 0.05
"""Tolerance with which feet count as side by side [m], [rad]."""


def steps_ahead(
    report: AtlasSimInterfaceState,
    distance: float,
    gait: Gait | None = None,
    speed: float | None = None,
) -> list[AtlasBehaviorStepData]:
    """Plans steps straight ahead.

    Args:
        report: Latest report.
        distance: Way of the middle between the feet [m]; negative is backward.
        gait: Gait of the walk.
        speed: Speed of the walk [m/s]; None for the gait's.
    """
    _check_range("distance", distance, MAX_DISTANCE)
    return steps_along_arc(report, distance, 0.0, gait, speed)


def steps_turning(
    report: AtlasSimInterfaceState,
    angle: float,
    gait: Gait | None = None,
    rate: float | None = None,
) -> list[AtlasBehaviorStepData]:
    """Plans steps that turn on the spot.

    Args:
        report: Latest report.
        angle: Turn of the robot [rad], positive to the left.
        gait: Gait of the walk.
        rate: Rate of the turn [rad/s]; None for the gait's.
    """
    gait = gait or Gait()
    if rate is not None:
        gait = gait.turning_at(rate)
    return steps_along_arc(report, 0.0, angle, gait)


def steps_along_arc(
    report: AtlasSimInterfaceState,
    length: float,
    angle: float,
    gait: Gait | None = None,
    speed: float | None = None,
) -> list[AtlasBehaviorStepData]:
    """Plans steps along an arc of a circle.

    Args:
        report: Latest report.
        length: Length of the arc [m]; negative is backward.
        angle: Turn over the arc [rad], positive to the left.
        gait: Gait of the walk.
        speed: Speed along the arc [m/s]; None for the gait's.
    """
    _check_range("length", length, MAX_DISTANCE)
    _check_range("angle", angle, MAX_TURN)
    curvature = abs(angle / length) if length else 0.0
    gait = _gait_at(gait, speed, backward=length < 0.0, curvature=curvature)
    return _steps(report, _arc(_middle(report), length, angle, gait), gait)


def steps_to(
    report: AtlasSimInterfaceState,
    x: float,
    y: float,
    yaw: float,
    gait: Gait | None = None,
    speed: float | None = None,
) -> list[AtlasBehaviorStepData]:
    """Plans steps to a pose in the world.

    Args:
        report: Latest report.
        x: Goal of the middle between the feet in W [m], within MAX_DISTANCE.
        y: Likewise [m].
        yaw: Heading of the robot at the goal [rad].
        gait: Gait of the walk.
        speed: Speed of the walk ahead [m/s]; None for the gait's.
    """
    gait = _gait_at(gait, speed)
    here = _middle(report)
    _check_range("x", x, MAX_DISTANCE, here.x)
    _check_range("y", y, MAX_DISTANCE, here.y)
    _check_range("yaw", yaw, MAX_TURN)
    goal = Foothold(x, y, yaw)
    dx, dy = x - here.x, y - here.y
    distance = math.hypot(dx, dy)
    if distance <= FAR:
        # Too near to gain speed first.
        gait = replace(gait, stride=min(gait.stride, gait.stride_change))
        return _steps(report, [goal], gait)
    bearing = math.atan2(dy, dx)
    way = _arc(here, 0.0, wrap_angle(bearing - here.yaw), gait)
    way += _arc(way[-1], distance, 0.0, gait)
    way += _arc(way[-1], 0.0, wrap_angle(yaw - bearing), gait)
    return _steps(report, way, gait)


def _arc(start: Foothold, length: float, angle: float, gait: Gait) -> list[Foothold]:
    """Divides an arc into places one step apart; returns at least its end."""
    stride = gait.stride if length >= 0.0 else gait.backward_stride
    # In full steps: the stride or the turn is at its most.
    full = max(abs(length) / stride, abs(angle) / gait.turn)
    ramp = 1.0
    if length:
        ramp = min(gait.stride_change * full / abs(length), 1.0)
    places = [start]
    for part in _parts(full, ramp):
        turn, chord = part * angle, part * length
        if turn:
            chord *= math.sin(0.5 * turn) / (0.5 * turn)
        places.append(moved(places[-1], chord, 0.0, turn))
    return places[1:]


def _parts(full: float, ramp: float) -> list[float]:
    """Divides a way into the shares of its steps, shorter at the beginning and the end.

    ``full`` is the length of the way in full steps, which are the longest; ``ramp`` the
    largest change of the length from step to step, in full steps.
    """
    count = max(_ceil(full), 1)
    while True:
        numbers = range(1, count + 1)
        steps = [min(ramp * n, ramp * (count + 1 - n), 1.0) for n in numbers]
        whole = sum(steps)
        if whole >= full - 1e-9:
            return [step / whole for step in steps]
        count += 1


def _gait_at(
    gait: Gait | None,
    speed: float | None,
    backward: bool = False,
    curvature: float = 0.0,
) -> Gait:
    """Returns the gait, at the given speed if there is one [m/s]."""
    gait = gait or Gait()
    if speed is None:
        return gait
    if backward:
        speed *= gait.stride / gait.backward_stride
    return gait.at_speed(speed, curvature)


def _steps(
    report: AtlasSimInterfaceState, way: Sequence[Foothold], gait: Gait
) -> list[AtlasBehaviorStepData]:
    """Plans steps from one place to the next, the last two to the last place."""
    feet = _feet(report)
    height = 0.5 * sum(pose.position.z for pose in report.foot_pos_est)
    here = _middle(report)
    if all(_is_reached(here, place) for place in way) and _side_by_side(feet, gait):
        return []
    foot = _first_foot(here, way)
    steps: list[AtlasBehaviorStepData] = []
    remaining = list(way)
    at_end = False
    while True:
        stance = middle_beside(feet[1 - foot], 1 - foot, gait)
        middle = _next_middle(stance, remaining[0], foot, gait)
        apart = math.dist(feet[0][:2], feet[1][:2])
        feet[foot] = sole_beside(middle, foot, gait)
        if len(remaining) > 1:
            # Only at the end both feet have the heading of the middle.
            turn = wrap_angle(middle.yaw - stance.yaw)
            yaw = stance.yaw + gait.turn_of(foot, turn)
            feet[foot] = feet[foot]._replace(yaw=yaw)
        step = step_data(len(steps) + 1, foot, feet[foot], gait)
        step.pose.position.z = height
        # Before the first step the feet may be farther apart than in the gait.
        step.duration = min(gait.duration, longest_duration(apart, gait.limits))
        steps.append(step)
        reached = _is_reached(middle, remaining[0])
        if len(remaining) > 1:
            if reached:
                del remaining[0]
        elif reached and at_end:
            return steps
        else:
            at_end = reached
        foot = 1 - foot


def _next_middle(stance: Foothold, goal: Foothold, foot: int, gait: Gait) -> Foothold:
    """Computes the middle between the feet after a step toward ``goal``.

    ``stance`` is the middle if ``foot`` stood beside the stance foot.
    """
    side = outward(foot)
    turn = clip(wrap_angle(goal.yaw - stance.yaw), -gait.turn, gait.turn)
    ahead, left = way_to(stance, goal, turn)
    out = clip(side * left, -CLOSING, SIDEWAYS_SHARE * gait.stride)
    farthest = min(gait.stride, _farthest_ahead(out, side * turn, gait))
    ahead = clip(ahead, -gait.backward_stride, farthest)
    return moved(stance, ahead, side * out, turn)


def _farthest_ahead(out: float, turn: float, gait: Gait) -> float:
    """Computes how far ahead of the stance foot the middle can come [m].

    A foot that turns inward comes near a limit: the turn also moves the foot ahead, and
    each distance ahead brings it nearer to the stance foot. A step to the side as well
    as ahead takes the feet far apart. No ``Gait`` reaches the other limits. ``out`` is
    the way to the side of the stepping foot [m].
    """
    limits, width = gait.limits, gait.half_width + out
    # A turn takes the feet apart by less than it moves them ahead.
    longest = limits.longest_ahead(gait.half_width + width)
    longest -= width * math.sin(abs(turn))
    farthest = (limits.forward + width * math.sin(turn)) / math.cos(0.5 * turn)
    if turn < -REACHED_YAW:
        room = gait.half_width + width * math.cos(turn) - limits.width.least
        farthest = min(farthest, room / math.sin(-0.5 * turn))
    return min(farthest, max(longest, 0.0))


def _first_foot(here: Foothold, way: Sequence[Foothold]) -> int:
    """Returns the foot on the side to which the way leads."""
    for place in way:
        _, left = way_to(here, place, 0.0)
        turn = wrap_angle(place.yaw - here.yaw)
        for lean in (left, turn):
            if abs(lean) > REACHED:
                return LEFT if lean > 0.0 else RIGHT
    return LEFT


def _feet(report: AtlasSimInterfaceState) -> list[Foothold]:
    """Returns both soles after checking that they are on one level."""
    for index, pose in enumerate(report.foot_pos_est):
        for field in ("position", "orientation"):
            for name, value in asdict(getattr(pose, field)).items():
                _check_range(f"foot_pos_est[{index}].{field}.{name}", value, WORLD)
    feet = [foothold(pose) for pose in report.foot_pos_est]
    heights = [pose.position.z for pose in report.foot_pos_est]
    if abs(heights[0] - heights[1]) > UNEVEN:
        text = f"the feet are at {heights[0]:.3f} m and {heights[1]:.3f} m"
        raise ValueError(f"{text}: footsteps are planned on level ground only")
    return feet


def _middle(report: AtlasSimInterfaceState) -> Foothold:
    left, right = _feet(report)
    x, y = 0.5 * (left.x + right.x), 0.5 * (left.y + right.y)
    return Foothold(x, y, mean_yaw(left.yaw, right.yaw))


def _side_by_side(feet: Sequence[Foothold], gait: Gait) -> bool:
    beside = sole_beside(middle_beside(feet[LEFT], LEFT, gait), RIGHT, gait)
    return (
        math.dist(beside[:2], feet[RIGHT][:2]) <= SIDE_BY_SIDE
        and abs(wrap_angle(beside.yaw - feet[RIGHT].yaw)) <= SIDE_BY_SIDE_YAW
    )


def _is_reached(place: Foothold, goal: Foothold) -> bool:
    return (
        math.dist(place[:2], goal[:2]) <= REACHED
        and abs(wrap_angle(place.yaw - goal.yaw)) <= REACHED_YAW
    )


def _check_range(name: str, number: float, size: float, about: float = 0.0) -> None:
    # Comparisons only: a number may be too large for a float.
    low, high = about - size, about + size
    if not low <= number <= high:
        text = f"{name} is {shown(number)}, and not between {low:g} and {high:g}"
        raise ValueError(text)


def _ceil(share: float) -> int:
    """Rounds up to whole steps, with a tolerance for rounding errors."""
    return math.ceil(share - 1e-9)
