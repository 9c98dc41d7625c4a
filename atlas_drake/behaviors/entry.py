"""The entry of a behavior: everything that others need to know to run and show it.

Those that are shipped are in ``shipped``; one of your own is made the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation
from atlas_drake.behaviors.body_reference import BodyRates
from atlas_drake.behaviors.entry_limits import EntryLimits
from atlas_drake.behaviors.freeze import Freeze
from atlas_drake.behaviors.stand.stance_guard import StanceGuard, StandingBehavior
from atlas_drake.bounds import NOT_NEGATIVE
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.errors import ScenarioError, did_you_mean, shown
from atlas_drake.kinds import typed
from atlas_drake.messages import AtlasSimInterfaceCommand, Behavior, BehaviorStatus
from atlas_drake.messages.behavior_catalog import BehaviorError, BehaviorInterface
from atlas_drake.robot import Robot


@dataclass(frozen=True)
class BehaviorTools:
    """What a behavior is built from; constants only.

    Attributes:
        model: Of the robot.
        balance: Gains, support polygons, and the tasks that keep the robot upright.
        nominal_height: Of the center of mass above the soles when standing [m].
        rates: How fast trunk and posture references move.
        entry_limits: When STAND can take over.
        freeze: Holds the pose.
    """

    model: WholeBodyModel
    balance: Balance
    nominal_height: float
    rates: BodyRates
    entry_limits: EntryLimits
    freeze: Freeze

    @property
    def robot(self) -> Robot:
        """Description of the robot."""
        return self.model.robot

    def guarded(self, behavior: StandingBehavior) -> StanceGuard:
        """The behavior, which holds its pose while the user leaves it no leg."""
        return StanceGuard(behavior, self.freeze, self.balance)


@dataclass(frozen=True)
class Transition:
    """A change of behavior that is asked for.

    Attributes:
        source: Entry of the active behavior.
        observation: What the robot measures now.
        tools: Of the behaviors.
        command: That asks.
    """

    source: BehaviorEntry
    observation: Observation
    tools: BehaviorTools
    command: AtlasSimInterfaceCommand


EntryCondition: TypeAlias = "Callable[[Transition], BehaviorStatus | str]"
"""Tells why a behavior cannot begin: a flag or a reason in words; OK or empty if it
can."""


@dataclass(frozen=True, kw_only=True)
class BehaviorEntry(BehaviorInterface):
    """A behavior: how it is asked for, made, entered, left and shown.

    The fields of ``BehaviorInterface`` come first: name, number, params, check,
    caption, color, description.

    Attributes:
        make: The behavior's class, or whatever else returns a ``BehaviorProtocol`` when
            called with (tools: BehaviorTools, config).
        config: Instance of the behavior's configuration dataclass, with the values to
            begin with; None if it has none.
        conditions: All must be met when the behavior is to begin.
        follows: Names of behaviors that it may follow.
        leads_to: Names of behaviors that may follow it, besides itself and those that
            may begin at any time.
        at_any_time: Whether it may follow every other behavior.
        upright: Whether it needs a robot on its feet.
        balanced: Whether the robot balances in it, so that STAND may follow at once.
        ends_in_order: Whether it comes to its own end when STAND is asked for.
        lifts_feet: Whether it lifts feet, and so needs both legs for itself.
        feedback: Field of ``AtlasSimInterfaceState`` that takes its status flags.
    """

    make: Callable[[BehaviorTools, Any], BehaviorProtocol]
    config: Any = None
    conditions: tuple[EntryCondition, ...] = ()
    follows: tuple[str, ...] = ("STAND",)
    leads_to: tuple[str, ...] = ("STAND",)
    at_any_time: bool = False
    upright: bool = True
    balanced: bool = True
    ends_in_order: bool = True
    lifts_feet: bool = False
    feedback: str = ""

    def may_follow(self, source: BehaviorEntry) -> bool:
        """Whether the transition from ``source`` is a legal one."""
        return (
            self.at_any_time
            or self.name == source.name
            or self.name in source.leads_to
            or source.name in self.follows
        )


def configured(
    entries: Iterable[BehaviorEntry], settings: Mapping[str, Any]
) -> tuple[BehaviorEntry, ...]:
    """Return the entries with the configurations that a scenario gives them.

    Shipped behaviors are configured by fields of ``ControllerConfig`` of their own.

    Args:
        entries: Of registered behaviors; shipped ones stay as they are.
        settings: Some fields of configurations, as from YAML, by name of the behavior.

    Raises:
        ScenarioError: Naming the first field that cannot be used.
    """
    made = tuple(entries)
    if not settings:
        return made
    shipped = Behavior.__members__
    own = {entry.name: entry for entry in made if entry.name not in shipped}
    for name, fields in settings.items():
        path = f"controller.behaviors.{name}"
        if name not in own:
            hint = did_you_mean(name, own) or f" There are {', '.join(own) or 'none'}."
            problem = f"no behavior {name} is registered.{hint}"
            raise ScenarioError(path, fields, problem)
        config = own[name].config
        if config is None:
            raise ScenarioError(path, fields, f"{name} has no configuration")
        config = typed(
            fields,
            type(config),
            path,
            default=config,
            bounds=NOT_NEGATIVE,
            from_text=True,
        )
        own[name] = replace(own[name], config=config)
    return tuple(own.get(entry.name, entry) for entry in made)


def legal_transitions(
    entries: Iterable[BehaviorEntry],
) -> dict[str, frozenset[str]]:
    """From the name of each behavior to the names of those that may follow it."""
    known = tuple(entries)
    return {
        source.name: frozenset(t.name for t in known if t.may_follow(source))
        for source in known
    }


def refusal(target: BehaviorEntry, asked: Transition) -> tuple[BehaviorStatus, str]:
    """Why a behavior cannot begin now.

    Args:
        target: Entry of the behavior asked for.
        asked: The transition.

    Returns:
        The flag for the feedback, OK if the behavior can begin, and a reason in words,
        which may be empty.

    Raises:
        BehaviorError: If a condition answers anything else.
    """
    if not target.may_follow(asked.source):
        return BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR, ""
    for condition in target.conditions:
        answer = condition(asked)
        if isinstance(answer, str):
            if answer:
                return BehaviorStatus.FAILED_TRANS_ILLEGAL_BEHAVIOR, answer
        elif not isinstance(answer, BehaviorStatus):
            raise BehaviorError(
                f"a condition of {target.name} must return a reason in words or a "
                f"BehaviorStatus, returned {shown(answer)}"
            )
        elif answer is not BehaviorStatus.OK:
            return answer, ""
    return BehaviorStatus.OK, ""
