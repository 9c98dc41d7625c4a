"""Who walks the robot, a policy or WALK, and what becomes of it, as a trial.

A policy is that of the scenario (``--policy``); without one, WALK walks. At a moment of
the walk comes a push, and perhaps the end: STAND takes over, or the policy dies and its
watchdog has to notice. The limits are in ``users.yaml``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    nearest_velocity,
    walk_at,
)
from atlas_drake.clients.policies.joining import RunningPolicy, policy_of
from atlas_drake.errors import ScenarioError

STEERED = 0.1
"""Time between two commands of a walk [s]."""
LOOK = 0.02
"""Time between two looks of a guard, and at the robot [s]."""
PUSH_DURATION = 0.1
"""[s]"""
WATCHED = 6.0
"""Time after the moment until which the robot is watched [s]."""
QUIET = 0.04
"""Largest speed of the CoM of a robot at rest [m/s]."""
ENDS = ("none", "stand", "manipulate", "walk", "dies")


def used(
    sim: AtlasSimulation, parameters: Mapping[str, Any]
) -> dict[str, bool | float]:
    """Walks, and pushes, takes over or kills the user at a moment.

    Args:
        sim: A robot that stands; with the scenario's policy, if it has one.
        parameters: ``speed`` asked for [m/s]; ``moment`` [s]; ``push``, a change of
            the robot's velocity then [m/s], and its ``direction`` [rad]; ``end``, what
            else comes then: ``none``, ``stand``, ``manipulate`` or ``walk`` (that
            behavior takes all joints; WALK goes on at the same speed), or ``dies``
            (the policy falls silent); ``guard``, a tilt of the pelvis at which STAND
            takes over [rad], 0 for none.

    Returns:
        Whether the robot is ``up`` after ``WATCHED``, whether it stood before the
        moment, whether STAND or a guard has taken over, and the time until it is
        ``quiet`` in STAND [s], if it is.
    """
    speed, moment = float(parameters["speed"]), float(parameters["moment"])
    guard, end = float(parameters["guard"]), str(parameters["end"])
    if end not in ENDS:
        raise ScenarioError("parameters.end", end, f"must be one of {', '.join(ENDS)}")
    policy = policy_of(sim)
    if policy is not None:
        policy.steer((speed, 0.0, 0.0))
    walks = True
    while sim.time < moment - 1e-9 and not sim.has_fallen:
        _walk_on(sim, policy, speed)
        sim.advance_to(min(sim.time + STEERED, moment))
    before = not sim.has_fallen
    _push(sim, float(parameters["push"]), float(parameters["direction"]))
    if end == "walk":
        policy = None
    elif end in ("stand", "manipulate"):
        walks = False
        _take_over(sim, Behavior[end.upper()])
    elif end == "dies":
        walks = False
        if policy is None:
            raise ScenarioError("parameters.end", end, "needs --policy")
        policy.stop()
    taken, next_command = False, sim.time
    result: dict[str, bool | float] = {}
    while sim.time < moment + WATCHED - 1e-9 and not sim.has_fallen:
        if walks and sim.time >= next_command - 1e-9:
            _walk_on(sim, policy, speed)
            next_command += STEERED
        if walks and guard and _tilt(sim) > guard:
            walks, taken = False, True
            _take_over(sim, Behavior.STAND)
        sim.advance(LOOK)
        moves = float(np.linalg.norm(sim.record.balance.com_velocity))
        rests = sim.current_behavior is Behavior.STAND and moves < QUIET
        if rests and not walks:
            result.setdefault("quiet", sim.time - moment)
    up = before and not sim.has_fallen
    return {"up": up, "walked": before, "taken": taken, **result}


def _walk_on(sim: AtlasSimulation, policy: RunningPolicy | None, speed: float) -> None:
    if policy is None:
        gait = sim.scenario.controller_config().gait()
        velocity = nearest_velocity(forward=speed, gait=gait)
        command = walk_at(sim.atlas_sim_interface_state, *velocity, gait=gait)
        if command is not None:
            sim.publish(replace(command, k_effort=[0] * sim.robot.num_joints))


def _take_over(sim: AtlasSimulation, behavior: Behavior) -> None:
    none = [0] * sim.robot.num_joints
    sim.publish(AtlasSimInterfaceCommand(behavior=behavior, k_effort=none))


def _push(sim: AtlasSimulation, size: float, direction: float) -> None:
    if size:
        force = size * sim.robot.mass / PUSH_DURATION
        force_W = [force * math.cos(direction), force * math.sin(direction), 0.0]
        sim.apply_push("trunk", force_W, PUSH_DURATION)


def _tilt(sim: AtlasSimulation) -> float:
    """Returns the angle of the pelvis' axis from the vertical [rad]."""
    up = float(sim.pelvis_pose.rotation().matrix()[2, 2])
    return math.acos(min(up, 1.0))
