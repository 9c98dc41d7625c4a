"""Blends the efforts of user and behavior, and bounds the QP's efforts accordingly.

The unknown efforts of the QP are total efforts. The total effort of a joint is the
user's part plus what the behavior can add within its limits; for a joint that the
user controls alone it is the user's effort. The user chooses the blend weights.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.whole_body.constraints import EffortBounds
from atlas_drake.frozen import read_only


def limited(effort: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """Returns efforts within ±limit [N·m], shape (n,)."""
    return np.minimum(np.maximum(effort, -limit), limit)


@dataclass(frozen=True)
class UserForecast:
    """The user's effort over one control tick: effort - inertia·v̇."""

    effort: np.ndarray  # Effort for a joint that does not accelerate [N·m], (n,)
    inertia: np.ndarray  # Decrease of the effort per acceleration [kg·m²], (n,)
    excess: np.ndarray  # Signed amount beyond the motor's limit [N·m], (n,)


def forecast_user_effort(
    static_effort: np.ndarray,
    stiffness: np.ndarray,
    damping: np.ndarray,
    v: np.ndarray,
    excess: np.ndarray,
    dt: float,
    step: float,
) -> UserForecast:
    """Predicts the effort of the user's law in the coming tick.

    The user's damping can stop a joint in less time than a tick. A QP that assumed a
    constant effort would treat a nearly locked joint as free, would react to each short
    correction of the damping, and would react late to every oscillation: enough to make
    a standing robot fall. The forecast therefore takes the stiffness on average over
    the tick and the damping, because it is stiff, at the end of the tick. The spring is
    sampled at the beginning of every step h; with v̇ constant and q_j = q + j·h·v +
    j·(j+1)/2·h²·v̇ its mean over the dt/h steps is

        τ = τ_static - kp·(v·(dt - h)/2 + v̇·(dt² - h²)/6) - d·(v + v̇·dt)

    A mean that leads by as little as half a step makes the body excite a stiff joint
    of little damping, such as a back under the default gains, until the robot falls.

    The forecast does not show if the motor's limit is reached: damping with d·v beyond
    the limit may bring the joint to rest within the tick with a far smaller effort. The
    law itself gives the ``excess``, with damping at the velocity at the end of its
    step.

    τ_static [N·m] has kp·e, the integral and all other terms that do not depend on the
    velocity; d [N·m·s/rad] is the sum of all gains on velocity.
    """
    effort = static_effort - (0.5 * (dt - step) * stiffness + damping) * v
    inertia = dt * damping + ((dt * dt - step * step) / 6.0) * stiffness
    return read_only(UserForecast(effort, inertia, excess))


def effort_bounds(
    k: np.ndarray, user: UserForecast, effort_limit: np.ndarray
) -> EffortBounds:
    """Computes the range of each joint's total effort k·user + (1 - k)·behavior.

    The effort limit applies to the total, not to the user's part: an excess of the
    user's effort narrows the range from one side, until the behavior has no influence
    left.
    """
    middle = k * user.effort
    reach = (1.0 - k) * effort_limit
    excess = k * user.excess
    held = _at_the_limit(k, user, effort_limit)
    limit = np.sign(user.excess) * effort_limit
    lower = middle - reach - np.minimum(excess, 0.0)
    upper = middle + reach - np.maximum(excess, 0.0)
    return EffortBounds(
        lower=np.where(held, limit, lower),
        upper=np.where(held, limit, upper),
        user_held=held | (k >= 1.0),
        added_inertia=np.where(held, 0.0, k * user.inertia),
        behavior_weight=np.where(held, 0.0, 1.0 - k),
    )


def behavior_share(
    total: np.ndarray,
    joint_acceleration: np.ndarray,
    k: np.ndarray,
    user: UserForecast,
    effort_limit: np.ndarray,
) -> np.ndarray:
    """Computes the behavior's effort that adds up to ``total`` [N·m], shape (n,).

    For a joint that the user controls alone the result is the total itself, with which
    the behavior would continue if it received the joint now. The same holds for a joint
    that the user keeps at its limit for any effort of the behavior.
    """
    rest = 1.0 - k
    shared = (rest > 0.0) & ~_at_the_limit(k, user, effort_limit)
    users = k * (user.effort - user.inertia * joint_acceleration)
    own = np.where(shared, (total - users) / np.where(shared, rest, 1.0), total)
    return limited(own, effort_limit)


def _at_the_limit(
    k: np.ndarray, user: UserForecast, effort_limit: np.ndarray
) -> np.ndarray:
    """Finds joints that the user keeps at their limit for any behavior effort."""
    return k * np.abs(user.excess) > 2.0 * (1.0 - k) * effort_limit
