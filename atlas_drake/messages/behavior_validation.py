"""Validation of steps and pelvis poses, for any requested behavior.

The rest of a command is checked in ``validation``.
"""

import math

from atlas_drake.errors import ErrorCode, InvalidMessageError, shown
from atlas_drake.messages.behavior_params import (
    NO_STEP,
    NUM_REQUIRED_WALK_STEPS,
    AtlasBehaviorFootData,
    AtlasBehaviorManipulateParams,
    AtlasBehaviorPelvisServoParams,
    AtlasBehaviorStepAction,
    AtlasBehaviorStepData,
    AtlasBehaviorStepParams,
    AtlasBehaviorStepSpec,
    AtlasBehaviorWalkParams,
    ToeOff,
)
from atlas_drake.messages.checks import (
    MAX_INDEX,
    check_flag,
    check_kind,
    check_number,
)
from atlas_drake.messages.geometry import Pose, Quaternion, Vector3
from atlas_drake.numeric import is_whole

FEET = {0: "left", 1: "right"}
"""Foot indices."""

MIN_QUATERNION_NORM = 1e-6
"""Below this norm a quaternion's direction is rounding noise."""

MIN_NORMAL_LENGTH = 1e-6
"""Below this norm a ground normal's direction is rounding noise."""

_ACTION_FIELDS = (
    "step_duration",
    "sway_duration",
    "swing_height",
    "lift_height",
    "knee_nominal",
    "sway_end_dist",
    "step_end_dist",
)
_ACTION_BOUNDS = ("max_body_accel", "max_foot_vel")

_PELVIS_FIELDS = (
    "pelvis_height",
    "pelvis_yaw",
    "pelvis_pitch",
    "pelvis_roll",
    "com_v0",
    "com_v1",
)


def check_walk_params(params: AtlasBehaviorWalkParams) -> None:
    """Check the steps of WALK, empty ones included.

    Raises:
        InvalidMessageError: If a value cannot be applied; it names the field.
    """
    check_kind(params, AtlasBehaviorWalkParams, "walk_params")
    check_flag(params.use_demo_walk, "walk_params.use_demo_walk")
    check_flag(params.use_relative_step_height, "walk_params.use_relative_step_height")
    queue = params.step_queue
    field = "walk_params.step_queue"
    if not isinstance(queue, (list, tuple)):
        raise InvalidMessageError(
            field, queue, f"must be a list of steps, is {type(queue).__name__}"
        )
    if len(queue) != NUM_REQUIRED_WALK_STEPS:
        raise InvalidMessageError(
            field,
            queue,
            f"must have {NUM_REQUIRED_WALK_STEPS} entries, has {len(queue)}; an empty "
            "AtlasBehaviorStepData() is no step",
        )
    previous = 0
    for position, step in enumerate(queue):
        index = _check_step(step, f"{field}[{position}]")
        if index == NO_STEP:
            continue
        if index <= previous:
            raise InvalidMessageError(
                f"{field}[{position}].step_index",
                index,
                f"must increase from entry to entry, {index} follows {previous}",
                ErrorCode.INVALID_INDEX,
            )
        previous = index


def check_step_params(params: AtlasBehaviorStepParams) -> None:
    """Check the step of STEP in both its forms.

    Raises:
        InvalidMessageError: If a value cannot be applied; it names the field.
    """
    check_kind(params, AtlasBehaviorStepParams, "step_params")
    check_flag(params.use_spec, "step_params.use_spec")
    check_flag(params.use_demo_walk, "step_params.use_demo_walk")
    check_flag(params.use_relative_step_height, "step_params.use_relative_step_height")
    _check_step(params.desired_step, "step_params.desired_step")
    _check_spec(params.desired_step_spec, "step_params.desired_step_spec")


def check_manipulate_params(params: AtlasBehaviorManipulateParams) -> None:
    """Check the pelvis pose of MANIPULATE.

    Raises:
        InvalidMessageError: If a value cannot be applied; it names the field.
    """
    check_kind(params, AtlasBehaviorManipulateParams, "manipulate_params")
    check_flag(params.use_desired, "manipulate_params.use_desired")
    check_flag(params.use_demo_mode, "manipulate_params.use_demo_mode")
    field = "manipulate_params.desired"
    check_kind(params.desired, AtlasBehaviorPelvisServoParams, field)
    for name in _PELVIS_FIELDS:
        check_number(getattr(params.desired, name), f"{field}.{name}")


