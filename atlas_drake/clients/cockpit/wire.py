"""What goes over the line between the simulation and the page's process.

Down: a ``Run`` when one joins, a ``Frame`` ten times a second, ``Settings`` when they
change, an ``Answer`` to each request, and notices. Up: requests, the number of open
pages, and ``ACKNOWLEDGED`` for each frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from atlas_drake.clients.steering.joint_motion import JointFacts
from atlas_drake.clients.steering.reports import Reports
from atlas_drake.planning.footholds import Gait

ACKNOWLEDGED = "acknowledged"
"""What the page answers to a frame: the next one may come."""
ShownEvent = tuple[float, str, str]
"""Time [s], kind and text of an event."""


@dataclass(frozen=True)
class Robot:
    """What a client needs to know of the robot that it commands."""

    joints: JointFacts
    gait: Gait


@dataclass(frozen=True)
class Run:
    """A simulation or a log that the page shows from now on.

    Attributes:
        page: JSON for the browser.
        meshcat_port: Port of the 3D view.
        robot: None for a log, which nobody commands.
    """

    page: bytes
    meshcat_port: int
    robot: Robot | None = None


@dataclass(frozen=True)
class Frame:
    """The run at an instant.

    Attributes:
        page: JSON for the browser, with the record.
        run: Changes when time has jumped; all events then come again.
        time: Simulated time [s].
        rate: Simulated seconds per second of wall time, lately; 0 in a pause.
        behavior: Name of the active behavior.
        user: The user's share of all joints, 0 to 1.
        steered_policy: Shares of the greatest velocity that a policy is asked for,
            which has its joints; None without.
        events: Events since the frame before.
        reports: For the pilot; None for a log.
    """

    page: bytes
    run: int
    time: float
    rate: float
    behavior: str
    user: float
    events: tuple[ShownEvent, ...] = ()
    reports: Reports | None = None
    steered_policy: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Settings:
    """The settings of the scenario, as JSON for the browser."""

    page: bytes


@dataclass(frozen=True)
class Answer:
    """What became of a request."""

    number: int
    value: Any = None
    problem: str = ""


@dataclass(frozen=True)
class Notice:
    """Something that every viewer is told."""

    text: str
    lasting: bool = False


@dataclass(frozen=True)
class Request:
    """Something that is asked of the run, by name; 0 wants neither answer nor frame.

    A frame with the effect precedes the answer.
    """

    number: int
    name: str
    values: Mapping[str, Any] = field(default_factory=dict)
