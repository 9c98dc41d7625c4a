"""Runs the active behavior and changes it on request, by itself, or after a fall.

The objects here hold constants only; ``supervisor_state`` has the frozen state, and
``entry`` the legal transitions of a behavior.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

import numpy as np

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.base import BehaviorProtocol, Observation
from atlas_drake.behaviors.body_reference import capture_body
from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.entry import (
    BehaviorEntry,
    BehaviorTools,
    Transition,
    refusal,
)
from atlas_drake.behaviors.fall import posture_of, sign_of_fall
from atlas_drake.behaviors.freeze import Freeze
from atlas_drake.behaviors.recovery import walk_without_steps
from atlas_drake.behaviors.supervisor_state import (
    LastTransition,
    Running,
    Starting,
    SupervisorState,
    Waiting,
)
from atlas_drake.control.balance.foothold import Foothold
from atlas_drake.control.whole_body.command import WholeBodyCommand
from atlas_drake.control.whole_body.model import WholeBodyModel
from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import read_only, replace
from atlas_drake.messages import AtlasBehaviorFeedback, Behavior, BehaviorStatus
from atlas_drake.messages.commands import BehaviorRequest
from atlas_drake.messages.controller_status import ControllerStatus, Plan, PlannedPaths
from atlas_drake.messages.event import FOOTSTEP, Event
from atlas_drake.messages.footstep import LEFT

_Planned = TypeVar("_Planned", Plan, PlannedPaths)


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
        entries: Iterable[BehaviorEntry],
    ):
        """Makes the behaviors of all entries.

        ``nominal_height`` is that of the CoM above the soles when standing [m].
        """
        robot = model.robot
        balance = Balance(robot, config.gains, config.stance, config.sway)
        self._tools = BehaviorTools(
            model,
            balance,
            nominal_height,
            config.body,
            config.entry,
            Freeze(balance, config.freeze),
            config.gait(),
            config.stand,
        )
        self._fall_limits = config.fall
        self._legs = np.flatnonzero(robot.limb("l_leg", "r_leg"))
        self._entries = {entry.behavior: entry for entry in entries}
        self.behaviors: dict[Behavior, BehaviorProtocol] = {
            behavior: _made(entry, self._tools, config)
            for behavior, entry in self._entries.items()
        }

    def start(self, behavior: Behavior) -> SupervisorState:
        """Returns the state before the first tick, with ``behavior`` active."""
        return SupervisorState(Starting(behavior), desired=behavior)

    def restart(self, state: SupervisorState, behavior: Behavior) -> SupervisorState:
        """Returns the state of a new start that keeps the events so far.

        It forgets the footsteps, on which the robot does not stand any more.
        """
        kept = tuple(event for event in state.events if event.kind != FOOTSTEP)
        return replace(self.start(behavior), events=kept, event_count=state.event_count)

    def update(
        self,
        state: SupervisorState,
        observation: Observation,
        requests: Sequence[BehaviorRequest],
    ) -> tuple[SupervisorState, WholeBodyCommand | None]:
        """Computes one tick: the next state, and the command for the QP; None for none.

        ``requests`` are at least one, oldest first; those that came since the last tick
        are handled in their order.
        """
        active = state.active
        if isinstance(active, Starting):
            body = read_only(capture_body(observation.terms))
            active = Waiting(active.behavior, requests[0], body)
            state = replace(state, request=requests[0])
        footholds = self._tools.balance.footholds(state.footholds, observation)
        read_only(footholds, state.footholds)
        observation = replace(observation, footholds=footholds)
        state = replace(state, footholds=footholds)
        state = self._watch_for_fall(state, observation)
        for new in requests:
            if new.is_newer(state.request):
                state, active = self._take_request(state, active, observation, new)
        if state.in_damping_mode:
            # No behavior acts or reports while the joints are only damped.
            body = read_only(capture_body(observation.terms))
            return replace(state, active=replace(active, body=body)), None
        if self._must_step(state, active, observation):
            request = walk_without_steps(active.request)
            active = Waiting(Behavior.WALK, request, active.body)
            by_itself = BehaviorStatus.WARNING_AUTO_TRANS
            state = self._change(state, observation, active, by_itself)
        try:
            return self._act(state, active, observation)
        except Exception as error:
            error.add_note(f"in the behavior {active.behavior.name}")
            raise

    def _act(
        self,
        state: SupervisorState,
        active: Waiting | Running,
        observation: Observation,
    ) -> tuple[SupervisorState, WholeBodyCommand | None]:
        """Lets the active behavior act, which is entered if it waits."""
        behavior = self.behaviors[active.behavior]
        if isinstance(active, Waiting):
            entered = behavior.enter(observation, active.body, active.request)
            active = Running(
                active.behavior, active.request, active.body, read_only(entered)
            )
        if self._entries[active.behavior].lifts_feet and not active.warned:
            state, active = self._warn_of_user_legs(state, active, observation)
        outcome = behavior.update(
            active.state,
            observation,
            active.body,
            active.request,
            leaving=state.desired != active.behavior,
        )
        active = replace(
            active,
            state=read_only(outcome.state, active.state),
            body=read_only(outcome.body, active.body),
            flags=(active.flags & ~_SUBSTATES) | outcome.status_flags,
        )
        state = replace(state, active=active)
        if outcome.landing is not None:
            foot, ground = outcome.landing
            landed = Foothold(ground)
            left, right = state.footholds
            footholds = (landed, right) if foot == LEFT else (left, landed)
            state = replace(state, footholds=read_only(footholds))
        for event in outcome.events:
            state = state.with_event(event)
        if outcome.finished:
            asked = state.desired is not active.behavior
            status = (
                BehaviorStatus.TRANSITION_SUCCESS
                if asked
                else BehaviorStatus.WARNING_AUTO_TRANS
            )
            following = Waiting(Behavior.STAND, active.request, active.body)
            state = self._change(state, observation, following, status)
        return state, None if state.falling else outcome.command

    def status(
        self, state: SupervisorState, com: np.ndarray, omega: float
    ) -> ControllerStatus:
        """Returns the status of the behaviors; it says nothing of the QP.

        CoM, horizontal in W [m], and ``omega`` of the pendulum [1/s] are those of the
        tick.
        """
        falling = BehaviorStatus.ERROR_FALLING if state.falling else BehaviorStatus.OK
        last, active, feedback = state.last, state.active, None
        if isinstance(active, Running) and active.state is not None:
            behavior = self.behaviors[active.behavior]
            feedback = behavior.feedback(active.state, active.flags)
        return ControllerStatus(
            current_behavior=active.behavior,
            desired_behavior=state.desired,
            error_code=state.error_code,
            behavior_feedback=AtlasBehaviorFeedback(
                last.status | falling, last.source, last.target
            ),
            feedback=feedback,
            events=state.events,
            event_count=state.event_count,
            plan=self._planned("plan", Plan(), state, com, omega),
        )

    def paths(
        self, state: SupervisorState, com: np.ndarray, omega: float
    ) -> PlannedPaths:
        """Returns the planned paths of the active behavior; arguments as ``status``."""
        return self._planned("paths", PlannedPaths(), state, com, omega)

    def _planned(
        self,
        method: str,
        empty: _Planned,
        state: SupervisorState,
        com: np.ndarray,
        omega: float,
    ) -> _Planned:
        """Calls ``plan`` or ``paths`` of the active behavior, if it acts."""
        active = state.active
        if not isinstance(active, Running) or state.in_damping_mode:
            return empty
        if active.state is None:
            return empty
        plan = getattr(self.behaviors[active.behavior], method)
        planned: _Planned = plan(active.state, com, omega)
        return planned

    # ---- transitions ---------------------------------------------------------

    def _take_request(
        self,
        state: SupervisorState,
        active: Waiting | Running,
        observation: Observation,
        request: BehaviorRequest,
    ) -> tuple[SupervisorState, Waiting | Running]:
        """Handles a new request; returns the state, and the behavior then active."""
        state = replace(
            state, active=active, request=request, error_code=ErrorCode.NO_ERRORS
        )
        target, last = request.behavior, state.last
        if target not in self._entries:
            text = f"{target.name} refused: the controller has no such behavior"
            state = replace(state, error_code=ErrorCode.BEHAVIOR_NOT_IMPLEMENTED)
            return state.with_event(Event(observation.time, "refusal", text)), active
        if target is active.behavior and not state.in_damping_mode:
            # A request for the active behavior: further steps, for example, or the
            # withdrawal of a request to leave.
            status = last.status & ~BehaviorStatus.TRANSITION_IN_PROGRESS
            state = replace(state, desired=target, last=replace(last, status=status))
            return state, replace(active, request=request)
        # In damping mode no behavior controls the robot, whichever is active.
        source = self._entries[
            Behavior.FREEZE if state.in_damping_mode else active.behavior
        ]
        asked = Transition(source, observation, self._tools, request.command)
        entry = self._entries[target]
        why, reason = refusal(entry, asked)
        sign = self._sign_of_fall(observation) if entry.upright else ""
        if sign and why is BehaviorStatus.OK:
            why = BehaviorStatus.FAILED_TRANS_COM_POS
            reason = f"{sign}; a reset puts the robot back on its feet"
        if why is not BehaviorStatus.OK:
            words = reason or entry.refusal_in_words(
                why, source, self._entries.values()
            )
            change = f"{active.behavior.name} -> {target.name}"
            text = f"{change} refused: {words} ({why.name})"
            status = why | (last.status & BehaviorStatus.TRANSITION_IN_PROGRESS)
            state = replace(
                state,
                error_code=ErrorCode.FAILED_TO_START_BEHAVIOR,
                last=LastTransition(active.behavior, target, status),
            )
            return state.with_event(Event(observation.time, "refusal", text)), active
        if source.ends_in_order and target is Behavior.STAND:
            # The behavior comes to an orderly end, and then sets ``finished``.
            status = BehaviorStatus.TRANSITION_IN_PROGRESS
            last = LastTransition(active.behavior, target, status)
            return replace(state, desired=target, last=last), active
        following = Waiting(target, request, active.body)
        success = BehaviorStatus.TRANSITION_SUCCESS
        return self._change(state, observation, following, success), following

    def _change(
        self,
        state: SupervisorState,
        observation: Observation,
        following: Waiting,
        status: BehaviorStatus,
    ) -> SupervisorState:
        """Makes a behavior the active one, to be entered at its first tick."""
        source, target = state.current, following.behavior
        auto = " (by itself)" if status is BehaviorStatus.WARNING_AUTO_TRANS else ""
        text = f"{source.name} -> {target.name}{auto}"
        names = {"from": source.name, "to": target.name}
        return replace(
            state,
            active=following,
            desired=target,
            last=LastTransition(source, target, status),
            falling=state.falling and bool(self._sign_of_fall(observation)),
        ).with_event(Event(observation.time, "behavior", text, names))

    def _must_step(
        self,
        state: SupervisorState,
        active: Waiting | Running,
        observation: Observation,
    ) -> bool:
        """Returns True if the behavior stands, and only a step keeps the balance."""
        return (
            self._entries[active.behavior].recovers
            and isinstance(active, Running)
            and not state.falling
            and self._tools.recovery.is_needed(observation)
        )

    def _warn_of_user_legs(
        self, state: SupervisorState, active: Running, observation: Observation
    ) -> tuple[SupervisorState, Running]:
        """Warns once if a behavior steps with leg joints under user control."""
        if not observation.user_holds(self._legs):
            return state, active
        held = self._legs[observation.user_held[self._legs]]
        names = ", ".join(self._tools.robot.joint_names[i] for i in held)
        text = f"{active.behavior.name} with leg joints under user control: {names}"
        state = state.with_event(Event(observation.time, "warning", text))
        return state, replace(active, warned=True)

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
        event = Event(observation.time, "fall", text)
        return replace(state, falling=True).with_event(event)

    def _sign_of_fall(self, observation: Observation) -> str:
        return sign_of_fall(
            posture_of(observation.terms), self._tools.nominal_height, self._fall_limits
        )


def _made(
    entry: BehaviorEntry, tools: BehaviorTools, config: ControllerConfig
) -> BehaviorProtocol:
    """Makes the behavior of an entry."""
    own = entry.config
    if own is not None:
        own = getattr(config, entry.configured_at, own)
    try:
        return entry.make(tools, own)
    except Exception as error:
        error.add_note(f"as the behavior {entry.name} is made")
        raise


_SUBSTATES = 7
"""Bits of a behavior's flags for its present substate, which are not latched."""