def _check_step(step: AtlasBehaviorStepData, field: str) -> int:
    """Check a step and return its index; only the index of an empty step is read."""
    check_kind(step, AtlasBehaviorStepData, field)
    if _check_indices(step, field) == NO_STEP:
        return NO_STEP
    check_number(step.duration, f"{field}.duration", 0.0, strictly=True)
    check_number(step.swing_height, f"{field}.swing_height", 0.0)
    _check_pose(step.pose, f"{field}.pose")
    return int(step.step_index)


def _check_spec(spec: AtlasBehaviorStepSpec, field: str) -> None:
    """Check a step in full; only the index of an empty step is read."""
    check_kind(spec, AtlasBehaviorStepSpec, field)
    if _check_indices(spec, field) == NO_STEP:
        return
    _check_foot(spec.foot, f"{field}.foot")
    _check_action(spec.action, f"{field}.action")


def _check_indices(
    step: AtlasBehaviorStepData | AtlasBehaviorStepSpec, field: str
) -> int:
    """Check and return the step index; the foot index counts only for a real step."""
    index = step.step_index
    if not is_whole(index) or not (1 <= index <= MAX_INDEX or index == NO_STEP):
        raise InvalidMessageError(
            f"{field}.step_index",
            step.step_index,
            f"must be a whole number from 1 on, or {NO_STEP} for no step, is "
            f"{shown(step.step_index)}",
            ErrorCode.INVALID_INDEX,
        )
    if step.step_index == NO_STEP:
        return NO_STEP
    if not is_whole(step.foot_index) or step.foot_index not in FEET:
        choice = " or ".join(f"{index} ({name})" for index, name in FEET.items())
        raise InvalidMessageError(
            f"{field}.foot_index",
            step.foot_index,
            f"must be {choice}, is {shown(step.foot_index)}",
            ErrorCode.INVALID_INDEX,
        )
    return int(step.step_index)


def _check_foot(foot: AtlasBehaviorFootData, field: str) -> None:
    check_kind(foot, AtlasBehaviorFootData, field)
    check_number(foot.yaw, f"{field}.yaw")
    for name in ("position", "normal"):
        vector = getattr(foot, name)
        check_kind(vector, Vector3, f"{field}.{name}")
        for axis in "xyz":
            check_number(getattr(vector, axis), f"{field}.{name}.{axis}")
    normal = foot.normal
    if math.hypot(normal.x, normal.y, normal.z) < MIN_NORMAL_LENGTH:
        raise InvalidMessageError(
            f"{field}.normal",
            normal,
            "must not be zero; x = y = 0, z = 1 is level ground",
        )


def _check_action(action: AtlasBehaviorStepAction, field: str) -> None:
    """Check that all values are finite; values beyond a threshold are not refused."""
    check_kind(action, AtlasBehaviorStepAction, field)
    for name in _ACTION_FIELDS:
        check_number(getattr(action, name), f"{field}.{name}")
    for name in _ACTION_BOUNDS:
        check_number(getattr(action, name), f"{field}.{name}", 0.0)
    known = {int(setting) for setting in ToeOff}
    if not is_whole(action.toe_off) or action.toe_off not in known:
        choice = ", ".join(f"{member.value} ({member.name})" for member in ToeOff)
        raise InvalidMessageError(
            f"{field}.toe_off",
            action.toe_off,
            f"must be one of {choice}, is {shown(action.toe_off)}",
        )


def _check_pose(pose: Pose, field: str) -> None:
    check_kind(pose, Pose, field)
    check_kind(pose.position, Vector3, f"{field}.position")
    for axis in "xyz":
        check_number(getattr(pose.position, axis), f"{field}.position.{axis}")
    check_kind(pose.orientation, Quaternion, f"{field}.orientation")
    norm = math.hypot(
        *(
            check_number(getattr(pose.orientation, axis), f"{field}.orientation.{axis}")
            for axis in "xyzw"
        )
    )
    if norm < MIN_QUATERNION_NORM:
        raise InvalidMessageError(
            f"{field}.orientation",
            pose.orientation,
            "must not be zero; x = y = z = 0, w = 1 is no rotation",
        )
