"""Refusals of faults in commands, each with field, value and error code."""

from fractions import Fraction

import numpy as np
import pytest

from atlas_drake.errors import AtlasError, ErrorCode, InvalidMessageError
from atlas_drake.messages import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    Header,
    validate_atlas_command,
    validate_sim_interface_command,
)

JOINTS = ["neck", "knee", "wrist"]
KINDS = {
    AtlasCommand: validate_atlas_command,
    AtlasSimInterfaceCommand: validate_sim_interface_command,
}
SETPOINTS = ["position", "velocity", "effort"]
GAINS = ["kp_position", "ki_position", "kd_position", "kp_velocity"]
INTEGRAL_BOUNDS = ["i_effort_min", "i_effort_max"]
ARRAYS = {
    AtlasCommand: [*SETPOINTS, *GAINS, *INTEGRAL_BOUNDS, "k_effort"],
    AtlasSimInterfaceCommand: [
        *SETPOINTS,
        "kp_position",
        "ki_position",
        "kp_velocity",
        "k_effort",
    ],
}
ALL_ARRAYS = [(kind, name) for kind, names in ARRAYS.items() for name in names]


def refusal(message, previous_stamp=None):
    """Return the error that a message raises on delivery."""
    with pytest.raises(InvalidMessageError) as caught:
        KINDS[type(message)](message, JOINTS, previous_stamp)
    assert isinstance(caught.value, AtlasError)
    assert isinstance(caught.value, ValueError)
    assert str(caught.value).startswith(caught.value.field)
    return caught.value


@pytest.mark.parametrize("kind", KINDS)
def test_an_empty_message_is_valid_and_so_is_its_snapshot(kind):
    KINDS[kind](kind(), JOINTS)
    KINDS[kind](kind().snapshot(), JOINTS)


@pytest.mark.parametrize(("kind", "name"), ALL_ARRAYS)
@pytest.mark.parametrize(
    "values",
    [
        [0, 1, 2],
        (0.0, 1.0, 2.0),
        np.array([0.0, 1.0, 2.0]),
        np.array([0, 1, 2], dtype=np.uint8),
        [np.float32(0.0), Fraction(1), 2],
        [],
        np.zeros(0),
    ],
    ids=repr,
)
def test_good_arrays(kind, name, values):
    KINDS[kind](kind(**{name: values}), JOINTS)


@pytest.mark.parametrize(("kind", "name"), ALL_ARRAYS)
@pytest.mark.parametrize("length", [1, 2, 4, 28])
def test_wrong_length_names_the_field_and_both_lengths(kind, name, length):
    error = refusal(kind(**{name: [1.0] * length}))
    assert error.field == name
    assert error.error_code is ErrorCode.VALUE_OUT_OF_RANGE
    assert "must have 3 elements" in error.problem
    assert f"has {length}" in error.problem


@pytest.mark.parametrize(("kind", "name"), ALL_ARRAYS)
@pytest.mark.parametrize(
    ("bad", "problem"),
    [
        (float("nan"), "finite"),
        (float("inf"), "finite"),
        (-float("inf"), "finite"),
        (10**400, "finite"),
        (-(10**400), "finite"),
        (1e13, "within"),
        (None, "must be a number"),
        ("1.0", "must be a number"),
        (True, "must be a number"),
        (np.True_, "must be a number"),
        (1j, "must be a number"),
        ([1.0], "must be a number"),
    ],
    ids=lambda value: repr(value)[:12],
)
def test_bad_element_names_its_index_and_joint(kind, name, bad, problem):
    error = refusal(kind(**{name: [1.0, bad, 1.0]}))
    assert error.field == f"{name}[1]"
    assert problem in error.problem
    assert "joint knee" in error.problem
    assert error.value is bad


