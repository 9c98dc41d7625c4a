"""Refusals of faults in commands, each with field, value and error code."""

from fractions import Fraction

import numpy as np
import pytest

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.messages import (
    NO_STEP,
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Header,
    check_command,
)

JOINTS = ["neck", "knee", "wrist"]
NAN, INFINITY = float("nan"), float("inf")
KINDS = [AtlasCommand, AtlasSimInterfaceCommand]
SHARED = ["position", "velocity", "effort", "kp_position", "ki_position", "kp_velocity"]
ONLY_JOINTS = ["kd_position", "i_effort_min", "i_effort_max"]
ARRAYS = [(kind, name) for kind in KINDS for name in (*SHARED, "k_effort")] + [
    (AtlasCommand, name) for name in ONLY_JOINTS
]
QUEUE = "walk_params.step_queue"
STEP, SPEC = "step_params.desired_step", "step_params.desired_step_spec"
INDEX, VALUE = ErrorCode.INVALID_INDEX, ErrorCode.VALUE_OUT_OF_RANGE


def refusal(message, previous_stamp=None):
    """Return the error that a message raises on delivery."""
    with pytest.raises(InvalidMessageError) as caught:
        check_command(message, JOINTS, previous_stamp=previous_stamp)
    assert str(caught.value).startswith(caught.value.field)
    return caught.value


def steps_command():
    """Return a command with four steps for WALK, and one for STEP in both forms."""
    command = AtlasSimInterfaceCommand(behavior="walk")
    for i, step in enumerate(command.walk_params.step_queue):
        step.step_index, step.foot_index = i + 1, i % 2
        step.duration, step.swing_height = 0.63, 0.3
    command.step_params.desired_step = AtlasBehaviorStepData(1, 0, 0.63)
    command.step_params.desired_step_spec.step_index = 1
    return command


def set_path(message, path, value):
    """Set a field by its path."""
    *parents, name = path.replace("[", ".").replace("]", "").split(".")
    for part in parents:
        message = message[int(part)] if part.isdigit() else getattr(message, part)
    setattr(message, name, value)


@pytest.mark.parametrize("kind", KINDS)
def test_an_empty_message_is_valid_and_so_is_its_snapshot(kind):
    assert check_command(kind(), JOINTS) == {}
    assert check_command(kind().snapshot(), JOINTS) == {}


@pytest.mark.parametrize(("kind", "name"), ARRAYS)
def test_arrays_of_numbers_of_any_type_are_taken(kind, name):
    for values in (
        [0, 1, 2],
        (0.0, 1.0, 2.0),
        np.array([0.0, 1.0, 2.0]),
        np.array([0, 1, 2], dtype=np.uint8),
        [np.float32(0.0), Fraction(1), 2],
    ):
        message = kind(**{name: values})
        given = check_command(message, JOINTS)
        assert {key: array.tolist() for key, array in given.items()} == {
            name: [0, 1, 2]
        }
        assert getattr(message, name) is values
        assert check_command(message.snapshot(), JOINTS).keys() == {name}
    assert check_command(kind(**{name: np.zeros(0)}), JOINTS) == {}


@pytest.mark.parametrize(("kind", "name"), ARRAYS)
def test_an_array_of_another_length_is_refused_with_both_lengths(kind, name):
    for length in (1, 2, 4, 28):
        error = refusal(kind(**{name: [1.0] * length}))
        assert (error.field, error.error_code) == (name, VALUE)
        assert f"must have 3 elements, one per joint, or none, has {length}" in str(
            error
        )


@pytest.mark.parametrize(("kind", "name"), ARRAYS)
def test_a_bad_element_is_named_with_its_index_and_joint(kind, name):
    for bad, problem in (
        (NAN, "finite"),
        (-INFINITY, "finite"),
        (10**400, "finite"),
        (1e13, "within"),
        (None, "must be a number"),
        ("1.0", "must be a number"),
        (True, "must be a number"),
        (np.True_, "must be a number"),
        (1j, "must be a number"),
        ([1.0], "must be a number"),
    ):
        error = refusal(kind(**{name: [1.0, bad, 1.0]}))
        assert error.field == f"{name}[1]"
        assert problem in error.problem
        assert "joint knee" in error.problem
        assert error.value is bad


@pytest.mark.parametrize(("kind", "name"), ARRAYS)
def test_values_that_are_no_list_of_numbers_are_refused(kind, name):
    masked = np.ma.array([0.0] * 3, mask=[True, False, False])
    for values in (None, 1.0, "abc", {0: 1.0}, np.ones((3, 1)), np.array(1.0), masked):
        assert refusal(kind(**{name: values})).field == name
    for values in (np.array([True] * 3), np.array(["a", "b", "c"])):
        assert refusal(kind(**{name: values})).field == f"{name}[0]"


