"""Shared joints: the user's forecast, the total's bounds, the behavior's own part."""

import numpy as np
import pytest

from atlas_drake.control.gains import QpWeights
from atlas_drake.control.joints.blend import (
    UserForecast,
    behavior_share,
    effort_bounds,
    forecast_user_effort,
)
from atlas_drake.control.whole_body.constraints import EffortBounds
from atlas_drake.control.whole_body.qp import within_behavior_share
from atlas_drake.control.whole_body.tasks import PostureTask

LIMIT = np.array([10.0, 20.0, 30.0, 40.0])
SHARE = np.array([0.0, 0.25, 0.8, 1.0])
FORECAST = UserForecast(
    effort=np.array([4.0, -8.0, 12.0, -16.0]),
    inertia=np.array([0.1, 0.2, 0.3, 0.4]),
    excess=np.zeros(4),
)
DT, STEP = 0.006, 0.002
"""Control tick, and step of the user's law [s]."""


def test_only_joints_that_the_user_has_alone_are_held():
    bounds = effort_bounds(SHARE, FORECAST, LIMIT)
    np.testing.assert_array_equal(bounds.user_held, [False, False, False, True])
    assert bounds.lower[3] == bounds.upper[3] == FORECAST.effort[3]
    np.testing.assert_array_equal([bounds.lower[0], bounds.upper[0]], [-10.0, 10.0])


@pytest.mark.parametrize("seed", range(5))
def test_shares_add_up_to_the_total(seed):
    random = np.random.default_rng(seed)
    own = random.uniform(-1.0, 1.0, 4) * LIMIT
    acceleration = random.normal(size=4)
    user = FORECAST.effort - FORECAST.inertia * acceleration
    total = SHARE * user + (1.0 - SHARE) * own
    found = behavior_share(total, acceleration, SHARE, FORECAST, LIMIT)
    np.testing.assert_allclose(found[:3], own[:3])
    # Of a joint without a share the behavior would go on with the total.
    assert found[3] == pytest.approx(total[3])


def test_the_behaviors_part_keeps_the_effort_limit():
    found = behavior_share(1e3 * np.ones(4), np.zeros(4), SHARE, FORECAST, LIMIT)
    np.testing.assert_array_equal(found, LIMIT)


@pytest.mark.parametrize("acceleration", [0.0, 3.0, -40.0])
@pytest.mark.parametrize("steps", [1, 2, 4])
def test_forecast_is_the_mean_of_what_the_law_will_do(acceleration, steps):
    static, stiffness, damping, v = 6.0, 300.0, 20.0, -0.7
    tick = steps * STEP
    forecast = forecast_user_effort(
        *(np.array([x]) for x in (static, stiffness, damping, v, 0.0)), tick, STEP
    )
    # The spring as it is sampled while the plant steps on.
    way, velocity, springs = 0.0, v, []
    for _ in range(steps):
        springs.append(-stiffness * way)
        velocity += acceleration * STEP
        way += velocity * STEP
    expected = static + np.mean(springs) - damping * velocity
    found = forecast.effort - forecast.inertia * acceleration
    np.testing.assert_allclose(found, expected)


def beyond(effort, inertia=0.5):
    """A forecast of joints that do not move; what is beyond ``LIMIT`` is excess."""
    effort = np.asarray(effort)
    return UserForecast(
        effort, np.full(4, inertia), effort - np.clip(effort, -LIMIT, LIMIT)
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("times", [0.5, 1.2, 4.0, 12.0])
def test_the_limit_cuts_the_blend(sign, times):
    user = beyond(sign * times * LIMIT)
    bounds = effort_bounds(SHARE, user, LIMIT)
    ends = [
        np.clip(SHARE * user.effort + (1.0 - SHARE) * own, -LIMIT, LIMIT)
        for own in (-LIMIT, LIMIT)
    ]
    np.testing.assert_allclose(bounds.lower, ends[0])
    np.testing.assert_allclose(bounds.upper, ends[1])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_motor_kept_at_its_limit_is_the_users_and_does_not_yield(sign):
    # By 4 times the limit at a share of 0.8 or 1, not at 0.25.
    user = beyond(sign * 4.0 * LIMIT)
    bounds = effort_bounds(SHARE, user, LIMIT)
    np.testing.assert_array_equal(bounds.user_held, [False, False, True, True])
    np.testing.assert_allclose(bounds.added_inertia, [0.0, 0.125, 0.0, 0.0])
    np.testing.assert_allclose(bounds.behavior_weight, [1.0, 0.75, 0.0, 0.0])
    np.testing.assert_allclose(bounds.lower[2:], sign * LIMIT[2:])
    np.testing.assert_allclose(bounds.upper[2:], sign * LIMIT[2:])
    # The behavior would go on with what the motor does.
    own = behavior_share(sign * LIMIT, np.zeros(4), SHARE, user, LIMIT)
    np.testing.assert_allclose(own[2:], sign * LIMIT[2:])


def test_a_damper_beyond_the_limit_still_yields():
    # d·v alone is far beyond it, but the law brings the joint to rest in its step.
    user = UserForecast(np.full(4, -900.0), np.full(4, 2.0), np.zeros(4))
    bounds = effort_bounds(SHARE, user, LIMIT)
    assert bounds.lower[3] == bounds.upper[3] == -900.0
    assert bounds.added_inertia[3] == 2.0


def test_a_posture_asks_of_a_shared_joint_what_its_effort_can_do(standing):
    n = len(standing.q)
    user = UserForecast(np.full(n, 5.0), np.full(n, 0.3), np.zeros(n))
    share = np.linspace(0.0, 0.98, n)
    bounds = effort_bounds(share, user, np.full(n, 80.0))
    weight, gravity = np.full(n, 2.0), standing.h[6:]
    inertia = standing.M.diagonal()[6:] + share * user.inertia
    for sign, bound in ((-1.0, bounds.lower), (1.0, bounds.upper)):
        far = PostureTask(np.full(n, sign * 1e6), weight)
        asked = within_behavior_share(far, standing, bounds, QpWeights())
        np.testing.assert_allclose(gravity + inertia * asked.target, bound)
        # The weight fades with the behavior's part.
        assert asked.weight[0] == 2.0
        assert (np.diff(asked.weight) <= 0.0).all()
        assert 0.0 < asked.weight[-1] < 1e-4
    own = EffortBounds(bounds.lower, bounds.upper, bounds.user_held)
    assert within_behavior_share(far, standing, own, QpWeights()) is far
