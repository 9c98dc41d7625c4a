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
    """What the page knows of a joint.

    Attributes:
        name: Name of the joint.
        limb: Limb that it belongs to.
        lower: Least position [rad].
        upper: Greatest position [rad].
        effort: Greatest effort [N·m].
        links: Links that it moves.
        place: Its place in the figure: to the robot's left, and up [m].
        parent: Place of the joint before it on the way to the pelvis.
    """

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
    """A log that is played.

    Attributes:
        begin: Time of its first row [s].
        end: Time of its last row [s].
        phases: When each behavior began [s], and its name.
    """

    begin: float
    end: float
    phases: tuple[tuple[float, str], ...]


@dataclass(frozen=True)
class RunCard:
    """What stays the same in a run.

    Attributes:
        title: Name of the scenario.
        robot: Name of the robot.
        mass: Of the robot [kg].
        joints: Its joints, in message order.
        behaviors: What can be asked for.
        gait: Settings of a walk, by name.
        pelvis: Coordinates of the pelvis, by name.
        pushed: Links that are pushed by name.
        overlays: What the 3D view can show, in words by name.
        sole: Length and width of a sole [m].
        meshcat_port: Port of the 3D view.
        columns: Units of what can be plotted, by name.
        log: The log that is played; None for a simulation.
    """

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
    """The run at an instant; joint values are in message order.

    Attributes:
        time: Simulated time [s].
        rate: Simulated seconds per second, lately.
        pace: Multiple of real time that is kept to; 0 for none.
        paused: True while time stands still.
        tick_ms: Median computing time of the latest control ticks [ms].
        behavior: The active behavior.
        desired: The behavior that is asked for.
        fallen: True after a fall.
        refusals: Why each behavior would be refused now; empty if it would not.
        k_effort: The user's share of each joint, 0 to 255.
        position: Measured positions [rad].
        set_point: The user's set-points [rad].
        effort: Efforts of the motors [N·m].
        gains: Gains of the user's controllers, by name.
        poses: Poses that the user's joints can go to.
        direction: Direction of the walk: ahead, left, turn; None without one.
        gait: Settings of the next steps.
        pelvis: Clamped coordinates of the pelvis in MANIPULATE.
        robot: Pelvis in W: x, y, z [m], and heading [rad].
        ground: Height of the lower sole [m].
        com: Center of mass in W [m].
        dcm: Divergent component of motion [m].
        cop: Center of pressure [m]; None without a load.
        support: Corners of the support polygon [m].
        feet: x, y [m] and heading [rad] of the soles, left and right.
        loads: Vertical force on each foot [N].
        steps: Foot, x, y [m], heading [rad] of the steps to come.
        plan: Likewise, of the plan that is shown and not sent.
        overlays: What the 3D view shows.
        events: The new events.
        event_count: Number of all events of the run.
        run: Number of the run, which a reset with a seed increases.
        samples: What is plotted, since the last state: time [s], and numbers by name.
        past: After a jump in a log, the time before: time [s], behavior, user's share.
        recording: True while the 3D view is recorded.
    """

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
