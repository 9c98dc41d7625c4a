"""A controller's status as the state message reports it.

The controller knows nothing of messages that never reached it. What the robot measures
is added in ``systems.interface_reporter``, and in a log.
"""

from __future__ import annotations

from atlas_drake.errors import ErrorCode
from atlas_drake.frozen import replace
from atlas_drake.messages.behavior_feedback import AtlasBehaviorFeedback, BehaviorStatus
from atlas_drake.messages.commands import CommandsInForce
from atlas_drake.messages.controller_status import ControllerStatus, check_status


def reported_status(value: object, commands: CommandsInForce) -> ControllerStatus:
    """Returns the status with the errors of messages that were refused.

    Args:
        value: Value of a controller's status port.
        commands: The commands in force.

    Raises:
        TypeError: If the value is not a status.
        ValueError: If it names a behavior that is not registered.
    """
    status = check_status(value, commands.catalog)
    if commands.received != commands.request.number:
        # The last message is not the controller's last request.
        status = replace(status, error_code=commands.error_code)
    if commands.error_code is ErrorCode.NO_SUCH_BEHAVIOR:
        before = status.behavior_feedback
        feedback = AtlasBehaviorFeedback(
            before.status_flags | BehaviorStatus.FAILED_TRANS_UNKNOWN_BEHAVIOR,
            before.trans_from,
            before.trans_to,
        )
        status = replace(status, behavior_feedback=feedback)
    return status
