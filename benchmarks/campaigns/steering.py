"""Steering by hand: a tour of waypoints with driven arms, punches, random velocities.

The tour is after the benchmark ``rhoyn/teleop-walking-benchmark`` for learned walking
policies: every five seconds another waypoint and a punch, arms that a user moves all
the time. The limits are in the files of campaigns that name this one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from atlas_drake import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimulation,
    nearest_velocity,
    walk_at,
    walk_to,
)
from atlas_drake.planning.footholds import Gait
from atlas_drake.planning.walk_at import fastest
from atlas_drake.planning.waypoints import waypoint_error
from atlas_drake.robot import Robot
from atlas_drake.robot.leg import ANKLE

POLL = 0.1
"""Time between two commands [s]."""
STANDING = 3.0
"""Time before the first waypoint [s]."""
TIME_EACH = 5.0
"""Time for each waypoint [s]."""
RADIUS, AHEAD = 1.0, 0.3
"""Of the disc of the waypoints, and its middle ahead of the start [m]."""
ARM_TIME, ARM_CHANGE, ARM_RANGE = 0.5, 0.12, 0.8
"""Time between two targets of the arms [s]; largest change and range of each [rad]."""
OUTWARD = ("shoulder_roll", "arm_shx", "shoulder_r", "arm_left_2", "arm_right_2")
"""Parts of the names of joints that move an arm away from the trunk, and not back."""
PUNCH_AFTER, PUNCH_TIME = 0.1, 0.08
"""Time of a punch after the start of its waypoint, and its duration [s]."""
PUNCH_FIRST, PUNCH_GROWS = 1.0 / 3.0, 60.0
"""Share of the greatest force at the first waypoint [-]; time in which it grows to all
of it [s]."""
PUNCH_LEAST = 0.5
"""Least share of the force that is the greatest at its time [-]."""
STEERED, BORNE = (1.0, 2.0), 4.0
"""Time of the walk before a single punch, and time after it [s]."""
HOLDS = (0.3, 5.0)
"""Time for which a random velocity is held [s]."""


class Arms:
    """Set-points of the arms that wander around the pose at the start."""

    def __init__(self, sim: AtlasSimulation, random: np.random.Generator):
        robot = sim.robot
        self._start = np.array(robot.stand_prep)
        self._arms = np.flatnonzero(robot.limb("l_arm", "r_arm"))
        self._k_effort = np.zeros(robot.num_joints, dtype=int)
        self._k_effort[self._arms] = K_EFFORT_MAX
        self._random = random
        self._from = self._to = self._start
        self._number = -1
        self._outward = {
            index: 1.0 if robot.limb("l_arm")[index] else -1.0
            for index in self._arms
            if any(part in robot.joint_names[index].lower() for part in OUTWARD)
        }

    def command(self, time: float) -> AtlasCommand:
        """Makes the command of a time [s]."""
        number = int(time / ARM_TIME)
        if number != self._number:
            self._number, self._from, self._to = number, self._to, self._next()
        share = time / ARM_TIME - number
        command = AtlasCommand()
        command.position = self._from + share * (self._to - self._from)
        command.k_effort = self._k_effort
        return command

    def _next(self) -> np.ndarray:
        target = self._to.copy()
        change = self._random.uniform(-ARM_CHANGE, ARM_CHANGE, len(self._arms))
        low, high = (self._start[self._arms] + way * ARM_RANGE for way in (-1.0, 1.0))
        target[self._arms] = np.clip(target[self._arms] + change, low, high)
        for index, sign in self._outward.items():
            away = max(sign * (target[index] - self._start[index]), 0.0)
            target[index] = self._start[index] + sign * away
        return target


class Punch(NamedTuple):
    """A push on a link, a time ``since`` the first waypoint [s]."""

    since: float
    link: str
    force_W: np.ndarray  # [N], shape (3,)


def tour(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Steers over the waypoints.

    Args:
        sim: A robot that stands.
        parameters: ``fastest``, the largest speed asked for [m/s]; ``driven``, whether
            a user moves the arms; ``punch``, the greatest force of a punch over the
            robot's mass [N/kg], 0 for none; ``waypoints``, their number.

    Returns:
        Whether it completed the tour, the ``survival`` since the first waypoint [s],
        errors at the end of each waypoint [m], [rad], and by how much balance moved the
        steps [m].
    """
    random = np.random.default_rng(sim.scenario.seed)
    gait = sim.scenario.controller_config().gait()
    speed, driven = float(parameters["fastest"]), bool(parameters["driven"])
    number = int(parameters["waypoints"])
    arms = Arms(sim, random)
    angle = _turns(random, number)
    far = RADIUS * np.sqrt(random.random(number))
    places = np.stack([AHEAD + far * np.cos(angle), far * np.sin(angle)], axis=1)
    headings = random.uniform(-math.pi, math.pi, number)
    punches = _punches(sim, number, float(parameters["punch"]), random)
    off: list[float] = []
    turned: list[float] = []
    while sim.time < STANDING + number * TIME_EACH and not sim.has_fallen:
        if driven:
            sim.publish(arms.command(sim.time))
        since = sim.time - STANDING + 1e-9
        if since >= 0.0:
            latest = min(int(since / TIME_EACH), number - 1)
            place, yaw = places[latest], headings[latest]
            if since % TIME_EACH >= TIME_EACH - POLL:
                x, y, turn = waypoint_error(sim.pelvis_pose, place.tolist(), yaw)
                off.append(math.hypot(x, y))
                turned.append(abs(turn))
            report, pelvis = sim.atlas_sim_interface_state, sim.pelvis_pose
            sim.publish(walk_to(report, pelvis, place.tolist(), yaw, gait, speed))
            if punches and since >= punches[-1].since:
                punch = punches.pop()
                sim.apply_push(punch.link, punch.force_W, PUNCH_TIME)
        sim.advance(POLL)
    moved = [step["error_m"] for step in sim.footsteps]
    return {
        "completed": not sim.has_fallen,
        "survival": max(sim.time - STANDING, 0.0),
        "off_m": float(np.mean(off)) if off else math.nan,
        "off_rad": float(np.mean(turned)) if turned else math.nan,
        "moved_m": float(np.mean(moved)) if moved else math.nan,
    }


