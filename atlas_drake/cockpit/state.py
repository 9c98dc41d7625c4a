"""What the page knows: of the robot once, of the run ten times a second.

Plain values, which go from one process to another.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from atlas_drake.messages.event import Event

Point = tuple[float, float]
ShownEvent = tuple[float, str, str]
"""Time [s], kind and text of an event."""
BESIDE = " beside"
"""End of the names of what is plotted of a second log."""


@dataclass(frozen=True)
class JointCard:
    """What the page knows of a joint."""

    name: str
    limb: str
    lower: float
    upper: float
    effort: float
    links: tuple[str, ...]
    place: Point
    parent: Point


@dataclass(frozen=True)
class ParamCard:
    """A parameter of a behavior of the user's own: name, type in words, default."""

    name: str
    kind: str
    default: Any


@dataclass(frozen=True)
class BehaviorCard:
    """A behavior: name, color, what it does, and the parameters of a user's own."""

    name: str
    color: str
    description: str
    own: bool
    params: tuple[ParamCard, ...] = ()


@dataclass(frozen=True)
class Range:
    """A number that can be set: its bounds, smallest change, unit and usual value."""

    low: float
    high: float
    step: float
    unit: str
    usual: float


@dataclass(frozen=True)
class LogCard:
    """A log that is played."""

    begin: float
    end: float
    phases: tuple[tuple[float, str], ...]


@dataclass(frozen=True)
class RunCard:
    """What stays the same in a run."""

    title: str
    robot: str
    mass: float
    joints: tuple[JointCard, ...]
    behaviors: tuple[BehaviorCard, ...]
    gait: Mapping[str, Range]
    pelvis: Mapping[str, Range]
    pushed: tuple[str, ...]
    overlays: Mapping[str, str]
    sole: Point
    meshcat_port: int
    columns: Mapping[str, str] = field(default_factory=dict)
    log: LogCard | None = None


@dataclass(frozen=True)
class RunState:
    """The run at an instant; joint values are in message order."""

    time: float
    rate: float
    pace: float
    paused: bool
    tick_ms: float
    behavior: str
    desired: str
    fallen: bool
    refusals: Mapping[str, str]
    k_effort: tuple[int, ...]
    position: tuple[float, ...]
    set_point: tuple[float, ...]
    effort: tuple[float, ...]
    gains: Mapping[str, tuple[float, ...]]
    poses: tuple[str, ...]
    direction: tuple[float, float, float] | None
    gait: Mapping[str, float]
    pelvis: Mapping[str, float]
    robot: tuple[float, float, float, float]
    ground: float
    com: Point
    dcm: Point
    cop: Point | None
    support: tuple[Point, ...]
    feet: tuple[tuple[float, float, float], ...]
    loads: tuple[float, float]
    steps: tuple[tuple[int, float, float, float], ...]
    plan: tuple[tuple[int, float, float, float], ...]
    overlays: frozenset[str]
    events: tuple[ShownEvent, ...] = ()
    event_count: int = 0
    run: int = 0
    samples: tuple[tuple[float, Mapping[str, float]], ...] = ()
    past: tuple[tuple[float, str, float], ...] = ()
    recording: bool = False


MOST_EVENTS = 100
"""Number of events in one state."""


def events_after(events: Sequence[Event], seen: int) -> tuple[ShownEvent, ...]:
    """Returns the next events of a run after the ``seen`` first ones."""
    new = events[seen : seen + MOST_EVENTS]
    return tuple((event.time, event.kind, event.text) for event in new)
