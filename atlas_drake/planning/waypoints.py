"""Steering to a waypoint: the command that a place and a heading ask for."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pydrake.math import RigidTransform

from atlas_drake.messages import AtlasSimInterfaceCommand, AtlasSimInterfaceState
from atlas_drake.planning.footholds import Gait
from atlas_drake.planning.walk_at import (
    Velocity,
    nearest_velocity,
    stop_walking,
    walk_at,
)
from atlas_drake.rotations import wrap_angle, yaw_of

GAIN = 1.5
"""Velocity per error of place and heading [1/s]."""
NEAR, NEAR_YAW = 0.10, 0.1
"""Errors from which the robot may stand [m], [rad]."""
FASTEST, FASTEST_TURN = 0.4, 0.6
"""Usual limits of the velocity [m/s], [rad/s]."""


def walk_to(
    report: AtlasSimInterfaceState,
    X_WP: RigidTransform,
    place: Sequence[float],
    heading: float,
    gait: Gait,
    fastest: float = FASTEST,
) -> AtlasSimInterfaceCommand | None:
    """Returns the command with which the robot walks to a waypoint, and stands there.

    Call it about ten times a second and publish the result.

    Example:
        >>> report = sim.atlas_sim_interface_state
        >>> command = walk_to(report, sim.pelvis_pose, (1.0, 0.5), 0.0, gait)

    Args:
        report: Latest report of the behaviors.
        X_WP: Pose of the pelvis in W.
        place: x and y of the waypoint in W [m].
        heading: Heading there in W [rad].
        gait: Gait of the robot.
        fastest: Largest speed asked for [m/s].

    Returns:
        The command; None if the robot already does what is asked for.
    """
    velocity = velocity_to(X_WP, place, heading, gait, fastest)
    if velocity is None:
        return stop_walking(report, gait)
    return walk_at(report, *velocity, gait=gait)


def waypoint_error(
    X_WP: RigidTransform, place: Sequence[float], heading: float
) -> tuple[float, float, float]:
    """Computes the way to a waypoint as the pelvis sees it.

    Args:
        X_WP: Pose of the pelvis in W.
        place: x and y of the waypoint in W [m].
        heading: Heading there in W [rad].

    Returns:
        Ahead [m], to the left [m], and turned to the left [rad].
    """
    yaw = yaw_of(X_WP.rotation().matrix())
    x, y = place
    dx, dy = x - float(X_WP.translation()[0]), y - float(X_WP.translation()[1])
    c, s = math.cos(yaw), math.sin(yaw)
    return c * dx + s * dy, c * dy - s * dx, wrap_angle(heading - yaw)


def velocity_to(
    X_WP: RigidTransform,
    place: Sequence[float],
    heading: float,
    gait: Gait,
    fastest: float = FASTEST,
) -> Velocity | None:
    """Computes the velocity of ``walk_at`` with which the robot nears a waypoint.

    Args:
        X_WP: Pose of the pelvis in W.
        place: x and y of the waypoint in W [m].
        heading: Heading there in W [rad].
        gait: Gait of the robot.
        fastest: Largest speed asked for [m/s].

    Returns:
        The nearest velocity that the robot can walk at; None once it is there.
    """
    ahead, left, turn = waypoint_error(X_WP, place, heading)
    away = math.hypot(ahead, left)
    if away < NEAR and abs(turn) < NEAR_YAW:
        return None
    share = min(GAIN, fastest / max(away, 1e-9))
    rate = min(max(GAIN * turn, -FASTEST_TURN), FASTEST_TURN)
    return nearest_velocity(share * ahead, share * left, rate, gait)