@pytest.mark.parametrize(("kind", "name"), ALL_ARRAYS)
@pytest.mark.parametrize(
    "values", [None, 1.0, "abc", {0: 1.0}, np.ones((3, 1)), np.array(1.0)], ids=repr
)
def test_what_is_no_list_of_numbers(kind, name, values):
    assert refusal(kind(**{name: values})).field == name


@pytest.mark.parametrize("array", [np.array([True] * 3), np.array(["a", "b", "c"])])
def test_arrays_of_other_things_than_numbers(array):
    assert refusal(AtlasCommand(position=array)).field == "position[0]"


@pytest.mark.parametrize(
    ("kind", "name"), [pair for pair in ALL_ARRAYS if pair[1] in GAINS]
)
def test_negative_gain(kind, name):
    error = refusal(kind(**{name: [0.0, 0.0, -1e-9]}))
    assert error.field == f"{name}[2]"
    assert "at least 0" in error.problem


@pytest.mark.parametrize("name", SETPOINTS + INTEGRAL_BOUNDS)
def test_setpoints_may_be_negative(name):
    validate_atlas_command(AtlasCommand(**{name: [-1.0, -2.0, -3.0]}), JOINTS)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("bad", [-1, 256, 1e9, 0.5, 254.999])
def test_k_effort_is_a_whole_number_of_one_byte(kind, bad):
    error = refusal(kind(k_effort=[0, 255, bad]))
    assert error.field == "k_effort[2]"
    assert error.value == bad


@pytest.mark.parametrize("kind", KINDS)
def test_k_effort_may_blend(kind):
    KINDS[kind](kind(k_effort=[0, 128.0, 255]), JOINTS)


def test_integral_bounds_must_not_cross():
    lower, upper = [-1.0, 2.0, 0.0], [1.0, 1.0, 0.0]
    error = refusal(AtlasCommand(i_effort_min=lower, i_effort_max=upper))
    assert error.field == "i_effort_min[1]"
    assert "joint knee" in error.problem
    validate_atlas_command(AtlasCommand(i_effort_min=lower), JOINTS)
    validate_atlas_command(AtlasCommand(i_effort_max=upper), JOINTS)


@pytest.mark.parametrize("period", [0, 5, 255, np.uint8(3)])
def test_controller_period(period):
    validate_atlas_command(AtlasCommand(desired_controller_period_ms=period), JOINTS)


@pytest.mark.parametrize("period", [-1, 256, 0.5, None, float("nan"), True])
def test_bad_controller_period(period):
    error = refusal(AtlasCommand(desired_controller_period_ms=period))
    assert error.field == "desired_controller_period_ms"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("stamp", [None, 0, 0.0, 2.0, 2.5, np.float64(3.0)])
def test_time_may_stand_still_or_be_left_out(kind, stamp):
    KINDS[kind](kind(header=Header(stamp=stamp)), JOINTS, previous_stamp=2.0)


@pytest.mark.parametrize("kind", KINDS)
def test_time_must_not_run_backward(kind):
    message = kind(header=Header(stamp=1.999))
    KINDS[kind](message, JOINTS)
    error = refusal(message, previous_stamp=2.0)
    assert error.field == "header.stamp"
    assert error.error_code is ErrorCode.TIME_RAN_BACKWARD


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("stamp", [-1.0, float("nan"), float("inf"), "now", True])
def test_bad_stamp(kind, stamp):
    assert refusal(kind(header=Header(stamp=stamp))).field == "header.stamp"


@pytest.mark.parametrize("kind", KINDS)
def test_header_must_be_one(kind):
    assert refusal(kind(header=1.5)).field == "header"


def test_a_message_of_the_other_kind_is_refused():
    with pytest.raises(InvalidMessageError, match="must be AtlasCommand, is AtlasSim"):
        validate_atlas_command(AtlasSimInterfaceCommand(), JOINTS)
    with pytest.raises(InvalidMessageError, match="is AtlasCommand"):
        validate_sim_interface_command(AtlasCommand(), JOINTS)