@pytest.mark.parametrize(("kind", "name"), ARRAYS)
def test_gains_are_not_negative_and_set_points_may_be(kind, name):
    message = kind(**{name: [0.0, 0.0, -1e-9]})
    if name.startswith("k"):
        assert refusal(message).field == f"{name}[2]"
    else:
        check_command(message, JOINTS)


@pytest.mark.parametrize("kind", KINDS)
def test_k_effort_is_a_whole_number_of_one_byte(kind):
    for bad in (-1, 256, 1e9, 0.5, 254.999):
        error = refusal(kind(k_effort=[0, 255, bad]))
        assert (error.field, error.value) == ("k_effort[2]", bad)
    check_command(kind(k_effort=[0, 128.0, 255]), JOINTS)


def test_integral_bounds_must_not_cross():
    lower, upper = [-1.0, 2.0, 0.0], [1.0, 1.0, 0.0]
    error = refusal(AtlasCommand(i_effort_min=lower, i_effort_max=upper))
    assert error.field == "i_effort_min[1]"
    assert "joint knee" in error.problem
    check_command(AtlasCommand(i_effort_min=lower), JOINTS)
    check_command(AtlasCommand(i_effort_max=upper), JOINTS)


def test_the_controller_period_is_a_whole_number_of_one_byte():
    for period in (0, 5, 255, np.uint8(3)):
        check_command(AtlasCommand(desired_controller_period_ms=period), JOINTS)
    for period in (-1, 256, 0.5, None, NAN, True):
        error = refusal(AtlasCommand(desired_controller_period_ms=period))
        assert error.field == "desired_controller_period_ms"


@pytest.mark.parametrize("kind", KINDS)
def test_time_may_stand_still_but_not_run_backward(kind):
    for stamp in (None, 0, 0.0, 2.0, 2.5, np.float64(3.0)):
        check_command(kind(header=Header(stamp=stamp)), JOINTS, previous_stamp=2.0)
    message = kind(header=Header(stamp=1.999))
    check_command(message, JOINTS)
    error = refusal(message, previous_stamp=2.0)
    assert error.field == "header.stamp"
    assert error.error_code is ErrorCode.TIME_RAN_BACKWARD
    for stamp in (-1.0, NAN, INFINITY, "now", True):
        assert refusal(kind(header=Header(stamp=stamp))).field == "header.stamp"
    assert refusal(kind(header=1.5)).field == "header"


def test_an_unknown_behavior_is_refused():
    error = refusal(AtlasSimInterfaceCommand(behavior="stroll"))
    assert error.field == "behavior"
    assert error.error_code is ErrorCode.NO_SUCH_BEHAVIOR


# Steps and parameters. ``steps_command`` is valid but for the field that a test sets.


@pytest.mark.parametrize("step", [f"{QUEUE}[2]", STEP])
@pytest.mark.parametrize(
    ("path", "values", "code"),
    [
        ("step_index", [0, -2, 3.5, None, True], INDEX),
        ("foot_index", [2, -1, 1.0, "left"], INDEX),
        ("duration", [0.0, -0.63, INFINITY, None], VALUE),
        ("swing_height", [-0.1, NAN], VALUE),
        ("pose", [None], VALUE),
        ("pose.position", [[0.0, 0.0, 0.0]], VALUE),
        ("pose.position.y", [NAN, -1e13, 1e13], VALUE),
        ("pose.orientation", [None], VALUE),
        ("pose.orientation.z", [INFINITY], VALUE),
        ("pose.orientation.w", ["1"], VALUE),
    ],
)
def test_a_bad_step_is_named_with_its_place(step, path, values, code):
    for value in values:
        command = steps_command()
        set_path(command, f"{step}.{path}", value)
        error = refusal(command)
        assert (error.field, error.error_code) == (f"{step}.{path}", code)