def punched(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Walks at a random velocity, with driven arms, and is punched once.

    Args:
        sim: A robot that stands.
        parameters: ``change``, of the robot's velocity by the punch [m/s]; ``part``, of
            which it hits a link: ``arms``, ``trunk``, ``legs`` down to the knees, or
            ``feet``, which the ankles move; ``aside``, whether it pushes the robot
            straight to a side, or else in any direction.
    """
    random = np.random.default_rng(sim.scenario.seed)
    gait = sim.scenario.controller_config().gait()
    arms = Arms(sim, random)
    low, high = _slowest_and_fastest(gait)
    drawn = random.uniform(low, high)
    velocity = nearest_velocity(*drawn.tolist(), gait=gait)
    link = str(random.choice(_links(sim.robot, str(parameters["part"]))))
    force = sim.robot.mass * float(parameters["change"]) / PUNCH_TIME
    direction = _directions(random, 1)[0]
    punch = STANDING + float(random.uniform(*STEERED))

    def walk(until: float) -> None:
        while sim.time < until and not sim.has_fallen:
            sim.publish(arms.command(sim.time))
            if sim.time >= STANDING:
                sim.publish(
                    walk_at(sim.atlas_sim_interface_state, *velocity, gait=gait)
                )
            sim.advance(POLL)

    walk(punch)
    if parameters["aside"]:
        direction = _aside(sim, direction)
    sim.apply_push(link, force * direction, PUNCH_TIME)
    walk(punch + BORNE)
    return {"stays_up": not sim.has_fallen}


def velocities(sim: AtlasSimulation, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Walks at random velocities of all that ``walk_at`` accepts.

    Args:
        sim: A robot that stands.
        parameters: ``minutes``.
    """
    random = np.random.default_rng(sim.scenario.seed)
    gait = sim.scenario.controller_config().gait()
    low, high = _slowest_and_fastest(gait)
    sim.advance(STANDING)
    velocity, until = nearest_velocity(gait=gait), 0.0
    while sim.time < 60.0 * float(parameters["minutes"]) and not sim.has_fallen:
        if sim.time >= until:
            drawn = random.uniform(low, high)
            # One of the three alone, or all.
            alone = random.integers(0, 4)
            wanted = (
                drawn if alone == 3 else np.where(np.arange(3) == alone, drawn, 0.0)
            )
            velocity = nearest_velocity(*wanted.tolist(), gait=gait)
            until = sim.time + float(random.uniform(*HOLDS))
        sim.publish(walk_at(sim.atlas_sim_interface_state, *velocity, gait=gait))
        sim.advance(POLL)
    return {"stays_up": not sim.has_fallen}


def _punches(
    sim: AtlasSimulation, number: int, greatest: float, random: np.random.Generator
) -> list[Punch]:
    """Draws punches on random links that grow harder, the first one last.

    ``greatest`` is a force over the robot's mass [N/kg]; none for 0.
    """
    if greatest == 0.0:
        return []
    links, since = sim.robot.moved_links, TIME_EACH * np.arange(number)
    direction = _directions(random, number)
    grown = np.minimum(since / PUNCH_GROWS, 1.0)
    ceiling = PUNCH_FIRST + (1.0 - PUNCH_FIRST) * grown
    share = ceiling * random.uniform(PUNCH_LEAST, 1.0, number)
    forces_W = greatest * sim.robot.mass * share[:, None] * direction
    hit = [links[i][0] for i in random.integers(len(links), size=number)]
    return list(map(Punch, (since + PUNCH_AFTER).tolist(), hit, forces_W))[::-1]


def _links(robot: Robot, part: str) -> list[str]:
    """Returns the links of a part of the robot that joints move."""
    legs = robot.limb("l_leg", "r_leg")
    arms = robot.limb("l_arm", "r_arm")
    ankles = np.zeros_like(legs)
    for leg in robot.legs:
        ankles[leg.joints[ANKLE]] = True
    parts = {
        "arms": arms,
        "trunk": ~(legs | arms),
        "legs": legs & ~ankles,
        "feet": ankles,
    }
    return [robot.moved_links[joint][0] for joint in np.flatnonzero(parts[part])]


def _slowest_and_fastest(gait: Gait) -> tuple[np.ndarray, np.ndarray]:
    """Returns the least and the greatest velocities that ``walk_at`` accepts."""
    ahead, back, aside, turn = fastest(gait)
    return np.array([-back, -aside, -turn]), np.array([ahead, aside, turn])


def _directions(random: np.random.Generator, number: int) -> np.ndarray:
    """Draws directions in space, shape (number, 3)."""
    upward, angle = random.uniform(-1.0, 1.0, number), _turns(random, number)
    aside = np.sqrt(1.0 - upward**2)
    return np.stack([aside * np.cos(angle), aside * np.sin(angle), upward], axis=1)


def _aside(sim: AtlasSimulation, direction: np.ndarray) -> np.ndarray:
    """Returns the robot's left or right, horizontal, the nearer to a direction."""
    left = sim.pelvis_pose.rotation().matrix()[:, 1] * [1.0, 1.0, 0.0]
    return math.copysign(1.0, direction @ left) * left / np.linalg.norm(left)


def _turns(random: np.random.Generator, number: int) -> np.ndarray:
    """Draws directions in the plane [rad]."""
    return random.uniform(0.0, 2.0 * math.pi, number)
