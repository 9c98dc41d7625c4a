"""What is in force: the merge of all commands accepted so far.

Pure functions on frozen values. Each message is checked whole before anything of it
is applied; a refused message leaves everything as it was but for the error code.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from typing import Any, TypeVar

import numpy as np

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.frozen import NOTHING, Frozen, Nothing, replace
from atlas_drake.joint_command import JOINT_FIELDS, JointCommand
from atlas_drake.messages import (
    K_EFFORT_MAX,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Behavior,
    behavior_from,
    validate_atlas_command,
    validate_sim_interface_command,
)
from atlas_drake.robot import Robot

_log = logging.getLogger(__name__)

Command = AtlasCommand | AtlasSimInterfaceCommand
_T = TypeVar("_T")


@dataclass(frozen=True)
class BehaviorRequest(Frozen):
    """The behaviour command in force.

    Attributes:
        behavior: Asked for.
        command: The message, a snapshot.
        number: Counts accepted messages, so that a repeated request is noticed.
    """

    behavior: Behavior
    command: AtlasSimInterfaceCommand
    number: int


@dataclass(frozen=True)
class Refusal:
    """A message that was not applied.

    Attributes:
        time: At which it came [s].
        error: Why.
    """

    time: float
    error: InvalidMessageError

    @property
    def error_code(self) -> ErrorCode:
        """What the robot reports."""
        return self.error.error_code

    @property
    def text(self) -> str:
        """For the user."""
        return f"refused: {self.error}"


@dataclass(frozen=True)
class CommandsInForce(Frozen):
    """Everything that commands have set.

    Attributes:
        joints: For the PID bank, and who has which joint.
        requests: The latest for the behaviour controller, oldest first.
        error_code: Of the last message; NO_ERRORS once one is accepted.
        refusals: The latest refused messages, oldest first.
        refused: How many there were in all.
        messages: The latest messages, refused ones too, oldest first.
        received: How many there were in all.
        atlas_command: The last joint command looked at, to notice the next one.
        sim_command: The last behaviour command looked at.
        atlas_stamp: Time stamp of the last accepted joint command [s].
        sim_stamp: Time stamp of the last accepted behaviour command [s].
    """

    joints: JointCommand
    requests: tuple[BehaviorRequest, ...]
    error_code: ErrorCode = ErrorCode.NO_ERRORS
    refusals: tuple[Refusal, ...] = ()
    refused: int = 0
    messages: tuple[Command, ...] = ()
    received: int = 0
    atlas_command: AtlasCommand | Nothing = NOTHING
    sim_command: AtlasSimInterfaceCommand | Nothing = NOTHING
    atlas_stamp: float | None = None
    sim_stamp: float | None = None

    @property
    def request(self) -> BehaviorRequest:
        """The latest request."""
        return self.requests[-1]

    def messages_since(self, received: int) -> tuple[Command, ...]:
        """Those that came after the first ``received``, as far as they are kept."""
        return _last(self.messages, self.received - received)

    def refusals_since(self, refused: int) -> tuple[Refusal, ...]:
        """Those that came after the first ``refused``, as far as they are kept."""
        return _last(self.refusals, self.refused - refused)

    @property
    def k_effort(self) -> np.ndarray:
        """User's share per joint, 0 to 255, shape (n,)."""
        return self.joints.k_effort


def _last(items: tuple[_T, ...], count: int) -> tuple[_T, ...]:
    return items[-count:] if count else ()


SERVO_FIELDS = (
    "position",
    "velocity",
    "effort",
    "kp_position",
    "ki_position",
    "kp_velocity",
    "k_effort",
)
"""Joint arrays that a behaviour command has too; the later message counts."""

KEPT = 50
"""How many messages, requests and refusals are kept for whoever looks late."""


def commands_at_start(robot: Robot, behavior: Behavior) -> CommandsInForce:
    """What is in force before any command.

    The joints' set-points are the stand-prep pose with the robot's default gains.
    In behaviour USER all joints are the user's, else the behaviour's.
    """
    zero = np.zeros(robot.num_joints)
    user = behavior in (Behavior.USER, Behavior.NONE)
    command = AtlasSimInterfaceCommand()
    command.behavior = behavior
    return CommandsInForce(
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
    )


