"""The status of a controller: the one value that other systems read.

Viewers, logs, replay, the summary and ``AtlasSimInterfaceState`` are made from it.
Efforts have a separate port.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from numbers import Integral
from typing import Any

import numpy as np

from atlas_drake.config import as_float
from atlas_drake.errors import ErrorCode, shown
from atlas_drake.frozen import Frozen
from atlas_drake.messages.behavior import Behavior
from atlas_drake.messages.behavior_catalog import BehaviorCatalog
from atlas_drake.messages.behavior_feedback import AtlasBehaviorFeedback
from atlas_drake.messages.checks import check_type
from atlas_drake.messages.event import Event
from atlas_drake.messages.footstep import Footstep, points

MAX_CORNERS = 8
"""Greatest number of corners of the support polygon of two rectangular soles."""


@dataclass(frozen=True)
class PlannedPaths(Frozen):
    """Planned motion from the present on, as points in W [m]; each path may be None.

    Attributes:
        com: Path of the center of mass, horizontal, shape (k, 2).
        dcm: Path of the divergent component of motion, shape (k, 2).
        cop: Path of the center of pressure, shape (k, 2).
        swing: Path of the swing foot's sole from lift-off to touchdown, shape (k, 3).
    """

    com: np.ndarray | None = None
    dcm: np.ndarray | None = None
    cop: np.ndarray | None = None
    swing: np.ndarray | None = None

    def __post_init__(self) -> None:
        """Convert points to arrays."""
        for name in ("com", "dcm", "cop"):
            _take_points(self, name, (-1, 2))
        _take_points(self, "swing", (-1, 3))


@dataclass(frozen=True)
class Plan(Frozen):
    """Present plan of a controller; every field may be left out.

    Attributes:
        support: Corners of the support polygon, counter-clockwise in W [m], shape (k,
            2) with k at most ``MAX_CORNERS``.
        omega: Natural frequency of the pendulum that defines the DCM [1/s].
        com_reference: Reference of the center of mass, horizontal in W [m], shape (2,).
        dcm_reference: Reference of the DCM in W [m], shape (2,).
        cop_reference: Reference of the CoP in W [m], shape (2,).
        cmp_reference: Centroidal moment pivot (CMP) that balance commands in W [m],
            shape (2,): the point from which the ground pushes the CoM.
        cmp: CMP that the forces of the controller give in W [m], shape (2,).
        footsteps: Footsteps to come, the next one first.
    """

    support: np.ndarray | None = None
    omega: float | None = None
    com_reference: np.ndarray | None = None
    dcm_reference: np.ndarray | None = None
    cop_reference: np.ndarray | None = None
    cmp_reference: np.ndarray | None = None
    cmp: np.ndarray | None = None
    footsteps: tuple[Footstep, ...] = ()

    def __post_init__(self) -> None:
        """Convert points to arrays."""
        _take_points(self, "support", (-1, 2))
        if self.support is not None and len(self.support) > MAX_CORNERS:
            raise ValueError(f"support must have at most {MAX_CORNERS} corners")
        for name in ("com", "dcm", "cop", "cmp"):
            _take_points(self, f"{name}_reference", (2,))
        _take_points(self, "cmp", (2,))
        if self.omega is not None and not (as_float(self.omega) or 0.0) > 0.0:
            raise ValueError(f"omega must be above 0 or None, is {shown(self.omega)}")
        _check_all(self.footsteps, "footsteps", Footstep)
        object.__setattr__(self, "footsteps", tuple(self.footsteps))


def _take_points(values: object, name: str, shape: tuple[int, ...]) -> None:
    """Makes a read-only array of a field, unless it is None."""
    given = getattr(values, name)
    if given is not None:
        object.__setattr__(values, name, points(given, name, shape))


def _check_all(given: object, name: str, kind: type) -> None:
    """Raises TypeError unless a field has values of one type alone."""
    # By their types at once: a status has up to 200 events in every tick.
    if not isinstance(given, tuple | list) or any(
        not issubclass(found, kind) for found in set(map(type, given))
    ):
        raise TypeError(f"{name} must be {kind.__name__} values, is {shown(given)}")


KEPT_EVENTS = 200
"""Number of events in a status, beside those of the last ``event.READ_WITHIN``
seconds; as many as displays show."""


@dataclass(frozen=True)
class ControllerStatus(Frozen):
    """Status of a controller; every field has a default.

    The status does not hold the computing time of a tick, because it depends on the
    machine, and the Context holds only values that are the same in every run. To get
    the computing time into summary and log, a controller appends it to its attribute
    ``tick_seconds``, see ``diagrams.controller_socket``.

    Attributes:
        current_behavior: The active behavior.
        desired_behavior: The requested behavior; differs from the active one during a
            transition.
        error_code: Error of the last command.
        behavior_feedback: Result of the last transition.
        feedback: Feedback of the active behavior: a message such as
            ``AtlasBehaviorWalkFeedback``, or any frozen value; None without one.
        events: The latest events. Older events are dropped; those of the last
            ``event.READ_WITHIN`` seconds must be there.
        event_count: Number of events since the diagram was built, including dropped
            ones. It may restart at a reset, with only new events in ``events``, and
            decreases nowhere else.
        solved: True if the last tick's optimization had a solution; None if the
            controller does not optimize.
        unsolved: Number of ticks without a solution.
        why_unsolved: Reason for which the last tick had no solution, in words, as far
            as it is known.
        plan: Present plan of the controller.
    """

    current_behavior: Behavior = Behavior.NONE
    desired_behavior: Behavior = Behavior.NONE
    error_code: ErrorCode = ErrorCode.NO_ERRORS
    behavior_feedback: AtlasBehaviorFeedback = field(
        default_factory=AtlasBehaviorFeedback
    )
    feedback: Any = None
    events: tuple[Event, ...] = ()
    event_count: int = 0
    solved: bool | None = None
    unsolved: int = 0
    why_unsolved: str = ""
    plan: Plan = field(default_factory=Plan)


def check_status(value: object, catalog: BehaviorCatalog) -> ControllerStatus:
    """Check the status of a controller that is not ours, and return it."""
    status = check_type(value, ControllerStatus, "the port 'controller_status'")
    for name, kind in _KINDS.items():
        check_type(getattr(status, name), kind, name)
    _check_all(status.events, "events", Event)
    if status.event_count < len(status.events):
        raise ValueError(
            f"event_count must count all events, is {status.event_count} with "
            f"{len(status.events)} of them"
        )
    for behavior in (status.current_behavior, status.desired_behavior):
        if behavior not in catalog:
            raise ValueError(
                f"the controller's status names {behavior} ({int(behavior)}), which is "
                "not registered: give its entry to behaviors="
            )
    return status


_KINDS: dict[str, Any] = {
    "current_behavior": Behavior,
    "desired_behavior": Behavior,
    "error_code": Integral,
    "behavior_feedback": AtlasBehaviorFeedback,
    "event_count": Integral,
    "solved": bool | np.bool_ | None,
    "unsolved": Integral,
    "why_unsolved": str,
    "plan": Plan,
}
"""Types of a status' fields."""


def check_paths(value: object) -> PlannedPaths:
    """Check the value of a controller's port for planned paths and return it."""
    return check_type(value, PlannedPaths, "the port 'planned_paths'")
