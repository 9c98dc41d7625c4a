"""Starts, continues and ends a walk: behavior commands from a desired direction.

Pure functions: state and report in, state and an optional message out. Footsteps are
planned in ``walking``.
"""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.cockpit.steering import (
    Direction,
    Walker,
    begin_walk,
    close_feet,
    first_open_step,
    is_closing,
    next_steps,
)
from atlas_drake.frozen import replace
from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
)
from atlas_drake.planning.footholds import Gait

PATIENCE = 1.0
"""Time within which a requested walk begins; later it counts as refused [s]."""


@dataclass(frozen=True)
class Drive:
    """State between readings of the panel.

    Attributes:
        direction: Direction of the walk; None for no walk.
        walker: State of the requested walk; None without a walk.
        asked_at: Time of the request [s].
        started: True once a report has shown that walk as active.
        leaving: True if STAND was requested, which all other commands wait for.
        sent: Inputs of the last steps that were sent, to detect a change.
    """

    direction: Direction | None = None
    walker: Walker | None = None
    asked_at: float = 0.0
    started: bool = False
    leaving: bool = False
    sent: object = None


def steer(state: Drive, direction: Direction | None) -> Drive:
    """Sets a new direction; None stops the walk."""
    return replace(state, direction=direction)


def drive(
    state: Drive, gait: Gait, report: AtlasSimInterfaceState
) -> tuple[Drive, AtlasSimInterfaceCommand | None]:
    """Returns the new state and the command to send now, if any.

    From every behavior but WALK the transition to WALK goes through STAND.
    """
    current = Behavior(report.current_behavior)
    state = _notice(state, current, report.header.stamp or 0.0)
    if current is Behavior.WALK and state.walker is not None:
        return _walking(state, state.walker, gait, report)
    direction = state.direction
    if direction is None or state.walker is not None:
        return state, None
    if current is not Behavior.STAND:
        return _ask_for_stand(state)
    asked_at = report.header.stamp or 0.0
    state = replace(state, asked_at=asked_at, started=False, leaving=False)
    return _send(state, begin_walk(direction), direction, gait, report)


def _notice(state: Drive, current: Behavior, now: float) -> Drive:
    """Detects that the walk has begun, has ended, or was refused."""
    if state.walker is None:
        return state
    if current is Behavior.WALK:
        return replace(state, started=True)
    if state.started:
        # A walk that ended by itself starts again only on a new request.
        return Drive(direction=state.direction if state.leaving else None)
    return Drive() if now > state.asked_at + PATIENCE else state


def _walking(
    state: Drive, walker: Walker, gait: Gait, report: AtlasSimInterfaceState
) -> tuple[Drive, AtlasSimInterfaceCommand | None]:
    if state.leaving:
        return state, None
    if state.direction is None:
        if is_closing(walker, report):
            return _ask_for_stand(state)
        walker = close_feet(walker, gait, report)
        direction = Direction()
    else:
        walker, direction = replace(walker, closing=None), state.direction
    if state.sent == _cause(walker, direction, gait, report):
        return replace(state, walker=walker), None
    return _send(state, walker, direction, gait, report)


def _send(
    state: Drive,
    walker: Walker,
    direction: Direction,
    gait: Gait,
    report: AtlasSimInterfaceState,
) -> tuple[Drive, AtlasSimInterfaceCommand]:
    cause = _cause(walker, direction, gait, report)
    walker, steps = next_steps(walker, direction, gait, report)
    return replace(state, walker=walker, sent=cause), walk_command(steps)


def _cause(
    walker: Walker, direction: Direction, gait: Gait, report: AtlasSimInterfaceState
) -> object:
    """Returns what the steps of a walk follow from."""
    return walker.closing, direction, gait, first_open_step(report)


def _ask_for_stand(state: Drive) -> tuple[Drive, AtlasSimInterfaceCommand | None]:
    if state.leaving:
        return state, None
    command = AtlasSimInterfaceCommand(behavior=Behavior.STAND)
    return replace(state, leaving=True), command


def walk_command(steps: list[AtlasBehaviorStepData]) -> AtlasSimInterfaceCommand:
    """Requests WALK with these steps; their heights are relative to the stance foot."""
    command = AtlasSimInterfaceCommand()
    command.behavior = Behavior.WALK
    command.walk_params.step_queue = steps
    command.walk_params.use_relative_step_height = True
    return command