@pytest.mark.parametrize(
    ("path", "values", "code"),
    [
        ("step_index", [0], INDEX),
        ("foot_index", [2], INDEX),
        ("foot", [None], VALUE),
        ("foot.position.z", [NAN], VALUE),
        ("foot.position", [(0.0, 0.0, 0.0)], VALUE),
        ("foot.yaw", [INFINITY], VALUE),
        ("foot.normal.x", [NAN], VALUE),
        ("action", [None], VALUE),
        ("action.max_body_accel", [-0.1], VALUE),
        ("action.max_foot_vel", [-0.1], VALUE),
        ("action.toe_off", [3, 1.0], VALUE),
        *(
            (f"action.{name}", [NAN, -INFINITY, None, "0.3", True], VALUE)
            for name in (
                "step_duration",
                "sway_duration",
                "swing_height",
                "lift_height",
                "knee_nominal",
                "max_body_accel",
                "max_foot_vel",
                "sway_end_dist",
                "step_end_dist",
            )
        ),
    ],
)
def test_a_bad_field_of_the_full_form_of_a_step_is_named(path, values, code):
    for value in values:
        command = steps_command()
        set_path(command, f"{SPEC}.{path}", value)
        error = refusal(command)
        assert (error.field, error.error_code) == (f"{SPEC}.{path}", code)


@pytest.mark.parametrize(
    ("path", "values"),
    [
        ("walk_params", [None]),
        (QUEUE, [None]),
        ("walk_params.use_demo_walk", ["no", 2]),
        ("walk_params.use_relative_step_height", [None]),
        ("step_params", [None]),
        (STEP, [None]),
        ("step_params.use_spec", [None, "yes", 2]),
        ("step_params.use_demo_walk", [0.5]),
        ("step_params.use_relative_step_height", [[True]]),
        ("stand_params", [None]),
        ("manipulate_params", [None]),
        ("manipulate_params.use_desired", ["yes"]),
        ("manipulate_params.use_demo_mode", [None]),
        ("manipulate_params.desired", [None]),
        ("manipulate_params.desired.pelvis_height", [NAN]),
        ("manipulate_params.desired.pelvis_yaw", [INFINITY]),
        ("manipulate_params.desired.pelvis_pitch", [None]),
        ("manipulate_params.desired.pelvis_roll", ["0"]),
        ("manipulate_params.desired.com_v0", [NAN]),
        ("manipulate_params.desired.com_v1", [-INFINITY]),
    ],
)
def test_a_bad_parameter_is_named(path, values):
    for value in values:
        command = steps_command()
        set_path(command, path, value)
        assert refusal(command).field == path


def test_directions_have_a_length():
    for path, value in (
        (f"{QUEUE}[0].pose.orientation", "w"),
        (f"{STEP}.pose.orientation", "w"),
        (f"{SPEC}.foot.normal", "z"),
    ):
        for length in (0.0, 1e-9):
            command = steps_command()
            set_path(command, f"{path}.{value}", length)
            assert refusal(command).field == path
        set_path(command, f"{path}.{value}", 0.3)
        check_command(command, JOINTS)


def test_of_an_empty_step_nothing_is_read():
    command = steps_command()
    empty = AtlasBehaviorStepData(step_index=NO_STEP, foot_index=7, duration=-1.0)
    command.walk_params.step_queue[3] = empty
    spec = command.step_params.desired_step_spec
    spec.step_index, spec.foot_index, spec.foot.yaw = NO_STEP, 9, NAN
    check_command(command, JOINTS)


@pytest.mark.parametrize("indices", [(1, 1, 2, 3), (2, 1, 3, 4), (1, 2, 4, 3)])
def test_step_indices_must_increase(indices):
    command = steps_command()
    for step, index in zip(command.walk_params.step_queue, indices, strict=True):
        step.step_index = index
    error = refusal(command)
    assert error.field.endswith(".step_index")
    assert error.error_code is INDEX
    assert "must increase" in error.problem


def test_a_queue_of_another_length_is_refused():
    for length in (0, 3, 5):
        command = steps_command()
        command.walk_params.step_queue = [AtlasBehaviorStepData()] * length
        error = refusal(command)
        assert error.field == QUEUE
        assert f"must have 4 entries, has {length}" in error.problem
    command.walk_params.step_queue = [None] * 4
    assert refusal(command).field == f"{QUEUE}[0]"


def test_indices_begin_anywhere_and_numbers_may_be_of_numpy():
    command = steps_command()
    for step in command.walk_params.step_queue:
        step.step_index = np.int64(step.step_index + 20)
        step.foot_index = np.uint8(step.foot_index)
    action = command.step_params.desired_step_spec.action
    action.toe_off = np.int32(2)
    # A value below its threshold is ignored.
    action.sway_duration = action.swing_height = action.knee_nominal = -1.0
    action.sway_end_dist = 7.0
    for flag in (True, False, 0, 1, np.True_):
        command.manipulate_params.use_desired = flag
        check_command(command, JOINTS)
