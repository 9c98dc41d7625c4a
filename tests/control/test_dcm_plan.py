"""The DCM plan: pendulum dynamics, continuity, and rest at the end."""

import itertools

import numpy as np
import pytest

from atlas_drake.control.balance.dcm_plan import CopSegment, DcmPlan

OMEGA = 3.3
"""Natural frequency of the pendulum [1/s]."""


def random_segments(seed):
    """A CoP that moves on without a jump through five segments."""
    random = np.random.default_rng(seed)
    points = random.uniform(-0.3, 0.3, (6, 2)).cumsum(axis=0)
    return [
        CopSegment(
            random.uniform(0.1, 0.9),
            start,
            end,
            # The CMP is the CoP in every other segment.
            random.uniform(-0.2, 0.2, (4, 2)) if number % 2 else None,
        )
        for number, (start, end) in enumerate(itertools.pairwise(points))
    ]


@pytest.fixture(params=range(2))
def segments(request):
    return random_segments(request.param)


@pytest.fixture
def plan(segments):
    return DcmPlan(segments, OMEGA)


def times_inside(segments, margin):
    """Times away from the segments' ends, where derivatives exist."""
    start = 0.0
    for segment in segments:
        yield from np.linspace(start + margin, start + segment.duration - margin, 7)
        start += segment.duration


def test_dcm_moves_away_from_the_cmp(segments, plan):
    step = 1e-6
    for time in times_inside(segments, 1e-3):
        before, after = plan.evaluate(time - step), plan.evaluate(time + step)
        here = plan.evaluate(time)
        rate = (after.dcm - before.dcm) / (2.0 * step)
        np.testing.assert_allclose(rate, OMEGA * (here.dcm - here.cmp), atol=1e-7)


def test_cop_is_the_segments(segments, plan):
    start = 0.0
    for segment in segments:
        for share in (0.0, 0.3, 0.999):
            cop = plan.evaluate(start + share * segment.duration).cop
            expected = segment.start + share * (segment.end - segment.start)
            np.testing.assert_allclose(cop, expected, atol=1e-12)
        start += segment.duration


def test_ends_at_rest_over_the_last_cop_and_ends_are_held(segments, plan):
    end = plan.evaluate(plan.duration)
    np.testing.assert_allclose([end.dcm, end.cop], [segments[-1].end] * 2, atol=1e-12)
    assert plan.duration == pytest.approx(sum(s.duration for s in segments))
    for outside, at in ((-1.0, 0.0), (plan.duration + 5.0, plan.duration)):
        held, end = plan.evaluate(outside), plan.evaluate(at)
        np.testing.assert_array_equal(held.dcm, end.dcm)
        np.testing.assert_array_equal(held.cop, end.cop)
