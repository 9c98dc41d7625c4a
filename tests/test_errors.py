"""Errors: their texts, their attributes, and their common base."""

import pickle

import pytest

from atlas_drake.errors import (
    AtlasError,
    ErrorCode,
    InvalidMessageError,
    RobotDescriptionError,
    ScenarioError,
    did_you_mean,
)

ERRORS = [
    InvalidMessageError("k_effort[2]", 300, "must be 0 to 255", ErrorCode.UNSPECIFIED),
    ScenarioError("robot.name", "atlsa", "there is no such robot"),
    RobotDescriptionError("model", "hermes", "there is no such robot"),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_errors_share_a_base_and_survive_pickling(error):
    assert isinstance(error, AtlasError)
    assert isinstance(error, ValueError)
    twin = pickle.loads(pickle.dumps(error))
    assert type(twin) is type(error)
    assert str(twin) == str(error)
    assert vars(twin) == vars(error)


def test_errors_say_where_and_what():
    assert str(ERRORS[0]) == "k_effort[2]: must be 0 to 255"
    assert str(ERRORS[1]) == "robot.name: there is no such robot"
    assert ERRORS[0].value == 300
    assert ERRORS[0].error_code is ErrorCode.UNSPECIFIED


def test_suggestions():
    assert did_you_mean("atlsa", ["atlas", "atlas_v3"]) == " Did you mean 'atlas'?"
    assert did_you_mean("zebra", ["atlas", "atlas_v3"]) == ""
