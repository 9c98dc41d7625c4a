"""The full form of a step: refusals by field name, and ignored fields."""

import numpy as np
import pytest

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorStepAction,
    AtlasSimInterfaceCommand,
    validate_sim_interface_command,
)

JOINTS = ["neck", "knee", "wrist"]
SPEC = "step_params.desired_step_spec"
NAN, INFINITY = float("nan"), float("inf")


def step_command():
    command = AtlasSimInterfaceCommand(behavior="step")
    command.step_params.use_spec = True
    command.step_params.desired_step_spec.step_index = 1
    return command


def set_path(message, path, value):
    *parents, name = path.split(".")
    for parent in parents:
        message = getattr(message, parent)
    setattr(message, name, value)


def test_the_constants_are_the_originals():
    action = AtlasBehaviorStepAction()
    assert (action.TOE_OFF_DISABLE, action.TOE_OFF_ENABLE) == (0, 1)
    assert action.TOE_OFF_FORCE_ENABLE == 2


def test_a_step_is_valid():
    command = step_command()
    validate_sim_interface_command(command, JOINTS)
    command.step_params.desired_step_spec.action.toe_off = np.int32(2)
    validate_sim_interface_command(command, JOINTS)


@pytest.mark.parametrize(
    "name",
    [
        "step_duration",
        "sway_duration",
        "swing_height",
        "lift_height",
        "knee_nominal",
        "max_body_accel",
        "max_foot_vel",
        "sway_end_dist",
        "step_end_dist",
    ],
)
@pytest.mark.parametrize("value", [NAN, INFINITY, -INFINITY, None, "0.3", True])
def test_a_bad_number_of_the_action_is_named(name, value):
    command = step_command()
    path = f"desired_step_spec.action.{name}"
    set_path(command.step_params, path, value)
    with pytest.raises(InvalidMessageError) as caught:
        validate_sim_interface_command(command, JOINTS)
    assert caught.value.field == f"step_params.{path}"
    assert caught.value.error_code is ErrorCode.VALUE_OUT_OF_RANGE


@pytest.mark.parametrize(
    ("path", "value", "code"),
    [
        ("step_index", 0, ErrorCode.INVALID_INDEX),
        ("foot_index", 2, ErrorCode.INVALID_INDEX),
        ("foot", None, ErrorCode.VALUE_OUT_OF_RANGE),
        ("foot.position.z", NAN, ErrorCode.VALUE_OUT_OF_RANGE),
        ("foot.position", (0.0, 0.0, 0.0), ErrorCode.VALUE_OUT_OF_RANGE),
        ("foot.yaw", INFINITY, ErrorCode.VALUE_OUT_OF_RANGE),
        ("foot.normal.x", NAN, ErrorCode.VALUE_OUT_OF_RANGE),
        ("foot.normal.z", 0.0, ErrorCode.VALUE_OUT_OF_RANGE),
        ("action", None, ErrorCode.VALUE_OUT_OF_RANGE),
        ("action.max_body_accel", -0.1, ErrorCode.VALUE_OUT_OF_RANGE),
        ("action.max_foot_vel", -0.1, ErrorCode.VALUE_OUT_OF_RANGE),
        ("action.toe_off", 3, ErrorCode.VALUE_OUT_OF_RANGE),
        ("action.toe_off", 1.0, ErrorCode.VALUE_OUT_OF_RANGE),
    ],
)
def test_a_bad_field_is_named(path, value, code):
    command = step_command()
    set_path(command.step_params.desired_step_spec, path, value)
    with pytest.raises(InvalidMessageError) as caught:
        validate_sim_interface_command(command, JOINTS)
    # A normal of no length is wrong as a whole.
    expected = "foot.normal" if path == "foot.normal.z" else path
    assert caught.value.field == f"{SPEC}.{expected}"
    assert caught.value.error_code is code


def test_what_a_threshold_rules_out_is_no_error():
    command = step_command()
    action = command.step_params.desired_step_spec.action
    action.sway_duration = action.swing_height = action.knee_nominal = -1.0
    action.sway_end_dist = 7.0
    validate_sim_interface_command(command, JOINTS)


def test_of_an_empty_step_nothing_is_read():
    command = step_command()
    spec = command.step_params.desired_step_spec
    spec.step_index, spec.foot_index, spec.foot.yaw = NO_STEP, 9, NAN
    validate_sim_interface_command(command, JOINTS)


@pytest.mark.parametrize("flag", [None, "yes", 2])
def test_the_choice_of_form_is_a_flag(flag):
    command = step_command()
    command.step_params.use_spec = flag
    with pytest.raises(InvalidMessageError) as caught:
        validate_sim_interface_command(command, JOINTS)
    assert caught.value.field == "step_params.use_spec"
