"""What a control tick was: one frozen value for whoever shows, writes or counts."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeVar

import numpy as np

from atlas_drake.messages import (
    AtlasBehaviorManipulateFeedback,
    AtlasBehaviorStandFeedback,
    AtlasBehaviorStepFeedback,
    AtlasBehaviorWalkFeedback,
    AtlasSimInterfaceCommand,
    Message,
)
from atlas_drake.messages.controller_status import PlannedPaths
from atlas_drake.messages.event import FOOTSTEP, Event
from atlas_drake.messages.footstep import Footstep
from atlas_drake.records.column import Column, Group
from atlas_drake.records.groups import (
    Balance,
    BehaviorNumbers,
    ContactPairs,
    ControllerNumbers,
    Estimator,
    Feet,
    Gains,
    Hands,
    ImuNumbers,
    Joints,
    Pelvis,
    State,
    World,
)

NO_QP = -1
"""Value of ``controller.solved`` where a controller has, or needed, no QP."""
_T = TypeVar("_T", bound=Message)
KEPT_LANDINGS = 40
"""Number of landed footsteps that a record holds."""


def _always(message: _T) -> Callable[[], _T]:
    """Returns a function that returns one frozen message, for all records."""
    message.freeze()
    return lambda: message


_NO_STAND = _always(AtlasBehaviorStandFeedback())
_NO_WALK = _always(AtlasBehaviorWalkFeedback())
_NO_STEP = _always(AtlasBehaviorStepFeedback())
_NO_MANIPULATE = _always(AtlasBehaviorManipulateFeedback())


@dataclass(frozen=True, eq=False)
class ContactForce(Group):
    """The force of one contact on the robot, in W."""

    p_WC: np.ndarray  # Point of the contact [m], shape (3,).
    force_W: np.ndarray  # Force on the robot [N], shape (3,).


@dataclass(frozen=True, eq=False)
class TickRecord(Group):
    """One control tick of a run, live or from a log.

    Wall time of the tick takes no part in comparisons. What a custom controller does
    not know is absent: None, empty, or blank feedback.

    ``records.groups`` describes the groups of numbers, from ``behavior`` to
    ``estimator``, column by column.

    Attributes:
        time: Time of the tick [s].
        request: The behavior command in force; None before the first one.
        world: None if no model beside the robot moves.
        estimator: None without a state estimator.
        contact_pairs: None unless the scenario's ``contacts`` ask for some.
        stand, walk, step, manipulate: Feedback of these behaviors; blank while another
            behavior is active.
        feedback: Feedback of a user's own behavior as plain data; None without one.
        plan: What a user's own plan adds to ``Plan``, as plain data by field.
        footsteps: Footsteps to come, the next one first.
        landed: The last footsteps that landed, as events.
        pushes: Bodies that are pushed, and the forces on them in W [N].
        events: Events of this tick.
        paths: Planned paths; None unless they were asked for.
        contacts: Forces of single contacts; None unless they were asked for.
    """

    time: Annotated[float, Column("time of the tick", "s")]
    behavior: BehaviorNumbers
    request: AtlasSimInterfaceCommand | None
    joints: Joints
    gains: Gains
    pelvis: Pelvis
    imu: ImuNumbers
    feet: Feet
    hands: Hands
    balance: Balance
    controller: ControllerNumbers
    state: State
    world: World | None = None
    estimator: Estimator | None = None
    contact_pairs: ContactPairs | None = None
    stand: AtlasBehaviorStandFeedback = field(default_factory=_NO_STAND)
    walk: AtlasBehaviorWalkFeedback = field(default_factory=_NO_WALK)
    step: AtlasBehaviorStepFeedback = field(default_factory=_NO_STEP)
    manipulate: AtlasBehaviorManipulateFeedback = field(default_factory=_NO_MANIPULATE)
    feedback: Any = None
    plan: Mapping[str, Any] = field(default_factory=dict)
    footsteps: tuple[Footstep, ...] = ()
    landed: tuple[Event, ...] = ()
    pushes: tuple[tuple[str, tuple[float, float, float]], ...] = ()
    events: tuple[Event, ...] = ()
    paths: PlannedPaths | None = None
    contacts: tuple[ContactForce, ...] | None = None

    @property
    def time_to_touchdown(self) -> float:
        """Planned time until the next touchdown [s]; 0 if none is planned."""
        return max(self.walk.t_step_rem, self.step.t_step_rem, 0.0)


def landed_among(events: Iterable[Event]) -> tuple[Event, ...]:
    """Returns the last ``KEPT_LANDINGS`` footsteps that landed."""
    return tuple(event for event in events if event.kind == FOOTSTEP)[-KEPT_LANDINGS:]