def latch(
    force: CommandsInForce,
    atlas_command: AtlasCommand | Nothing,
    sim_command: AtlasSimInterfaceCommand | Nothing,
    robot: Robot,
    time: float,
) -> CommandsInForce:
    """Takes in what the two command ports hold.

    A message counts as new when it is another object than the one seen before. When
    both are new the joint command is applied first, unless its stamp is later.

    Args:
        force: In force so far.
        atlas_command: A snapshot, or NOTHING when there is none yet.
        sim_command: Likewise.
        robot: Whose joints the messages are about.
        time: Now [s].
    """
    new_atlas = _is_new(atlas_command, force.atlas_command)
    new_sim = _is_new(sim_command, force.sim_command)
    if not (new_atlas or new_sim):
        return force
    if new_atlas and new_sim and _stamp(atlas_command) > _stamp(sim_command):
        force = _take(force, "sim_command", sim_command, robot, time)
        return _take(force, "atlas_command", atlas_command, robot, time)
    if new_atlas:
        force = _take(force, "atlas_command", atlas_command, robot, time)
    if new_sim:
        force = _take(force, "sim_command", sim_command, robot, time)
    return force


def _is_new(message: object, seen: object) -> bool:
    """Whether a port holds another message than the one seen before."""
    return message is not NOTHING and message is not seen


def _stamp(message: object) -> float:
    """When a message that is yet to be checked was sent [s]; 0 where it is silent."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return float(stamp) if isinstance(stamp, Real) else 0.0


def _take(
    force: CommandsInForce, port: str, message: Any, robot: Robot, time: float
) -> CommandsInForce:
    """Applies the message of one port, whatever it is, or notes why not."""
    seen = replace(
        force,
        messages=(*force.messages, message)[-KEPT:],
        received=force.received + 1,
        **{port: message},
    )
    try:
        return replace(
            _APPLY[port](seen, message, robot, time), error_code=ErrorCode.NO_ERRORS
        )
    except InvalidMessageError as error:
        refusal = Refusal(time, error.with_traceback(None))
        _log.warning("t = %.3f s: %s", time, refusal.text)
        return replace(
            seen,
            error_code=error.error_code,
            refusals=(*seen.refusals, refusal)[-KEPT:],
            refused=seen.refused + 1,
        )


def _apply_atlas_command(
    force: CommandsInForce, message: AtlasCommand, robot: Robot, time: float
) -> CommandsInForce:
    validate_atlas_command(message, robot.joint_names, force.atlas_stamp)
    given = _given(message, JOINT_FIELDS, robot)
    joints = replace(force.joints, **given)
    crossed = np.flatnonzero(joints.i_effort_min > joints.i_effort_max)
    if crossed.size:
        # The message has one of the two; the other is in force from before.
        field = "i_effort_min" if "i_effort_min" in given else "i_effort_max"
        index = int(crossed[0])
        lower, upper = joints.i_effort_min[index], joints.i_effort_max[index]
        raise InvalidMessageError(
            f"{field}[{index}]",
            float(given[field][index]),
            f"would put i_effort_min ({lower:g}) above i_effort_max ({upper:g}), one "
            f"of them in force from before (joint {robot.joint_names[index]})",
        )
    return replace(force, joints=joints, atlas_stamp=message.header.stamp or time)


def _apply_sim_command(
    force: CommandsInForce,
    message: AtlasSimInterfaceCommand,
    robot: Robot,
    time: float,
) -> CommandsInForce:
    validate_sim_interface_command(message, robot.joint_names, force.sim_stamp)
    behavior = behavior_from(message.behavior)
    request = BehaviorRequest(behavior, message, force.request.number + 1)
    given = _given(message, SERVO_FIELDS, robot)
    if behavior is Behavior.USER:
        # USER returns every joint to the user at once, whatever the message says.
        given["k_effort"] = np.full(robot.num_joints, float(K_EFFORT_MAX))
    return replace(
        force,
        # The same object when nothing changes, so that nothing is prepared anew.
        joints=replace(force.joints, **given) if given else force.joints,
        requests=(*force.requests, request)[-KEPT:],
        sim_stamp=message.header.stamp or time,
    )


_APPLY: dict[str, Callable[[CommandsInForce, Any, Robot, float], CommandsInForce]] = {
    "atlas_command": _apply_atlas_command,
    "sim_command": _apply_sim_command,
}
"""By the field that remembers the message."""


def _given(
    message: object, names: tuple[str, ...], robot: Robot
) -> dict[str, np.ndarray]:
    """Copies of a message's joint arrays that are not empty, as far as they count."""
    given = {
        name: np.array(getattr(message, name), dtype=float)
        for name in names
        if len(getattr(message, name))
    }
    if "kp_velocity" in given:
        given["kp_velocity"] = np.minimum(given["kp_velocity"], robot.kp_velocity_limit)
    return given
