"""STAND: its weight shift, the end of a changed pose, feet that slip."""

import numpy as np
import pytest

from atlas_drake import AtlasSimInterfaceCommand
from atlas_drake.behaviors.body_reference import BodyRates, capture_body
from atlas_drake.behaviors.stand.stand import Stand
from atlas_drake.frozen import replace

from .conftest import as_request


def test_the_weight_moves_to_the_middle_at_eight_centimetres_a_second(balance, observe):
    middle = 0.5 * sum(foot.p_WF[:2] for foot in observe().terms.feet)
    begin = middle + np.array([0.05, 0.0])
    seen = observe(above=begin)
    body, request = capture_body(seen.terms), as_request(AtlasSimInterfaceCommand())
    stand = Stand(balance, 0.9, BodyRates())
    state = stand.enter(seen, body, request)
    np.testing.assert_allclose(state.com, begin)
    after = stand.update(state, seen, body, request, False).state
    np.testing.assert_allclose(after.com - state.com, [-0.08 * seen.dt, 0.0], atol=1e-9)


@pytest.mark.parametrize(
    ("pelvis", "chest", "finished"),
    [(0.0, 0.0, True), (0.0, 0.02, False), (0.02, 0.0, False), (-0.02, 0.0, False)],
)
def test_a_changed_pose_is_finished_with_its_trunk_at_the_target(
    make_tools, observe, pelvis, chest, finished
):
    seen, request = observe(), as_request(AtlasSimInterfaceCommand())
    bent = np.array([0.1, 0.2])

    def pose(upright, observation, request, leaving):
        return replace(upright, pelvis_tilt=bent, chest_tilt=bent)

    stand = make_tools(0.9).stand(pose)
    body = replace(
        capture_body(seen.terms), pelvis_tilt=bent + pelvis, chest_tilt=bent + chest
    )
    state = stand.enter(seen, body, request)
    outcome = stand.update(state, seen, body, request, leaving=True)
    assert outcome.finished == finished
    assert not stand.update(state, seen, body, request, leaving=False).finished


@pytest.mark.parametrize("foot", [0, 1])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_pose_of_a_foot_that_slips_is_latched_again(balance, observe, foot, axis):
    seen = observe()
    body, request = capture_body(seen.terms), as_request(AtlasSimInterfaceCommand())
    stand = Stand(balance, 0.9, BodyRates())
    before = stand.enter(seen, body, request)
    for share in (-1.1, -0.9, 0.9, 1.1):
        slip = np.zeros(3)
        slip[axis] = share * 0.01
        feet = list(seen.terms.feet)
        feet[foot] = feet[foot]._replace(p_WF=feet[foot].p_WF + slip)
        now = replace(seen, terms=replace(seen.terms, feet=tuple(feet)))
        after = stand.update(before, now, body, request, False).state
        moved = slip if abs(share) > 1.0 else np.zeros(3)
        for side, old, new in zip((0, 1), before.feet, after.feet, strict=True):
            expected = old.p_WF + moved * (side == foot)
            np.testing.assert_allclose(new.p_WF, expected, atol=1e-12)
        np.testing.assert_allclose(after.middle - before.middle, 0.5 * moved)
        assert after.height - before.height == pytest.approx(0.5 * moved[2])
