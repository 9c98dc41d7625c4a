"""Validation of messages, on delivery and before any value is applied.

Single values are checked in ``checks``, steps and poses in ``behavior_validation``. The
behaviors refuse commands that contradict the state of the robot, such as a transition
that is not allowed.
"""

from collections.abc import Sequence

import numpy as np

from atlas_drake.errors import ErrorCode, InvalidMessageError, shown
from atlas_drake.messages.atlas_command import AtlasCommand
from atlas_drake.messages.atlas_sim_interface_command import AtlasSimInterfaceCommand
from atlas_drake.messages.behavior import Behavior
from atlas_drake.messages.behavior_catalog import SHIPPED, BehaviorCatalog
from atlas_drake.messages.checks import check_joint_array, check_kind, check_number
from atlas_drake.messages.geometry import Header

K_EFFORT_MAX = 255
"""``k_effort`` of a joint that the user controls alone."""

CONTROLLER_PERIOD_MAX_MS = 255
"""Longest controller period in a message [ms]: the field is one byte."""

_SETPOINTS = ("position", "velocity", "effort")
_GAINS = ("kp_position", "ki_position", "kd_position", "kp_velocity")
_SERVO_GAINS = ("kp_position", "ki_position", "kp_velocity")


def check_command(
    message: AtlasCommand | AtlasSimInterfaceCommand,
    joint_names: Sequence[str],
    catalog: BehaviorCatalog = SHIPPED,
) -> None:
    """Check a command of either kind, independent of earlier commands.

    Args:
        message: The command.
        joint_names: The robot's joints in message order.
        catalog: The behaviors that can be requested.

    Raises:
        InvalidMessageError: If a value cannot be applied; it names the field.
    """
    if isinstance(message, AtlasCommand):
        validate_atlas_command(message, joint_names)
    else:
        validate_sim_interface_command(message, joint_names, catalog=catalog)


def validate_atlas_command(
    message: AtlasCommand,
    joint_names: Sequence[str],
    previous_stamp: float | None = None,
) -> None:
    """Check a command to the joint controllers.

    An ``i_effort_min`` above an ``i_effort_max`` is found only if the message has both;
    ``commands`` checks a message with one of them against the value in force.

    Args:
        message: The command.
        joint_names: The robot's joints in message order.
        previous_stamp: Stamp of the last accepted ``AtlasCommand`` [s], if any.

    Raises:
        InvalidMessageError: If a value cannot be applied; it names the field.
    """
    check_kind(message, AtlasCommand, "message")
    _check_header(message.header, previous_stamp)
    for name in _SETPOINTS:
        check_joint_array(getattr(message, name), name, joint_names)
    for name in _GAINS:
        check_joint_array(getattr(message, name), name, joint_names, lower=0.0)
    _check_integral_bounds(message, joint_names)
    _check_k_effort(message.k_effort, joint_names)
    period = check_number(
        message.desired_controller_period_ms, "desired_controller_period_ms", 0.0
    )
    if period > CONTROLLER_PERIOD_MAX_MS or not period.is_integer():
        raise InvalidMessageError(
            "desired_controller_period_ms",
            message.desired_controller_period_ms,
            f"must be a whole number of milliseconds, 0 to {CONTROLLER_PERIOD_MAX_MS}, "
            f"is {shown(message.desired_controller_period_ms)}",
        )


def validate_sim_interface_command(
    message: AtlasSimInterfaceCommand,
    joint_names: Sequence[str],
    previous_stamp: float | None = None,
    catalog: BehaviorCatalog = SHIPPED,
) -> Behavior:
    """Check a command to the behaviors, the parameters of all behaviors included.

    Args:
        message: The command.
        joint_names: The robot's joints in message order.
        previous_stamp: Stamp of the last accepted ``AtlasSimInterfaceCommand`` [s],
            if any.
        catalog: The behaviors that can be requested.

    Returns:
        The behavior that the command requests.

    Raises:
        InvalidMessageError: If a value cannot be applied; it names the field.
    """
    check_kind(message, AtlasSimInterfaceCommand, "message")
    _check_header(message.header, previous_stamp)
    behavior = catalog.check_params(message)
    for name in _SETPOINTS:
        check_joint_array(getattr(message, name), name, joint_names)
    for name in _SERVO_GAINS:
        check_joint_array(getattr(message, name), name, joint_names, lower=0.0)
    _check_k_effort(message.k_effort, joint_names)
    return behavior


def _check_header(header: Header, previous_stamp: float | None) -> None:
    check_kind(header, Header, "header")
    if header.stamp is None:
        return
    stamp = check_number(header.stamp, "header.stamp", 0.0)
    # A stamp of 0 means "now", which is never too early.
    if previous_stamp is not None and 0.0 < stamp < previous_stamp:
        raise InvalidMessageError(
            "header.stamp",
            header.stamp,
            f"time ran backward: {stamp:g} s is earlier than {previous_stamp:g} s, "
            "the stamp of the message before; 0 means now",
            ErrorCode.TIME_RAN_BACKWARD,
        )


def _check_k_effort(values: object, joint_names: Sequence[str]) -> None:
    check_joint_array(
        values, "k_effort", joint_names, lower=0.0, upper=K_EFFORT_MAX, whole=True
    )


def _check_integral_bounds(message: AtlasCommand, joint_names: Sequence[str]) -> None:
    lower = check_joint_array(message.i_effort_min, "i_effort_min", joint_names)
    upper = check_joint_array(message.i_effort_max, "i_effort_max", joint_names)
    if len(lower) == 0 or len(upper) == 0:
        return
    crossed = lower > upper
    if crossed.any():
        index = int(np.argmax(crossed))
        raise InvalidMessageError(
            f"i_effort_min[{index}]",
            lower[index],
            f"must be at most i_effort_max, {lower[index]:g} is greater than "
            f"{upper[index]:g} (joint {joint_names[index]})",
        )
