"""State of the supervisor from one tick to the next, in frozen parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.control.balance.foothold import WHOLE, Foothold
from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import replace
from atlas_drake.messages import Behavior, BehaviorStatus
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import KEPT_EVENTS
from atlas_drake.messages.event import Event, append_recent


@dataclass(frozen=True)
class Starting:
    """The initial behavior before the first tick."""

    behavior: Behavior


@dataclass(frozen=True)
class Waiting:
    """A behavior that is entered at its first tick."""

    behavior: Behavior
    request: BehaviorRequest  # The one that started the behavior, or a later one
    body: BodyReference  # Reference of trunk and posture


@dataclass(frozen=True)
class Running:
    """A behavior after its first tick."""

    behavior: Behavior
    request: BehaviorRequest  # Last request for the behavior
    body: BodyReference  # Reference of trunk and posture
    state: Any
    flags: int = 0  # The behavior's own flags, latched
    warned: bool = False  # After the warning of leg joints under user control


@dataclass(frozen=True)
class LastTransition:
    """The last transition, accepted or refused, as the feedback reports it."""

    source: Behavior = Behavior.NONE  # Behavior before the transition
    target: Behavior = Behavior.NONE  # Behavior after the transition
    status: BehaviorStatus = BehaviorStatus.OK  # Flags of the transition


@dataclass(frozen=True)
class SupervisorState:
    """State of supervisor and behaviors."""

    active: Starting | Waiting | Running  # The active behavior
    desired: Behavior  # Requested behavior; not the active one in a transition
    last: LastTransition = LastTransition()  # The last transition
    request: BehaviorRequest | None = None  # Last one handled; None at first
    error_code: ErrorCode = ErrorCode.NO_ERRORS  # Error code of the last request
    footholds: tuple[Foothold, Foothold] = (WHOLE, WHOLE)  # What of each sole carries
    falling: bool = False  # Until a behavior begins in a posture that is no fall
    events: tuple[Event, ...] = ()  # The latest events
    event_count: int = 0  # Number of events so far

    @property
    def current(self) -> Behavior:
        """The active behavior."""
        return self.active.behavior

    @property
    def has_begun(self) -> bool:
        """True after the first tick."""
        return not isinstance(self.active, Starting)

    @property
    def in_damping_mode(self) -> bool:
        """True if the robot falls in a behavior, and its joints are only damped."""
        return self.falling and self.current not in (Behavior.NONE, Behavior.USER)

    def with_event(self, event: Event) -> SupervisorState:
        """Returns the state with one more event."""
        return replace(
            self,
            events=append_recent(self.events, event, KEPT_EVENTS),
            event_count=self.event_count + 1,
        )
