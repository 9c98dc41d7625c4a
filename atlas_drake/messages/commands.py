"""The commands in force: all commands accepted so far, merged.

Pure functions on frozen values. Each message is checked completely before any part of
it is applied; a refused message changes nothing but the error code.
"""

import logging
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.frozen import NOTHING, Frozen, read_only, replace
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
    check_command,
)
from atlas_drake.messages.base import frozen, is_new
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.messages.checks import check_kind
from atlas_drake.messages.joint_command import JointCommand
from atlas_drake.messages.recent import append_recent, items_since
from atlas_drake.numeric import as_float
from atlas_drake.robot import Robot

_log = logging.getLogger(__name__)

Command = AtlasCommand | AtlasSimInterfaceCommand


@dataclass(frozen=True)
class Received(Frozen):
    """A message as received, accepted or refused.

    Attributes:
        time: Time of receipt [s].
        message: Snapshot of the message.
    """

    time: float
    message: Any


@dataclass(frozen=True)
class BehaviorRequest(Frozen):
    """The behavior command in force.

    Attributes:
        behavior: The requested behavior.
        command: Snapshot of the message.
        number: Number of the message among all received on both ports; increases from
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
class Refusal:
    """A message that was not applied.

    Attributes:
        time: Time of receipt [s].
        error: Reason of the refusal.
        port: Port of the message: ``atlas_command`` or ``sim_command``.
    """

    time: float
    error: InvalidMessageError
    port: str

    @property
    def place(self) -> tuple[str, str]:
        """Port and field at fault."""
        return self.port, self.error.field

    @property
    def error_code(self) -> ErrorCode:
        """Error code that the robot reports."""
        return self.error.error_code

    @property
    def text(self) -> str:
        """Text for the user."""
        return f"refused: {self.error}"


@dataclass(frozen=True)
class ActiveCommand(Frozen):
    """All values that commands have set.

    Attributes:
        joints: Set-points and gains of the PID bank, and the user's share per joint.
        requests: The latest requests to the behavior controller, oldest first.
        catalog: The behaviors that can be requested.
        error_code: Error code of the last message; NO_ERRORS if it was accepted.
        refusals: The latest refused messages, oldest first.
        refused: Number of all refused messages.
        messages: The latest messages, refused ones too, oldest first.
        received: Number of all messages.
        atlas_command: The joint command last read from the port, for ``is_new``;
            NOTHING at first.
        sim_command: The behavior command last read from the port; NOTHING at first.
        atlas_stamp: Time stamp of the last accepted joint command [s].
        sim_stamp: Time stamp of the last accepted behavior command [s].
    """

    joints: JointCommand
    requests: tuple[BehaviorRequest, ...]
    catalog: BehaviorCatalog = SHIPPED
    error_code: ErrorCode = ErrorCode.NO_ERRORS
    refusals: tuple[Refusal, ...] = ()
    refused: int = 0
    messages: tuple[Received, ...] = ()
    received: int = 0
    atlas_command: Any = NOTHING
    sim_command: Any = NOTHING
    atlas_stamp: float | None = None
    sim_stamp: float | None = None

    @property
    def request(self) -> BehaviorRequest:
        """The latest request."""
        return self.requests[-1]

    def messages_since(self, received: int) -> tuple[Received, ...]:
        """Returns the messages after the first ``received``."""
        return items_since(self.messages, self.received, received)

    def refusals_since(self, refused: int) -> tuple[Refusal, ...]:
        """Returns the refusals after the first ``refused``."""
        return items_since(self.refusals, self.refused, refused)

    @property
    def k_effort(self) -> np.ndarray:
        """User's share per joint, 0 to 255, shape (n,)."""
        return self.joints.k_effort


KEPT = 50
"""Number of messages, requests and refusals to keep; none younger than READ_WITHIN is
dropped."""


def commands_at_start(
    robot: Robot, behavior: Behavior, catalog: BehaviorCatalog = SHIPPED
) -> ActiveCommand:
    """Returns the commands in force before any message.

    The joints' set-points are the stand-prep pose with the robot's default gains. In
    USER and NONE all joints are under user control, else under the behavior's.
    """
    zero = np.zeros(robot.num_joints)
    user = behavior in (Behavior.USER, Behavior.NONE)
    command = AtlasSimInterfaceCommand()
    command.behavior = behavior
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
        requests=(BehaviorRequest(behavior, command.snapshot(), number=0),),
        catalog=catalog,
    )


def latch(
    force: ActiveCommand,
    atlas_command: Any,
    sim_command: Any,
    robot: Robot,
    time: float,
) -> ActiveCommand:
    """Applies the messages on the two command ports that ``is_new`` reports as new.

    When both are new the joint command is applied first, unless its stamp is later.

    Args:
        force: Commands in force so far.
        atlas_command: Joint command, a snapshot or not; NOTHING without a message.
        sim_command: Behavior command, a snapshot or not; NOTHING without a message.
        robot: The robot of the messages.
        time: Present time [s].
    """
    new = [
        (port, frozen(value))
        for port, value, seen in (
            ("atlas_command", atlas_command, force.atlas_command),
            ("sim_command", sim_command, force.sim_command),
        )
        if is_new(value, seen)
    ]
    if len(new) == 2 and _stamp(new[0][1]) > _stamp(new[1][1]):
        new.reverse()
    for port, value in new:
        force = replace(_take(force, port, value, robot, time), **{port: value})
    return force


