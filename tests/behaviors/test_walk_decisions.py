"""Decisions of WALK about its phases, without a simulation."""

import numpy as np
import pytest

from atlas_drake.behaviors.balance import Balance
from atlas_drake.behaviors.body_reference import BodyRates, capture_body
from atlas_drake.behaviors.walk.phases import Settle, Swing
from atlas_drake.behaviors.walk.rules import WalkRules
from atlas_drake.behaviors.walk.walk import Walk
from atlas_drake.control.feet.footstep import FootPose
from atlas_drake.control.gains import ControlGains
from atlas_drake.frozen import replace

from .as_request import as_request

RULES = WalkRules()


@pytest.fixture(scope="module")
def walk(robot, observe):
    terms = observe().terms
    balance = Balance(robot, ControlGains())
    height = float(terms.com[2] - terms.feet[0].p_WF[2]) - robot.file.com_drop
    return Walk(balance, height, BodyRates())


def raised(pose, height):
    return FootPose(pose.p_WF + np.array([0.0, 0.0, height]), pose.R_WF)


@pytest.mark.parametrize("height", [0.0, 0.15], ids=["as planned", "lower"])
def test_feet_that_lie_elsewhere_at_lift_off_may_end_the_walk(
    walk, observe, walk_message, height
):
    seen, request = observe(), as_request(walk_message((1, 0, 0.2, 0.14)))
    body = capture_body(seen.terms)
    phase = walk.enter(seen, body, request)
    # The walk last saw the feet level with the step; since, they have come down.
    feet = tuple(raised(foot, height) for foot in phase.course.feet)
    (step,) = phase.course.pending
    place = np.array([*step.p_WF[:2], feet[1].p_WF[2]])
    pending = (replace(step, p_WF=place),)
    phase = replace(
        phase,
        elapsed=phase.duration + RULES.longest_wait,
        course=replace(phase.course, feet=feet, pending=pending),
    )
    outcome = walk.update(phase, seen, body, request, leaving=False)
    if height == 0.0:
        assert isinstance(outcome.memory, Swing)
        return
    assert isinstance(outcome.memory, Settle)
    assert outcome.memory.obstacle == "step 1 leads 0.15 m up, which is too much"
    (event,) = outcome.events
    assert event.text.startswith("WALK will end before step 1")
