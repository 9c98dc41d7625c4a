"""Limits of a walk's steps that a robot's legs allow: by ranges, shapes and knees.

Both soles are flat while the weight goes from one foot to the other, and the pelvis is
between them: a step that takes an ankle to its end stop then is too large. Ahead the
trailing heel rises, so that the ankles do not bound a step. Where a foot passes the
other leg, their shapes stay apart, as in TALOS, whose shanks are as wide as its feet. A
knee with less torque for the robot's weight and height than Atlas' carries it through
shorter strides.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from atlas_drake.behaviors.leg_clearance import leg_clearance, pelvis_to_feet
from atlas_drake.config import LeastGreatest
from atlas_drake.control.feet.leg_kinematics import leg_solver
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.frozen import replace
from atlas_drake.robot import Robot
from atlas_drake.rotations import rotation_z
from atlas_drake.units import GRAVITY

SWAY = 0.2
"""Distance of the pelvis from the middle of the feet, in distances of the feet, that a
walk takes it to while both soles are flat [-]."""
SINKS = (0.0, 0.04, 0.08, 0.12)
"""Lowerings of the pelvis among which it has one that reaches, in pelvis heights: in a
long step the robot sinks [-]."""
MARGIN = 0.02
"""Distance of each joint from its end stop [rad]."""
KNEE = 0.264
"""Torque of Atlas' knees, over weight times height of the center of mass [-]."""
_HALVINGS = 8
"""Halvings of the range between a step that is possible and one that is not."""


def stance_clearing(width: float, limits: StepLimits, robot: Robot) -> float:
    """Returns the distance of feet side by side at which one of them may turn [m].

    Args:
        width: Distance that the robot would have otherwise [m].
        limits: Of one step.
        robot: The shapes of its legs stay apart.
    """
    clears = leg_clearance(robot)
    return _nearest(
        limits.width.greatest, width, lambda far: clears(far, -limits.toe_in)
    )


@functools.lru_cache(maxsize=8)
def within_ranges(
    limits: StepLimits, robot: Robot, width: float, com_drop: float
) -> StepLimits:
    """Returns the limits, reduced to what both legs reach with flat soles, and carry.

    Cached, because each configuration of a robot needs them.

    Args:
        limits: Of one step.
        robot: Its joints, knees and shapes bound the steps.
        width: Distance of feet side by side [m].
        com_drop: Lowering of the center of mass below the stand-prep pose [m].
    """
    reach, clears = _Reach(robot, com_drop), leg_clearance(robot)
    # A robot sinks in a long step as in a wide one: the knees carry more.
    carried = min(knee_strength(robot) / KNEE, 1.0)
    widest = _nearest(width, limits.width.greatest, lambda far: reach(aside=far))
    return replace(
        limits,
        width=LeastGreatest(
            _nearest(width, limits.width.least, clears), max(width, carried * widest)
        ),
        passing=_nearest(width, 0.0, clears),
        forward=carried * limits.forward,
        backward=carried
        * _nearest(0.0, limits.backward, lambda far: reach(-far, width)),
        toe_out=_nearest(
            0.0,
            limits.toe_out,
            lambda turn: reach(0.0, width, turn) and clears(width, turn),
        ),
        toe_in=_nearest(0.0, limits.toe_in, lambda turn: reach(0.0, width, -turn)),
    )


def knee_strength(robot: Robot) -> float:
    """Computes the knees' torque over weight times height of the center of mass [-]."""
    knees = [leg.knee for leg in robot.legs]
    moment = robot.mass * GRAVITY * robot.com_height
    return float(robot.effort_limit[knees].min()) / moment


def _nearest(allowed: float, limit: float, reached: Callable[[float], bool]) -> float:
    """Returns the value nearest to ``limit`` that is reached, as ``allowed`` is."""
    if reached(limit):
        return limit
    for _ in range(_HALVINGS):
        middle = 0.5 * (allowed + limit)
        if reached(middle):
            allowed = middle
        else:
            limit = middle
    return allowed


class _Reach:
    """Whether both legs reach their soles in a step, whatever foot takes it."""

    def __init__(self, robot: Robot, com_drop: float):
        self._p_PM = pelvis_to_feet(robot) + np.array([0.0, 0.0, com_drop])
        self._legs = [
            (
                leg_solver(leg),
                robot.position_lower[leg.joints] + MARGIN,
                robot.position_upper[leg.joints] - MARGIN,
            )
            for leg in robot.legs
        ]

    def __call__(
        self, ahead: float = 0.0, aside: float = 0.0, turn: float = 0.0
    ) -> bool:
        """Returns True if both soles are reached with the pelvis on its way.

        Args:
            ahead: Of the foot that steps, from the other one [m].
            aside: Distance of the feet across [m].
            turn: Of the foot that steps, outward [rad].
        """
        for foot, side in ((0, 1.0), (1, -1.0)):
            # Of the foot that steps from the other one; the pelvis turns by half of it.
            step, turned = np.array([ahead, side * aside, 0.0]), side * turn
            if not self._reaches(foot, step, turned):
                return False
            if not self._reaches(1 - foot, -step, -turned):
                return False
        return True

    def _reaches(self, leg: int, step: np.ndarray, turn: float) -> bool:
        solve, lower, upper = self._legs[leg]
        R_PF = rotation_z(0.5 * turn)

        def reaches(sway: float, sink: float) -> bool:
            p_PF = self._p_PM + (0.5 + sway) * step
            p_PF[2] *= 1.0 - sink
            pose = solve(p_PF, R_PF, None)
            return pose is not None and bool(
                np.all((lower <= pose.angles) & (pose.angles <= upper))
            )

        return all(any(reaches(sway, sink) for sink in SINKS) for sway in (-SWAY, SWAY))
