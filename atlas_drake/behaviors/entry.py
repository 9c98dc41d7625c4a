"""The entry of a behavior: everything that is needed to run and show it.

``atlas_drake.shipped`` lists the shipped ones; one of your own is made the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, TypeAlias

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation
from atlas_drake.behaviors.body_reference import BodyRates
from atlas_drake.behaviors.freeze import Freeze
from atlas_drake.behaviors.recovery import Recovery
from atlas_drake.behaviors.stand.stance_guard import StanceGuard
from atlas_drake.behaviors.stand.stand import Pose, Stand, StandConfig
from atlas_drake.config import Configuration, NotNegative
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.messages import AtlasSimInterfaceCommand, Behavior, BehaviorStatus
from atlas_drake.messages.behavior_catalog import (
    SHIPPED,
    BehaviorInterface,
)
from atlas_drake.planning.footholds import Gait
from atlas_drake.robot import Robot
from atlas_drake.units import Meters, RadiansPerSecond


@dataclass(frozen=True)
class EntryLimits(Configuration):
    """Limits within which STAND can take over."""

    com_inside: NotNegative[Meters] = 0.01
    """Least distance of the CoM from the edge of the support polygon, inside it."""
    dcm_inside: NotNegative[Meters] = 0.03
    """Least distance of the DCM from the edge of the support polygon, inside it, where
    no step may be taken."""
    dcm_outside: NotNegative[Meters] = 0.15
    """Largest distance of the DCM from the support polygon, outside it, from which
    steps bring the robot to rest."""
    joint_speed: NotNegative[RadiansPerSecond] = 4.0
    """Largest speed of any joint that STAND takes over; of a leg only where it may not
    step."""


@dataclass(frozen=True)
class BehaviorTools:
    """Parts that behaviors are built from; constants only.

    Attributes:
        model: Model of the robot.
        balance: Gains, support polygons, and the tasks that keep the robot upright.
        nominal_height: Height of the center of mass above the soles when standing [m].
        rates: Speed limits of the reference of trunk and posture.
        entry_limits: Conditions under which STAND can take over.
        freeze: The behavior that holds the pose.
        gait: Gait of demonstrations.
        stand_config: Parameters of STAND.
    """

    model: WholeBodyModel
    balance: Balance
    nominal_height: float
    rates: BodyRates
    entry_limits: EntryLimits
    freeze: Freeze
    gait: Gait
    stand_config: StandConfig

    @property
    def robot(self) -> Robot:
        """Description of the robot."""
        return self.model.robot

    @cached_property
    def recovery(self) -> Recovery:
        """Determines when the standing robot may step, and when it has to."""
        return Recovery(self.balance, self.stand_config)

    def stand(self, pose: Pose | None = None) -> StanceGuard:
        """Returns STAND, whose target of trunk and posture ``pose`` changes.

        The stance guard holds the pose while the user controls both legs.

        Args:
            pose: Returns the target from (upright, observation, request, leaving), at
                each tick. When STAND is requested, it goes on only until the trunk is
                as upright as STAND has it: STAND brings height and joints home.
        """
        stand = Stand(
            self.balance, self.nominal_height, self.rates, self.stand_config, pose
        )
        return self.guarded(stand)

    def guarded(self, behavior: BehaviorProtocol) -> StanceGuard:
        """Adds the stance guard, which holds the pose while the user has both legs."""
        return StanceGuard(behavior, self.freeze, self.balance)


@dataclass(frozen=True)
class Transition:
    """A requested change of behavior.

    Attributes:
        source: Entry of the active behavior.
        observation: Present observation of the robot.
        tools: Parts that behaviors are built from.
        command: The command that requests the change.
    """

    source: BehaviorEntry
    observation: Observation
    tools: BehaviorTools
    command: AtlasSimInterfaceCommand


EntryCondition: TypeAlias = "Callable[[Transition], BehaviorStatus | str]"
"""Returns why a behavior cannot begin, as a flag or a reason in words; OK or an empty
string if it can."""


_NEEDS = {
    BehaviorStatus.FAILED_TRANS_COM_POS: "the weight over the feet: FREEZE first, or "
    "reset",
    BehaviorStatus.FAILED_TRANS_COM_VEL: "a robot that does not sway: FREEZE first, or "
    "wait",
    BehaviorStatus.FAILED_TRANS_VEL: "joints at rest: FREEZE first, or wait",
}
"""What a behavior needs, and what to do, by the flag of its refusal."""


@dataclass(frozen=True, kw_only=True)
class BehaviorEntry(BehaviorInterface):
    """A behavior: how it is requested, made, entered, left and shown.

    The fields of ``BehaviorInterface`` come first: name, number, params, check, color,
    description.

    Attributes:
        make: The behavior's class, or another callable with the arguments
            (tools: BehaviorTools, config) that returns a ``BehaviorProtocol``.
        config: Instance of the behavior's configuration dataclass, with the default
            values; None if the behavior has no configuration.
        config_field: Field of ``ControllerConfig`` with the configuration; empty means
            the name in lower case. Behaviors can share a field.
        conditions: Conditions that must all be met when the behavior begins.
        follows: Names of behaviors that this behavior may follow.
        leads_to: Names of behaviors that may follow this behavior, besides itself and
            those that may begin at any time.
        at_any_time: True if the behavior may follow every other behavior.
        upright: True if the behavior needs a robot on its feet.
        balanced: True if the behavior balances the robot, so that STAND may follow at
            once.
        ends_in_order: True if the behavior comes to an orderly end when STAND is
            requested.
        lifts_feet: True if the behavior lifts feet, and so needs both legs.
        recovers: True if WALK takes over when only a step keeps the balance.
    """

    make: Callable[[BehaviorTools, Any], BehaviorProtocol]
    config: Any = None
    config_field: str = ""
    conditions: tuple[EntryCondition, ...] = ()
    follows: tuple[str, ...] = ("STAND",)
    leads_to: tuple[str, ...] = ("STAND",)
    at_any_time: bool = False
    upright: bool = True
    balanced: bool = True
    ends_in_order: bool = True
    lifts_feet: bool = False
    recovers: bool = False

    @property
    def configured_at(self) -> str:
        """Field of ``ControllerConfig`` with the behavior's configuration."""
        return self.config_field or self.name.lower()

    def may_follow(self, source: BehaviorEntry) -> bool:
        """True if the transition from ``source`` is legal."""
        return (
            self.at_any_time
            or self.name == source.name
            or self.name in source.leads_to
            or source.name in self.follows
        )

    def refusal_in_words(
        self,
        why: BehaviorStatus,
        source: BehaviorEntry,
        entries: Iterable[BehaviorInterface],
    ) -> str:
        """Says why this behavior cannot follow ``source``, and what to do.

        Args:
            why: The flag of the refusal.
            source: The active behavior.
            entries: All behaviors.
        """
        if why in _NEEDS:
            return f"{self.name} needs {_NEEDS[why]}"
        before = [
            one.name
            for one in entries
            if isinstance(one, BehaviorEntry)
            and one is not self
            and self.may_follow(one)
        ]
        names = " or ".join(before) or "no other behavior"
        return f"{self.name} may follow {names}, not {source.name}"


def entry_of(behavior: Behavior, **how: Any) -> BehaviorEntry:
    """Makes the entry of a behavior of the original interface.

    Args:
        behavior: Its name, number, parameters, color and description are known.
        **how: The other fields of the entry.
    """
    interface = SHIPPED.entry(behavior)
    shared = {field.name: getattr(interface, field.name) for field in fields(interface)}
    return BehaviorEntry(**shared, **how)


def legal_transitions(entries: Iterable[BehaviorEntry]) -> dict[str, frozenset[str]]:
    """Maps the name of each behavior to the names of those that may follow it."""
    known = tuple(entries)
    return {
        source.name: frozenset(t.name for t in known if t.may_follow(source))
        for source in known
    }


def refusal(target: BehaviorEntry, asked: Transition) -> tuple[BehaviorStatus, str]:
    """Returns why a behavior cannot begin now: a flag, OK if it can, and words."""
    if not target.may_follow(asked.source):
        return BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR, ""
    for condition in target.conditions:
        answer = condition(asked)
        if isinstance(answer, str):
            if answer:
                return BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR, answer
        elif answer is not BehaviorStatus.OK:
            return answer, ""
    return BehaviorStatus.OK, ""
