"""The commands in force: all commands accepted so far, merged.

Pure functions on frozen values. A message that the door refuses, or that contradicts
what is in force, changes nothing but the error code. A message on a port is new if it
is another frozen one, or differs in content from the one before.
"""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.frozen import NOTHING, Frozen, read_only, replace
from atlas_drake.messages import (
    K_EFFORT_MAX,
    Accepted,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
    Message,
    Refusal,
    accept,
)
from atlas_drake.messages.atlas_command import COMMANDS
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.messages.door import check_order
from atlas_drake.messages.event import (
    MESSAGE,
    REFUSAL,
    Event,
    append_recent,
    items_since,
)
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.robot import Robot

_log = logging.getLogger(__name__)
KEPT = 50
"""Number of requests and events to keep; none younger than READ_WITHIN is dropped."""
SCHEDULED = "scheduled_"
"""What the names of a scheduler's ports begin with."""
COMMAND_PORTS = {
    f"{sender}{name}": kind
    for sender in (SCHEDULED, "")
    for name, kind in COMMANDS.items()
}
"""Kind of message on each command port. A scheduler has ports of its own, so that a
schedule leaves those of the interface to others."""
_KINDS = tuple(COMMAND_PORTS.values())
SAME_FAULT = 1.0
"""Time within which a refusal for the same field is not logged again [s]."""


@dataclass(frozen=True)
class BehaviorRequest(Frozen):
    """The behavior command in force.

    Attributes:
        behavior: The requested behavior.
        command: Snapshot of the message.
        number: Number of the message among all received on all ports; increases from
            request to request, and is 0 for the initial request without a message.
        time: Time of acceptance [s].
    """

    behavior: Behavior
    command: AtlasSimInterfaceCommand
    number: int
    time: float = 0.0

    def is_newer(self, last: Self | None) -> bool:
        """Returns True if this request came after ``last``; None is before all."""
        return last is None or self.number > last.number


@dataclass(frozen=True)
class ActiveCommand(Frozen):
    """All values that commands have set."""

    joints: JointCommand
    requests: tuple[BehaviorRequest, ...]  # The latest ones, oldest first.
    catalog: BehaviorCatalog = SHIPPED
    error_code: ErrorCode = ErrorCode.NO_ERRORS  # Of the last message.
    events: tuple[Event, ...] = ()  # One for each of the latest messages.
    received: int = 0  # Number of all messages, and so of their events.
    refused: int = 0
    on_ports: tuple[Any, ...] = (NOTHING,) * len(COMMAND_PORTS)
    """Last message or refusal on each."""
    atlas_stamp: float | None = None  # Of the last accepted joint command [s].
    sim_stamp: float | None = None  # Of the last accepted behavior command [s].

    @property
    def request(self) -> BehaviorRequest:
        """The latest request."""
        return self.requests[-1]

    @property
    def k_effort(self) -> np.ndarray:
        """User's share per joint, 0 to 255, shape (n,)."""
        return self.joints.k_effort


def commands_at_start(
    robot: Robot, behavior: Behavior, catalog: BehaviorCatalog = SHIPPED
) -> ActiveCommand:
    """Returns the commands in force before any message.

    The joints' set-points are the stand-prep pose with the robot's default gains. In
    USER and NONE all joints are under user control, else under the behavior's.
    """
    zero = np.zeros(robot.num_joints)
    user = behavior in (Behavior.USER, Behavior.NONE)
    command = AtlasSimInterfaceCommand(behavior=behavior).freeze()
    return ActiveCommand(
        joints=JointCommand(
            position=robot.stand_prep,
            velocity=zero,
            effort=zero,
            kp_position=robot.default_kp,
            ki_position=zero,
            kd_position=robot.default_kd,
            kp_velocity=zero,
            i_effort_min=zero,
            i_effort_max=zero,
            k_effort=np.full(robot.num_joints, float(K_EFFORT_MAX if user else 0)),
        ),
        requests=(BehaviorRequest(behavior, command, number=0),),
        catalog=catalog,
    )


def merge_ports(
    previous: ActiveCommand, messages: Sequence[Any], robot: Robot, now: float
) -> ActiveCommand:
    """Applies those messages on the command ports that are new, in the ports' order.

    A port without a message has NOTHING.
    """
    for place, message in enumerate(messages):
        found = _new_on_port(previous, place, message, robot)
        if found is not None:
            last, outcome = found
            previous, _ = apply(previous, outcome, robot, now)
            on_ports = list(previous.on_ports)
            on_ports[place] = last
            previous = replace(previous, on_ports=tuple(on_ports))
    return previous


