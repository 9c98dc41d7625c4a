"""Joins the policy that a scenario names to a simulation, and steers it there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JointActuatorIndex
from pydrake.systems.framework import Diagram, DiagramBuilder

from atlas_drake.clients.policies import policy_user, watchdog
from atlas_drake.clients.policies.description import OVERLAY, PolicyDescription
from atlas_drake.clients.policies.policy_user import PolicyUser, add_policy
from atlas_drake.clients.policies.reading import read_policy
from atlas_drake.clients.policies.watchdog import Watchdog, add_watchdog
from atlas_drake.errors import ScenarioError
from atlas_drake.messages.event import Event
from atlas_drake.robot import Robot
from atlas_drake.scenario.policy_use import PolicyUse
from atlas_drake.simulation import AtlasSimulation
from atlas_drake.simulation.sockets import Extend, WorldMaker


def policy_parts(use: PolicyUse, robot: Robot) -> tuple[Extend, list[WorldMaker]]:
    """Returns what adds a policy and its watchdog, and what overlays the robot.

    The watchdog may be off; there may be nothing to overlay.

    Raises:
        ScenarioError: Naming file and field, if the policy cannot be used.
        AtlasError: If onnxruntime is not installed.
    """
    try:
        policy = read_policy(use.file, use.joints or None)
        user = PolicyUser(
            policy,
            robot,
            velocity=use.velocity,
            fastest=use.fastest,
            start=use.start,
        )
    except ScenarioError as error:
        raise error.within("policy") from None

    def extend(builder: DiagramBuilder, station: Diagram) -> None:
        add_policy(builder, station, user)
        dog = Watchdog(robot, policy.description.period, watches=use.watchdog)
        add_watchdog(builder, station, dog, user)

    description = policy.description
    overlaid = any(getattr(description, name) for name in OVERLAY)
    return extend, [overlay(description, robot)] if overlaid else []


def overlay(description: PolicyDescription, robot: Robot) -> WorldMaker:
    """Returns what makes the simulated robot that of a policy's training."""
    place = {name: index for index, name in enumerate(description.joints)}

    def change(plant: MultibodyPlant) -> None:
        own = robot.instance(plant)
        # Before Finalize a plant does not tell the motors of a model.
        for number in map(JointActuatorIndex, range(plant.num_actuators())):
            motor = plant.get_joint_actuator(number)
            joint: Any = motor.joint()
            index = place.get(joint.name())
            if index is None or motor.model_instance() != own:
                continue
            if description.armature:
                motor.set_default_gear_ratio(1.0)
                motor.set_default_rotor_inertia(description.armature[index])
            if description.damping:
                joint.set_default_damping(description.damping[index])
            if description.effort_limit:
                least = min(description.effort_limit[index], motor.effort_limit())
                motor.set_effort_limit(least)

    return change


class RunningPolicy:
    """The policy of a simulation, for whoever steers it.

    Attributes:
        user: Its system.
    """

    def __init__(self, sim: AtlasSimulation) -> None:
        """Finds the policy of a simulation that has one."""
        self._sim = sim
        self.user: PolicyUser = self._system(policy_user.SYSTEM)
        self._dog: Watchdog | None = None
        if sim.diagram.HasSubsystemNamed(watchdog.SYSTEM):
            self._dog = self._system(watchdog.SYSTEM)

    @property
    def runs(self) -> bool:
        """True while the joints are the policy's."""
        return self.user.runs(self._context(self.user))

    @property
    def velocity(self) -> np.ndarray:
        """Desired velocity: ahead, left [m/s], turn [rad/s], shape (3,)."""
        return self.user.velocity(self._context(self.user))

    @property
    def is_watched(self) -> bool:
        """True if a watchdog takes joints back from it."""
        return self._dog is not None and self._dog.watches(self._context(self._dog))

    @property
    def events(self) -> list[Event]:
        """The latest event of the policy, and of its watchdog."""
        found = [self.user.ended(self._context(self.user))]
        if self._dog is not None:
            found.append(self._dog.barked(self._context(self._dog)))
        return [event for event in found if event is not None]

    def steer(self, velocity: Sequence[float] | np.ndarray) -> None:
        """Sets the desired velocity."""
        self.user.steer(self._context(self.user), velocity)

    def take(self) -> None:
        """Lets the policy take its joints, with an empty memory."""
        self.user.take(self._context(self.user))

    def stop(self) -> None:
        """Lets the policy say nothing more, as if it had died."""
        self.user.stop(self._context(self.user), "it is stopped")

    def watch(self, on: bool) -> None:
        """Switches its watchdog, if it has one."""
        if self._dog is not None:
            self._dog.watch(self._context(self._dog), on)

    def _system(self, name: str) -> Any:
        return self._sim.diagram.GetSubsystemByName(name)

    def _context(self, system: Any) -> Any:
        return system.GetMyMutableContextFromRoot(self._sim.context)


def policy_of(sim: AtlasSimulation) -> RunningPolicy | None:
    """Returns the policy of a simulation; None if it has none."""
    has_policy = sim.diagram.HasSubsystemNamed(policy_user.SYSTEM)
    return RunningPolicy(sim) if has_policy else None
