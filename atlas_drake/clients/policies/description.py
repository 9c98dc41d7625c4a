"""What a policy's network observes and commands, as data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from annotated_types import Len, Unit

from atlas_drake.config import Configuration, NotNegative, Positive
from atlas_drake.errors import ScenarioError
from atlas_drake.units import (
    NewtonMeters,
    NewtonMeterSecondsPerRadian,
    NewtonMetersPerRadian,
    Radians,
    Ratio,
    Seconds,
)

OVERLAY = ("armature", "damping", "effort_limit")
"""Fields that change the simulated robot to the one of the training."""
KilogramMetersSquared = Annotated[float, Unit("kg·m²")]
Scales = Annotated[list[Ratio], Len(1)]
"""One number for all elements, or one for each."""


@dataclass(frozen=True, kw_only=True)
class ObservationTerm(Configuration):
    """One term of the observation."""

    name: str
    """Name of the term, such as ``joint_pos``."""
    scale: Scales
    """Factors of its elements."""
    history: Positive[int] = 1
    """Number of its latest values that the network sees, oldest first."""


@dataclass(frozen=True, kw_only=True)
class PolicyDescription(Configuration):
    """A policy: its network, and what its numbers mean. Arrays are in its own order."""

    network: str
    """ONNX file, from the description's folder."""
    joints: Annotated[list[str], Len(1)]
    """Joints that the policy commands, in its own order."""
    position: list[Radians]
    """Their default position, from which observation and action count."""
    kp: list[NotNegative[NewtonMetersPerRadian]]
    """Gains of their position."""
    kd: list[NotNegative[NewtonMeterSecondsPerRadian]]
    """Damping."""
    action_scale: Scales
    """Set-point from the default position, per unit of the action [rad]."""
    observation: Annotated[list[ObservationTerm], Len(1)]
    """Terms of the observation, in their order."""
    armature: list[NotNegative[KilogramMetersSquared]] = field(default_factory=list)
    """Inertia of their rotors at the joint, as in training; empty as the robot has it.
    """
    damping: list[NotNegative[NewtonMeterSecondsPerRadian]] = field(
        default_factory=list
    )
    """Damping of the joints themselves, likewise."""
    effort_limit: list[Positive[NewtonMeters]] = field(default_factory=list)
    """Largest efforts of their motors, likewise; none above the robot's counts."""
    period: Positive[Seconds] = 0.02
    """Time between two actions."""
    gait_period: Positive[Seconds] = 0.8
    """Period of the term ``phase``."""

    def check(self) -> None:
        """Checks that every joint has its values."""
        count = len(self.joints)
        for name in ("position", "kp", "kd", *OVERLAY):
            given = len(getattr(self, name))
            if given != count and (given or name not in OVERLAY):
                problem = f"has {given} values, and joints has {count}"
                raise ScenarioError(name, getattr(self, name), problem)
        if len(self.action_scale) not in (1, count):
            problem = f"has {len(self.action_scale)} values, not 1 or {count}"
            raise ScenarioError("action_scale", self.action_scale, problem)
        for index, name in enumerate(self.joints):
            if name in self.joints[:index]:
                problem = f"names {name} twice"
                raise ScenarioError(f"joints[{index}]", name, problem)