def receive(
    force: ActiveCommand, message: Command, robot: Robot, time: float
) -> ActiveCommand:
    """Applies a message that is passed directly, and so is new in any case.

    Args:
        force: Commands in force so far.
        message: The message, a snapshot or not.
        robot: The robot of the message.
        time: Present time [s].
    """
    port = "atlas_command" if isinstance(message, AtlasCommand) else "sim_command"
    return _take(force, port, frozen(message), robot, time)


def _stamp(message: object) -> float:
    """Returns the time stamp of an unchecked message [s]; 0 if it has none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return as_float(stamp) or 0.0


def _take(
    force: ActiveCommand, port: str, message: Any, robot: Robot, time: float
) -> ActiveCommand:
    """Applies the message of one port, or records its refusal."""
    noted = replace(
        force,
        messages=append_recent(force.messages, Received(time, message), KEPT),
        received=force.received + 1,
    )
    try:
        return replace(
            _APPLY[port](noted, message, robot, time), error_code=ErrorCode.NO_ERRORS
        )
    except InvalidMessageError as error:
        refusal = Refusal(time, error.with_traceback(None), port)
        return replace(
            noted,
            error_code=error.error_code,
            refusals=append_recent(noted.refusals, refusal, KEPT),
            refused=noted.refused + 1,
        )


def log_refusals(before: ActiveCommand, after: ActiveCommand) -> None:
    """Warns of messages refused since ``before``, once for a repeated fault."""
    heard = {refusal.place: refusal.time for refusal in before.refusals}
    for refusal in after.refusals_since(before.refused):
        last = heard.get(refusal.place, -math.inf)
        if not 0.0 <= refusal.time - last < SAME_FAULT:
            _log.warning("t = %.3f s: %s", refusal.time, refusal.text)
        heard[refusal.place] = refusal.time


SAME_FAULT = 1.0
"""Time after which another refusal for the same field of a port is logged again [s]."""


def _apply_atlas_command(
    force: ActiveCommand, message: AtlasCommand, robot: Robot, time: float
) -> ActiveCommand:
    check_kind(message, AtlasCommand, "message")
    given = _given(message, force, robot, force.atlas_stamp)
    joints = replace(force.joints, **given)
    crossed = np.flatnonzero(joints.i_effort_min > joints.i_effort_max)
    if crossed.size:
        # The message has one of the two limits; the other was in force before.
        field = "i_effort_min" if "i_effort_min" in given else "i_effort_max"
        index = int(crossed[0])
        lower, upper = joints.i_effort_min[index], joints.i_effort_max[index]
        raise InvalidMessageError(
            f"{field}[{index}]",
            float(given[field][index]),
            f"would put i_effort_min ({lower:g}) above i_effort_max ({upper:g}), one "
            f"of which was in force before (joint {robot.joint_names[index]})",
        )
    return replace(force, joints=joints, atlas_stamp=message.header.stamp or time)


def _apply_sim_command(
    force: ActiveCommand,
    message: AtlasSimInterfaceCommand,
    robot: Robot,
    time: float,
) -> ActiveCommand:
    check_kind(message, AtlasSimInterfaceCommand, "message")
    given = _given(message, force, robot, force.sim_stamp)
    behavior = force.catalog.find(message.behavior)
    request = BehaviorRequest(behavior, message, force.received, time)
    if behavior is Behavior.USER:
        # USER returns every joint to the user at once, for any k_effort of the message.
        all_user = np.full(robot.num_joints, float(K_EFFORT_MAX))
        given["k_effort"] = read_only(all_user)
    return replace(
        force,
        # Keep the object when nothing changes, so that the joint law stays prepared.
        joints=replace(force.joints, **given) if given else force.joints,
        requests=append_recent(force.requests, request, KEPT),
        sim_stamp=message.header.stamp or time,
    )


_APPLY: dict[str, Callable[[ActiveCommand, Any, Robot, float], ActiveCommand]] = {
    "atlas_command": _apply_atlas_command,
    "sim_command": _apply_sim_command,
}
"""The function that applies a message, by port."""


def _given(
    message: Command, force: ActiveCommand, robot: Robot, stamp: float | None
) -> dict[str, np.ndarray]:
    """Checks a message; returns its joint arrays, with limited kp_velocity."""
    given = check_command(message, robot.joint_names, force.catalog, stamp)
    if "kp_velocity" in given:
        given["kp_velocity"] = np.minimum(given["kp_velocity"], robot.kp_velocity_limit)
    return read_only(given)
