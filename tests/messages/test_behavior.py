"""Behaviors by number and by name."""

import json
import pickle

import numpy as np
import pytest

from atlas_drake.errors import ErrorCode, InvalidMessageError
from atlas_drake.messages import Behavior
from atlas_drake.messages.behavior_catalog import SHIPPED
from atlas_drake.records.plain import to_plain


def test_a_behavior_is_printed_by_name_and_kept_as_a_number():
    stand = Behavior.STAND
    assert (str(stand), f"{stand}", f"{stand:>6}") == ("STAND", "STAND", " STAND")
    assert ("%d" % stand, int(stand)) == ("3", 3)  # noqa: UP031
    assert json.dumps([stand]) == "[3]"
    assert to_plain(stand) == 3
    assert np.array([stand]).tolist() == [3]
    bow = Behavior.named(100, "BOW")
    assert (f"{bow}", int(bow), bow == 100) == ("BOW", 100, True)
    assert pickle.loads(pickle.dumps(bow)) is bow


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
    assert all(behavior.name in str(caught.value) for behavior in Behavior)
