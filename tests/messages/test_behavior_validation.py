"""Refusals of faults in the parameters of behaviors."""

import numpy as np
import pytest

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorStepData,
    AtlasSimInterfaceCommand,
    validate_sim_interface_command,
)

JOINTS = ["neck", "knee", "wrist"]
QUEUE = "walk_params.step_queue"


def walk_command():
    """Return a command to walk four steps."""
    command = AtlasSimInterfaceCommand(behavior="walk")
    for i, step in enumerate(command.walk_params.step_queue):
        step.step_index = i + 1
        step.foot_index = i % 2
        step.duration = 0.63
        step.swing_height = 0.3
    return command


def refusal(command):
    """Return the error that a command raises on delivery."""
    with pytest.raises(InvalidMessageError) as caught:
        validate_sim_interface_command(command, JOINTS)
    return caught.value


def set_path(message, path, value):
    """Set a field by its dotted path."""
    *parents, name = path.split(".")
    for parent in parents:
        message = getattr(message, parent)
    setattr(message, name, value)


def test_a_walk_is_valid():
    validate_sim_interface_command(walk_command(), JOINTS)


def test_unknown_behavior():
    error = refusal(AtlasSimInterfaceCommand(behavior="stroll"))
    assert error.field == "behavior"
    assert error.error_code is ErrorCode.NO_SUCH_BEHAVIOR


@pytest.mark.parametrize(
    ("path", "value", "code"),
    [
        ("step_index", 0, ErrorCode.INVALID_INDEX),
        ("step_index", -2, ErrorCode.INVALID_INDEX),
        ("step_index", 3.5, ErrorCode.INVALID_INDEX),
        ("step_index", None, ErrorCode.INVALID_INDEX),
        ("step_index", True, ErrorCode.INVALID_INDEX),
        ("foot_index", 2, ErrorCode.INVALID_INDEX),
        ("foot_index", -1, ErrorCode.INVALID_INDEX),
        ("foot_index", 1.0, ErrorCode.INVALID_INDEX),
        ("foot_index", "left", ErrorCode.INVALID_INDEX),
        ("duration", 0.0, ErrorCode.VALUE_OUT_OF_RANGE),
        ("duration", -0.63, ErrorCode.VALUE_OUT_OF_RANGE),
        ("duration", float("inf"), ErrorCode.VALUE_OUT_OF_RANGE),
        ("duration", None, ErrorCode.VALUE_OUT_OF_RANGE),
        ("swing_height", -0.1, ErrorCode.VALUE_OUT_OF_RANGE),
        ("swing_height", float("nan"), ErrorCode.VALUE_OUT_OF_RANGE),
        ("pose", None, ErrorCode.VALUE_OUT_OF_RANGE),
        ("pose.position", [0.0, 0.0, 0.0], ErrorCode.VALUE_OUT_OF_RANGE),
        ("pose.position.y", float("nan"), ErrorCode.VALUE_OUT_OF_RANGE),
        ("pose.orientation", None, ErrorCode.VALUE_OUT_OF_RANGE),
        ("pose.orientation.z", float("inf"), ErrorCode.VALUE_OUT_OF_RANGE),
        ("pose.orientation.w", "1", ErrorCode.VALUE_OUT_OF_RANGE),
    ],
)
def test_a_bad_step_is_named_with_its_place(path, value, code):
    command = walk_command()
    set_path(command.walk_params.step_queue[2], path, value)
    error = refusal(command)
    assert error.field == f"{QUEUE}[2].{path}"
    assert error.error_code is code

    command = AtlasSimInterfaceCommand(behavior="step")
    command.step_params.desired_step = walk_command().walk_params.step_queue[0]
    set_path(command.step_params.desired_step, path, value)
    error = refusal(command)
    assert error.field == f"step_params.desired_step.{path}"
    assert error.error_code is code


@pytest.mark.parametrize("scale", [0.0, 1e-9])
def test_a_quaternion_without_direction(scale):
    command = walk_command()
    command.walk_params.step_queue[0].pose.orientation.w = scale
    error = refusal(command)
    assert error.field == f"{QUEUE}[0].pose.orientation"


def test_a_quaternion_need_not_have_norm_one():
    command = walk_command()
    command.walk_params.step_queue[0].pose.orientation.w = 0.3
    validate_sim_interface_command(command, JOINTS)


def test_of_an_empty_step_nothing_is_read():
    command = walk_command()
    empty = AtlasBehaviorStepData(step_index=NO_STEP, foot_index=7, duration=-1.0)
    command.walk_params.step_queue[3] = empty
    validate_sim_interface_command(command, JOINTS)


@pytest.mark.parametrize("indices", [(1, 1, 2, 3), (2, 1, 3, 4), (1, 2, 4, 3)])
def test_step_indices_must_increase(indices):
    command = walk_command()
    for step, index in zip(command.walk_params.step_queue, indices, strict=True):
        step.step_index = index
    error = refusal(command)
    assert error.field.endswith(".step_index")
    assert error.error_code is ErrorCode.INVALID_INDEX
    assert "must increase" in error.problem


def test_a_queue_may_begin_anywhere_and_indices_be_of_numpy():
    command = walk_command()
    for step in command.walk_params.step_queue:
        step.step_index = np.int64(step.step_index + 20)
        step.foot_index = np.uint8(step.foot_index)
    validate_sim_interface_command(command, JOINTS)


@pytest.mark.parametrize("length", [0, 3, 5])
def test_a_queue_of_another_length(length):
    command = walk_command()
    command.walk_params.step_queue = [AtlasBehaviorStepData()] * length
    error = refusal(command)
    assert error.field == QUEUE
    assert "must have 4 entries" in error.problem
    assert f"has {length}" in error.problem


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("walk_params", None),
        ("walk_params.step_queue", None),
        ("walk_params.step_queue", [None] * 4),
        ("walk_params.use_demo_walk", "no"),
        ("walk_params.use_demo_walk", 2),
        ("walk_params.use_relative_step_height", None),
        ("step_params", None),
        ("step_params.desired_step", None),
        ("step_params.use_demo_walk", 0.5),
        ("step_params.use_relative_step_height", [True]),
        ("stand_params", None),
        ("manipulate_params", None),
        ("manipulate_params.use_desired", "yes"),
        ("manipulate_params.use_demo_mode", None),
        ("manipulate_params.desired", None),
        ("manipulate_params.desired.pelvis_height", float("nan")),
        ("manipulate_params.desired.pelvis_yaw", float("inf")),
        ("manipulate_params.desired.pelvis_pitch", None),
        ("manipulate_params.desired.pelvis_roll", "0"),
        ("manipulate_params.desired.com_v0", float("nan")),
        ("manipulate_params.desired.com_v1", float("-inf")),
    ],
)
def test_a_bad_parameter_is_named(path, value):
    command = walk_command()
    set_path(command, path, value)
    assert refusal(command).field.startswith(path)


@pytest.mark.parametrize("flag", [True, False, 0, 1, np.True_])
def test_flags(flag):
    command = AtlasSimInterfaceCommand()
    command.manipulate_params.use_desired = flag
    validate_sim_interface_command(command, JOINTS)
