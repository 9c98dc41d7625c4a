"""Joins the policy that a scenario names, and tells what became of it."""

from __future__ import annotations

from typing import Any

from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.clients.policies import policy_user, watchdog
from atlas_drake.clients.policies.policy_user import PolicyUser, add_policy
from atlas_drake.clients.policies.reading import read_policy
from atlas_drake.clients.policies.watchdog import Watchdog, add_watchdog
from atlas_drake.errors import ScenarioError
from atlas_drake.messages.event import Event
from atlas_drake.robot import Robot
from atlas_drake.scenario.policy_use import PolicyUse
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.simulation.sockets import Extend


def policy_extension(use: PolicyUse, robot: Robot) -> Extend:
    """Returns what adds a policy, and its watchdog if one is asked for.

    Raises:
        ScenarioError: Naming file and field, if the policy cannot be used.
        AtlasError: If onnxruntime is not installed.
    """
    try:
        policy = read_policy(use.file, use.joints or None)
        user = PolicyUser(policy, robot, velocity=use.velocity, start=use.start)
    except ScenarioError as error:
        raise error.within("policy") from None

    def extend(builder: DiagramBuilder, station: Diagram) -> None:
        add_policy(builder, station, user)
        if use.watchdog:
            dog = Watchdog(robot, policy.description.period)
            add_watchdog(builder, station, dog, user)

    return extend


def policy_events(sim: AtlasSimulation) -> list[Event]:
    """Returns the latest events of a run's policy and its watchdog."""
    ways = ((policy_user.SYSTEM, PolicyUser.ended), (watchdog.SYSTEM, Watchdog.barked))
    found = []
    for name, latest in ways:
        if sim.diagram.HasSubsystemNamed(name):
            system: Any = sim.diagram.GetSubsystemByName(name)
            found.append(latest(system, system.GetMyContextFromRoot(sim.context)))
    return [event for event in found if event is not None]
