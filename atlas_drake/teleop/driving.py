"""Starts, continues and ends a walk: behavior commands from a desired direction.

Pure functions: state and report in, state and an optional message out. Footsteps are
planned in ``walking``.
"""

from __future__ import annotations

from dataclasses import dataclass

from atlas_drake.frozen import replace
from atlas_drake.messages import (
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
)
from atlas_drake.planning.footholds import Gait
from atlas_drake.teleop.walking import (
    Direction,
    Walker,
    begin_walk,
    close_feet,
    first_open_step,
    is_closing,
    next_steps,
    walk_on,
)

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


def steer(memory: Drive, direction: Direction | None) -> Drive:
    """Sets a new direction; None stops the walk."""
    return replace(memory, direction=direction)


def drive(
    memory: Drive, gait: Gait, report: AtlasSimInterfaceState
) -> tuple[Drive, AtlasSimInterfaceCommand | None]:
    """Returns the new state and the command to send now, if any.

    From every behavior but WALK the transition to WALK goes through STAND.

    Args:
        memory: State of the driving so far.
        gait: Gait of the walk.
        report: Latest report of the behaviors.
    """
    current = Behavior(report.current_behavior)
    memory = _notice(memory, current, report.header.stamp or 0.0)
    if current is Behavior.WALK and memory.walker is not None:
        return _walking(memory, memory.walker, gait, report)
    direction = memory.direction
    if direction is None or memory.walker is not None:
        return memory, None
    if current is Behavior.STAND:
        walker = begin_walk(direction)
        memory = replace(
            memory, asked_at=report.header.stamp or 0.0, started=False, leaving=False
        )
        return _send(memory, walker, direction, gait, report)
    return _ask_for_stand(memory)


def _notice(memory: Drive, current: Behavior, now: float) -> Drive:
    """Detects that the walk has begun, has ended, or was refused."""
    if memory.walker is None:
        return memory
    if current is Behavior.WALK:
        return replace(memory, started=True)
    if memory.started:
        # A walk that ended by itself starts again only on a new request.
        direction = memory.direction if memory.leaving else None
        return Drive(direction=direction)
    return Drive() if now > memory.asked_at + PATIENCE else memory


def _walking(
    memory: Drive, walker: Walker, gait: Gait, report: AtlasSimInterfaceState
) -> tuple[Drive, AtlasSimInterfaceCommand | None]:
    if memory.leaving:
        return memory, None
    if memory.direction is None:
        if is_closing(walker, report):
            return _ask_for_stand(memory)
        walker = close_feet(walker, report)
        direction = Direction()
    else:
        walker, direction = walk_on(walker), memory.direction
    if memory.sent == _cause(walker, direction, gait, report):
        return replace(memory, walker=walker), None
    return _send(memory, walker, direction, gait, report)


def _send(
    memory: Drive,
    walker: Walker,
    direction: Direction,
    gait: Gait,
    report: AtlasSimInterfaceState,
) -> tuple[Drive, AtlasSimInterfaceCommand]:
    cause = _cause(walker, direction, gait, report)
    walker, steps = next_steps(walker, direction, gait, report)
    return replace(memory, walker=walker, sent=cause), walk_command(steps)


def _cause(
    walker: Walker, direction: Direction, gait: Gait, report: AtlasSimInterfaceState
) -> object:
    return walker.closing, direction, gait, first_open_step(report)


def _ask_for_stand(memory: Drive) -> tuple[Drive, AtlasSimInterfaceCommand | None]:
    if memory.leaving:
        return memory, None
    command = AtlasSimInterfaceCommand()
    command.behavior = Behavior.STAND
    return replace(memory, leaving=True), command


def walk_command(steps: list[AtlasBehaviorStepData]) -> AtlasSimInterfaceCommand:
    """Requests WALK with these steps; their heights are relative to the stance foot."""
    command = AtlasSimInterfaceCommand()
    command.behavior = Behavior.WALK
    command.walk_params.step_queue = steps
    command.walk_params.use_relative_step_height = True
    return command
