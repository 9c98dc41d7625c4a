"""State of the supervisor from one tick to the next, in frozen parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from atlas_drake.behaviors.body_reference import BodyReference
from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import replace
from atlas_drake.messages import Behavior, BehaviorStatus
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import KEPT_EVENTS
from atlas_drake.messages.event import Event, append_recent


@dataclass(frozen=True)
class Starting:
    """The initial behavior before the first tick.

    Attributes:
        behavior: The behavior.
    """

    behavior: Behavior


@dataclass(frozen=True)
class Waiting:
    """A behavior that is entered at its first tick.

    Attributes:
        behavior: The behavior.
        request: Last request for the behavior: the one that started it, or a later one
            for the same behavior.
        body: Reference of trunk and posture.
    """

    behavior: Behavior
    request: BehaviorRequest
    body: BodyReference


@dataclass(frozen=True)
class Running:
    """A behavior after its first tick.

    Attributes:
        behavior: The behavior.
        request: Last request for the behavior.
        body: Reference of trunk and posture.
        state: State of the behavior.
        flags: The behavior's own flags, latched.
        warned: True after the warning about steps with leg joints under user control.
    """

    behavior: Behavior
    request: BehaviorRequest
    body: BodyReference
    state: Any
    flags: int = 0
    warned: bool = False


@dataclass(frozen=True)
class LastTransition:
    """The last transition, accepted or refused, as the feedback reports it.

    Attributes:
        source: Behavior before the transition.
        target: Behavior after the transition.
        status: Flags of the transition.
    """

    source: Behavior = Behavior.NONE
    target: Behavior = Behavior.NONE
    status: BehaviorStatus = BehaviorStatus.OK


@dataclass(frozen=True)
class SupervisorState:
    """State of supervisor and behaviors.

    Attributes:
        active: The active behavior.
        desired: Requested behavior; differs from the active one during a transition.
        last: The last transition.
        request: The last handled request, accepted or refused; None before the first
            tick.
        error_code: Error code of the last request.
        falling: True from a detected fall until a behavior begins in a posture that is
            not that of a fall.
        events: The latest events.
        event_count: Number of events so far.
    """

    active: Starting | Waiting | Running
    desired: Behavior
    last: LastTransition = LastTransition()
    request: BehaviorRequest | None = None
    error_code: ErrorCode = ErrorCode.NO_ERRORS
    falling: bool = False
    events: tuple[Event, ...] = ()
    event_count: int = 0

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
