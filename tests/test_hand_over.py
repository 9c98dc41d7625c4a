"""Hand-over of joints between user and behavior without a jump, in both directions."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
from hand_over import GOAL, hand_overs


@pytest.mark.slow
def test_no_hand_over_of_the_tutorial_is_a_jump():
    # What comes later, at 15 s, is the user's own doing.
    found = hand_overs(duration=13.6)
    behaviors = [(entry["before"], entry["after"]) for entry in found]
    for change in [("STAND_PREP", "STAND"), ("STAND", "WALK"), ("WALK", "STAND")]:
        assert change in behaviors
    # Taken by the user, given back, some joints and all of them.
    assert {entry["changed"] for entry in found} >= {5, 28}
    for entry in found:
        name, jump = entry.get("the behavior's", ("", 0.0))
        assert jump <= GOAL, (entry["time"], name)
