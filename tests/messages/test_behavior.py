"""Behaviors by number and by name."""

import json

import numpy as np
import pytest

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.messages import (
    AtlasSimInterfaceCommand,
    AtlasSimInterfaceState,
    Behavior,
)
from atlas_drake.messages.behavior_catalog import SHIPPED
from atlas_drake.records.plain import to_plain

NUMBERS = {
    "NONE": 0,
    "FREEZE": 1,
    "STAND_PREP": 2,
    "STAND": 3,
    "WALK": 4,
    "STEP": 5,
    "MANIPULATE": 6,
    "USER": 7,
}


def test_a_behavior_is_printed_by_name_and_kept_as_a_number():
    stand = Behavior.STAND
    assert (str(stand), f"{stand}", f"{stand:>6}") == ("STAND", "STAND", " STAND")
    assert (f"{stand:03d}", f"{stand:>7}") == ("003", "  STAND")
    assert (f"{stand:d}", "%d" % stand, int(stand)) == ("3", "3", 3)  # noqa: UP031
    assert json.dumps([stand]) == "[3]"
    assert to_plain(stand) == 3
    assert np.array([stand]).tolist() == [3]


@pytest.mark.parametrize("kind", [AtlasSimInterfaceCommand, AtlasSimInterfaceState])
def test_messages_have_the_behaviors_of_the_interface_as_constants(kind):
    assert {member.name: member.value for member in Behavior} == NUMBERS
    for name, number in NUMBERS.items():
        assert getattr(kind, name) == number
        assert getattr(kind(), name) is Behavior(number)


@pytest.mark.parametrize(
    "value",
    [
        *(2, np.int64(2), np.uint8(2), Behavior.STAND_PREP),
        *("STAND_PREP", "stand_prep", "Stand_Prep", "stand-prep", " stand prep "),
    ],
)
def test_a_behavior_is_found_by_number_and_by_name(value):
    assert SHIPPED.find(value) is Behavior.STAND_PREP


@pytest.mark.parametrize(
    "value", [8, -1, 3.0, True, None, "", "3", [3], np.array([3]), b"stand"]
)
def test_an_unknown_behavior_is_refused_with_the_known_names(value):
    with pytest.raises(InvalidMessageError) as caught:
        SHIPPED.find(value, "desired")
    assert caught.value.error_code is ErrorCode.NO_SUCH_BEHAVIOR
    assert caught.value.field == "desired"
    assert all(name in str(caught.value) for name in NUMBERS)


def test_misspelt_behavior_gets_a_suggestion():
    with pytest.raises(InvalidMessageError, match="Did you mean 'MANIPULATE'"):
        SHIPPED.find("manipulat")
