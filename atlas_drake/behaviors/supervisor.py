"""Runs the active behavior and changes it on request, by itself, or after a fall.

The supervisor's state is one frozen value; the objects here hold constants only. The
legal transitions of a behavior are in its ``entry``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation, Outcome
from atlas_drake.behaviors.body_reference import BodyReference, capture_body
from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import (
    BehaviorEntry,
    BehaviorTools,
    Transition,
    refusal,
)
from atlas_drake.behaviors.fall import posture_of, sign_of_fall
from atlas_drake.behaviors.freeze import Freeze
from atlas_drake.behaviors.shipped import SHIPPED_ENTRIES
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.errors import ErrorCode, shown
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages import AtlasBehaviorFeedback, Behavior, BehaviorStatus
from atlas_drake.messages.behavior_catalog import BehaviorError
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import (
    KEPT_EVENTS,
    ControllerStatus,
    Plan,
    PlannedPaths,
)
from atlas_drake.messages.event import Event
from atlas_drake.messages.recent import append_recent

_Planned = TypeVar("_Planned", Plan, PlannedPaths)


@dataclass(frozen=True)
class SupervisorState:
    """State of supervisor and behaviors from one tick to the next.

    Attributes:
        current: Active behavior.
        desired: Requested behavior; differs from ``current`` during a transition.
        behavior_state: State of the active behavior; None before its first tick.
        entered: True after the active behavior's first tick.
        body: Reference of trunk and posture; None before the first tick.
        request_number: Number of the last handled request, accepted or refused.
        request: Last request for the active behavior: the one that started it, or a
            later one for the same behavior; None before the first tick.
        status: Flags of the last transition.
        trans_from: Behavior before the last transition.
        trans_to: Behavior after the last transition.
        behavior_flags: The active behavior's own flags, latched.
        error_code: Error code of the last request.
        warned: True after the warning about steps with leg joints under user control.
        falling: True from a detected fall until a behavior begins in a posture that is
            not that of a fall.
        events: The latest events.
        event_count: Number of events so far.
    """

    current: Behavior
    desired: Behavior
    behavior_state: Any = None
    entered: bool = False
    body: BodyReference | None = None
    request_number: int = 0
    request: BehaviorRequest | None = None
    status: BehaviorStatus = BehaviorStatus.OK
    trans_from: Behavior = Behavior.NONE
    trans_to: Behavior = Behavior.NONE
    behavior_flags: int = 0
    error_code: ErrorCode = ErrorCode.NO_ERRORS
    warned: bool = False
    falling: bool = False
    events: tuple[Event, ...] = ()
    event_count: int = 0

    @property
    def in_damping_mode(self) -> bool:
        """True if the robot falls in a behavior, and its joints are only damped."""
        return self.falling and self.current not in (Behavior.NONE, Behavior.USER)


class Supervisor:
    """Runs the active behavior; holds one object per behavior.

    Attributes:
        behaviors: The object of each behavior.
    """

    def __init__(
        self,
        model: WholeBodyModel,
        config: ControllerConfig,
        nominal_height: float,
        entries: Iterable[BehaviorEntry] = SHIPPED_ENTRIES,
    ):
        """Makes the behaviors of all entries.

        Args:
            model: Model of the robot.
            config: Parameters of the behaviors.
            nominal_height: Height of the center of mass above the soles when standing
                [m].
            entries: Entries of the behaviors.
        """
        robot = model.robot
        balance = Balance(robot, config.gains, config.stance)
        self._tools = BehaviorTools(
            model,
            balance,
            nominal_height,
            config.body,
            config.entry,
            Freeze(balance, config.freeze),
            config.gait(),
        )
        self._fall_limits = config.fall
        self._legs = np.flatnonzero(robot.limb("l_leg", "r_leg"))
        self._entries = {entry.behavior: entry for entry in entries}
        shipped = config.of_behaviors
        self.behaviors: dict[Behavior, BehaviorProtocol] = {
            behavior: _made(entry, self._tools, shipped.get(entry.name, entry.config))
            for behavior, entry in self._entries.items()
        }

    def start(self, behavior: Behavior) -> SupervisorState:
        """Returns the state before the first tick, with ``behavior`` active."""
        return SupervisorState(current=behavior, desired=behavior)

    def restart(self, state: SupervisorState, behavior: Behavior) -> SupervisorState:
        """Returns the state of a new start that keeps the events so far."""
        return replace(
            self.start(behavior), events=state.events, event_count=state.event_count
        )

    def update(
        self,
        state: SupervisorState,
        observation: Observation,
        requests: Sequence[BehaviorRequest],
    ) -> tuple[SupervisorState, WholeBodyCommand | None]:
        """Computes one tick.

        Args:
            state: State after the last tick.
            observation: Present observation of the robot.
            requests: The latest requests, at least one, oldest first; those that came
                since the last tick are handled in their order.

        Returns:
            The next state, and the command for the whole-body QP; None when no
            behavior acts.
        """
        if state.body is None:
            body = read_only(capture_body(observation.terms))
            state = replace(state, body=body, request=requests[0])
        state = self._watch_for_fall(state, observation)
        if requests[-1].number != state.request_number:
            for new in requests:
                if new.number > state.request_number:
                    state = self._take_request(state, observation, new)
        if state.in_damping_mode:
            # No behavior acts or reports while the joints are only damped.
            body = read_only(capture_body(observation.terms))
            return replace(state, body=body), None
        request = state.request
        assert request is not None
        if not state.entered:
            state = self._enter(state, observation, request)

        if self._entries[state.current].lifts_feet and not state.warned:
            state = self._warn_of_user_legs(state, observation)
        assert state.body is not None
        behavior = self.behaviors[state.current]
        outcome = behavior.update(
            state.behavior_state,
            observation,
            state.body,
            request,
            leaving=state.desired != state.current,
        )
        _check_outcome(outcome, state.current)
        state = replace(
            state,
            behavior_state=read_only(outcome.state, state.behavior_state),
            body=read_only(outcome.body, state.body),
            behavior_flags=_latch(state.behavior_flags, outcome.status_flags),
        )
        for event in outcome.events:
            state = _log(state, event)
        if outcome.finished:
            asked = state.desired is not state.current
            status = (
                BehaviorStatus.TRANSITION_SUCCESS
                if asked
                else BehaviorStatus.WARNING_AUTO_TRANS
            )
            state = self._change(state, observation, Behavior.STAND, status)
        return state, None if state.falling else outcome.command

    def status(
        self, state: SupervisorState, com: np.ndarray, omega: float
    ) -> ControllerStatus:
        """Returns the status of the behaviors; it says nothing of the QP.

        Args:
            state: State after the last tick.
            com: Center of mass at that tick, horizontal in W [m], shape (2,).
            omega: Natural frequency of the pendulum at that tick [1/s].
        """
        falling = BehaviorStatus.ERROR_FALLING if state.falling else BehaviorStatus.OK
        return ControllerStatus(
            current_behavior=state.current,
            desired_behavior=state.desired,
            error_code=state.error_code,
            behavior_feedback=AtlasBehaviorFeedback(
                state.status | falling, state.trans_from, state.trans_to
            ),
            feedback=None
            if state.behavior_state is None
            else self.behaviors[state.current].feedback(
                state.behavior_state, state.behavior_flags
            ),
            events=state.events,
            event_count=state.event_count,
            plan=self._planned("plan", Plan, state, com, omega),
        )

    def paths(
        self, state: SupervisorState, com: np.ndarray, omega: float
    ) -> PlannedPaths:
        """Returns the planned paths of the active behavior; arguments as ``status``."""
        return self._planned("paths", PlannedPaths, state, com, omega)

    def _planned(
        self,
        method: str,
        kind: type[_Planned],
        state: SupervisorState,
        com: np.ndarray,
        omega: float,
    ) -> _Planned:
        """Calls ``plan`` or ``paths`` of the active behavior, if it acts."""
        if state.behavior_state is None or state.in_damping_mode:
            return kind()
        behavior = self.behaviors[state.current]
        planned = getattr(behavior, method)(state.behavior_state, com, omega)
        if not isinstance(planned, kind):
            raise BehaviorError(
                f"{method} of {state.current.name} must return {kind.__name__}, "
                f"returned {shown(planned)}"
            )
        return planned

    # ---- transitions ---------------------------------------------------------

    def _take_request(
        self, state: SupervisorState, observation: Observation, request: BehaviorRequest
    ) -> SupervisorState:
        state = replace(
            state, request_number=request.number, error_code=ErrorCode.NO_ERRORS
        )
        target = request.behavior
        if target not in self._entries:
            text = f"{target.name} refused: the controller has no such behavior"
            state = replace(state, error_code=ErrorCode.BEHAVIOR_NOT_IMPLEMENTED)
            return _log(state, Event(observation.time, "refusal", text))
        if target is state.current and not state.in_damping_mode:
            # A request for the active behavior: further steps, for example, or the
            # withdrawal of a request to leave.
            status = state.status & ~BehaviorStatus.TRANSITION_IN_PROGRESS
            return replace(state, desired=target, status=status, request=request)
        # In damping mode no behavior controls the robot, whichever is active.
        source = self._entries[
            Behavior.FREEZE if state.in_damping_mode else state.current
        ]
        asked = Transition(source, observation, self._tools, request.command)
        entry = self._entries[target]
        why, reason = refusal(entry, asked)
        sign = self._sign_of_fall(observation) if entry.upright else ""
        if sign and why is BehaviorStatus.OK:
            why = BehaviorStatus.FAILED_TRANS_COM_POS
            reason = f"{sign}; a reset puts the robot back on its feet"
        if why is not BehaviorStatus.OK:
            hint = f" ({reason})" if reason else ""
            text = f"{state.current.name} -> {target.name} refused: {why.name}{hint}"
            state = replace(
                state,
                error_code=ErrorCode.FAILED_TO_START_BEHAVIOR,
                status=why | (state.status & BehaviorStatus.TRANSITION_IN_PROGRESS),
                trans_from=state.current,
                trans_to=target,
            )
            return _log(state, Event(observation.time, "refusal", text))
        if source.ends_in_order and target is Behavior.STAND:
            # The behavior comes to an orderly end, and then sets ``finished``.
            return replace(
                state,
                desired=target,
                status=BehaviorStatus.TRANSITION_IN_PROGRESS,
                trans_from=state.current,
                trans_to=target,
            )
        state = replace(state, request=request)
        return self._change(
            state, observation, target, BehaviorStatus.TRANSITION_SUCCESS
        )

    def _change(
        self,
        state: SupervisorState,
        observation: Observation,
        target: Behavior,
        status: BehaviorStatus,
    ) -> SupervisorState:
        """Makes ``target`` the active behavior, to be entered at its first tick."""
        auto = " (by itself)" if status is BehaviorStatus.WARNING_AUTO_TRANS else ""
        text = f"{state.current.name} -> {target.name}{auto}"
        state = replace(
            state,
            current=target,
            desired=target,
            behavior_state=None,
            entered=False,
            status=status,
            trans_from=state.current,
            trans_to=target,
            behavior_flags=0,
            warned=False,
            falling=state.falling and bool(self._sign_of_fall(observation)),
        )
        return _log(
            state,
            Event(
                observation.time,
                "behavior",
                text,
                {"from": state.trans_from.name, "to": target.name},
            ),
        )

    def _enter(
        self,
        state: SupervisorState,
        observation: Observation,
        request: BehaviorRequest,
    ) -> SupervisorState:
        assert state.body is not None
        behavior = self.behaviors[state.current]
        behavior_state = read_only(behavior.enter(observation, state.body, request))
        return replace(state, behavior_state=behavior_state, entered=True)

    def _warn_of_user_legs(
        self, state: SupervisorState, observation: Observation
    ) -> SupervisorState:
        """Warns once if a behavior steps with leg joints under user control."""
        held = self._legs[observation.user_held[self._legs]]
        if not held.size:
            return state
        names = ", ".join(self._tools.robot.joint_names[i] for i in held)
        text = f"{state.current.name} with leg joints under user control: {names}"
        return _log(
            replace(state, warned=True), Event(observation.time, "warning", text)
        )

    def _watch_for_fall(
        self, state: SupervisorState, observation: Observation
    ) -> SupervisorState:
        """Detects a fall before the robot hits the ground."""
        if state.falling:
            return state
        sign = self._sign_of_fall(observation)
        if not sign:
            return state
        text = f"falling in {state.current.name} ({sign})"
        return _log(replace(state, falling=True), Event(observation.time, "fall", text))

    def _sign_of_fall(self, observation: Observation) -> str:
        return sign_of_fall(
            posture_of(observation.terms), self._tools.nominal_height, self._fall_limits
        )


def _made(entry: BehaviorEntry, tools: BehaviorTools, config: Any) -> BehaviorProtocol:
    """Makes the behavior of an entry.

    Raises:
        BehaviorError: If the result is not a behavior.
    """
    behavior = entry.make(tools, config)
    for name in ("enter", "update", "feedback", "plan", "paths"):
        if not callable(getattr(behavior, name, None)):
            raise BehaviorError(
                f"behavior {entry.name!r}: make must return a behavior, but what it "
                f"returned has no method {name}: {shown(behavior)}"
            )
    return behavior


def _check_outcome(outcome: object, behavior: Behavior) -> None:
    """Raises BehaviorError unless an update returned a valid outcome."""
    if not isinstance(outcome, Outcome):
        raise BehaviorError(
            f"update of {behavior.name} must return an Outcome, returned "
            f"{shown(outcome)}"
        )
    for name, kind in _OUTCOME.items():
        value = getattr(outcome, name)
        if not isinstance(value, kind):
            raise BehaviorError(
                f"{name} in the Outcome of {behavior.name} must be "
                f"{' or '.join(k.__name__ for k in kind)}, is {shown(value)}"
            )
    for event in outcome.events:
        if not isinstance(event, Event):
            raise BehaviorError(
                f"events in the Outcome of {behavior.name} must be Event values, has "
                f"{shown(event)}"
            )


_OUTCOME = {
    "body": (BodyReference,),
    "command": (WholeBodyCommand, type(None)),
    "status_flags": (int, np.integer),
    "events": (tuple, list),
}
"""Types of an outcome's fields; ``finished`` may have any type."""
_SUBSTATES = 7
"""Bits of a behavior's flags for its present substate, which are not latched."""


def _latch(before: int, now: int) -> int:
    return (before & ~_SUBSTATES) | now


def _log(state: SupervisorState, event: Event) -> SupervisorState:
    return replace(
        state,
        events=append_recent(state.events, event, KEPT_EVENTS),
        event_count=state.event_count + 1,
    )