def _new_on_port(
    previous: ActiveCommand, place: int, message: Any, robot: Robot
) -> tuple[Any, Accepted | Refusal] | None:
    """Returns what to remember of a message on a port, and what the door says of it.

    None if the message is not new.
    """
    last = previous.on_ports[place]
    if message is NOTHING or message is last:
        return None
    outcome = accept(message, robot, previous.catalog, kind=_KINDS[place])
    if isinstance(message, Message) and message.is_frozen:
        return message, outcome
    # A message that may still change is compared in the form that the door gives it.
    found = outcome.message if isinstance(outcome, Accepted) else outcome
    return None if found == last else (found, outcome)


def apply(
    previous: ActiveCommand, outcome: Accepted | Refusal, robot: Robot, now: float
) -> tuple[ActiveCommand, Refusal | None]:
    """Applies a message that is new; also returns why it is refused, if it is.

    ``outcome`` is what the door says of the message.
    """
    number = previous.received + 1
    after = replace(previous, received=number)
    refusal = outcome if isinstance(outcome, Refusal) else None
    if isinstance(outcome, Accepted):
        try:
            after = _merged(after, outcome, robot, now)
        except InvalidMessageError as error:
            refusal = Refusal.of(error, outcome.kind)
    data: dict[str, Any] = {"number": number}
    if refusal is None:
        assert isinstance(outcome, Accepted)
        data["message"] = outcome.message
        event = Event(now, MESSAGE, outcome.kind.__name__, data)
    else:
        after = replace(after, error_code=refusal.error_code, refused=after.refused + 1)
        data |= {"command": refusal.kind.__name__, "field": refusal.field}
        event = Event(now, REFUSAL, f"refused: {refusal.error}", data)
    return replace(after, events=append_recent(after.events, event, KEPT)), refusal


def log_refusals(before: ActiveCommand, after: ActiveCommand) -> None:
    """Warns of messages refused since ``before``, once for a repeated fault."""
    refusals = [event for event in before.events if event.kind == REFUSAL]
    for event in items_since(after.events, after.received, before.received):
        if event.kind != REFUSAL:
            continue
        if not any(_repeats(event, earlier) for earlier in refusals):
            _log.warning("t = %.3f s: %s", event.time, event.text)
        refusals.append(event)


def _repeats(event: Event, earlier: Event) -> bool:
    is_same = all(event.data[key] == earlier.data[key] for key in ("command", "field"))
    return is_same and 0.0 <= event.time - earlier.time < SAME_FAULT


def _merged(
    previous: ActiveCommand, accepted: Accepted, robot: Robot, now: float
) -> ActiveCommand:
    """Merges a message with what is in force.

    Raises:
        InvalidMessageError: If the message contradicts what is in force.
    """
    message, given = accepted.message, accepted.joints
    stamp_field = "atlas_stamp" if accepted.kind is AtlasCommand else "sim_stamp"
    stamp, last = message.header.stamp, getattr(previous, stamp_field)
    # A stamp of 0 means "now", which is never too early.
    if stamp and last is not None and stamp < last:
        raise InvalidMessageError(
            "header.stamp",
            stamp,
            f"time ran backward: {stamp:g} s is earlier than {last:g} s, the stamp of "
            "the message before; 0 means now",
            ErrorCode.TIME_RAN_BACKWARD,
        )
    requests = previous.requests
    if isinstance(message, AtlasSimInterfaceCommand):
        behavior = previous.catalog.find(message.behavior)
        if behavior is Behavior.USER:
            # USER returns every joint to the user at once, for any k_effort.
            all_user = np.full(robot.num_joints, float(K_EFFORT_MAX))
            given = {**given, "k_effort": read_only(all_user)}
        request = BehaviorRequest(behavior, message, previous.received, now)
        requests = append_recent(requests, request, KEPT)
    # Keep the object when nothing changes, so that the joint law stays prepared.
    joints = replace(previous.joints, **given) if given else previous.joints
    # One of the two bounds may have been in force before.
    field = "i_effort_min" if "i_effort_min" in given else "i_effort_max"
    check_order(joints.i_effort_min, joints.i_effort_max, robot, field)
    return replace(
        previous,
        joints=joints,
        requests=requests,
        error_code=ErrorCode.NO_ERRORS,
        **{stamp_field: stamp or now},
    )
