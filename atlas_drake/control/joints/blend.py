"""How joints under user control, whole or in part, enter the whole-body QP.

The QP reasons about total efforts. A joint's total lies between what the behavior's
own limits can add to the user's share; where the user has the joint alone it is the
user's effort and nothing else. Whether and why a joint is shared is the user's
business.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.whole_body.constraints import EffortBounds


@dataclass(frozen=True)
class UserForecast:
    """The user's effort over one control tick: effort - inertia·v̇.

    Attributes:
        effort: For a joint that does not accelerate [N·m], shape (n,).
        inertia: How much less per acceleration of the joint, because the user's
            damping and stiffness resist within the tick [kg·m²], shape (n,).
        excess: By how much the user's effort is beyond the motor's limit, with its
            sign; 0 within [N·m], shape (n,).
    """

    effort: np.ndarray
    inertia: np.ndarray
    excess: np.ndarray


def forecast_user_effort(
    static_effort: np.ndarray,
    stiffness: np.ndarray,
    damping: np.ndarray,
    v: np.ndarray,
    excess: np.ndarray,
    dt: float,
    step: float,
) -> UserForecast:
    """What the user's law will do in the coming tick.

    A user's damper can stop a joint in less time than a tick. A QP that took the
    present effort for constant would see the joint as free where it is nearly locked,
    would answer each of the damper's short corrections, and would be late with its
    answer to every oscillation: enough to shake a standing robot down. So the law is
    taken as it will be in the tick on average for its stiffness and, since it is
    stiff, at the end for its damping. The spring is sampled at the beginning of every
    step h; with v̇ constant and q_j = q + j·h·v + j·(j+1)/2·h²·v̇ its mean over the
    dt/h steps is

        τ = τ_static - kp·(v·(dt - h)/2 + v̇·(dt² - h²)/6) - d·(v + v̇·dt)

    A mean that runs ahead by as little as half a step has the body's answer pump up a
    stiff joint of little damping, such as a back under the default gains, until the
    robot falls.

    Whether the motor's limit cuts is not to be seen from this: a damper with d·v beyond
    the limit may bring the joint to rest within the tick, by an effort far smaller. It
    is for the law itself to say, with damping at the velocity that its step ends with.

    Args:
        static_effort: kp·e, integral and all that does not depend on the joint's
            velocity [N·m], shape (n,).
        stiffness: kp [N·m/rad], shape (n,).
        damping: All gains on velocity together d [N·m·s/rad], shape (n,).
        v: Joint velocities [rad/s], shape (n,).
        excess: By how much the law's effort is beyond the limit now [N·m], shape (n,).
        dt: Length of the tick [s].
        step: Of the user's law h [s].
    """
    return UserForecast(
        effort=static_effort - (0.5 * (dt - step) * stiffness + damping) * v,
        inertia=dt * damping + ((dt * dt - step * step) / 6.0) * stiffness,
        excess=excess,
    )


def effort_bounds(
    share: np.ndarray, user: UserForecast, effort_limit: np.ndarray
) -> EffortBounds:
    """Range of each joint's total effort k·user + (1 - k)·behavior.

    Its limit cuts the total, not the user's part: what the user has in excess narrows
    the range from one side, until there is nothing left that the behavior could do
    about the joint.

    Args:
        share: The user's share k, 0 to 1, shape (n,).
        user: What the user will do.
        effort_limit: [N·m], shape (n,).
    """
    middle = share * user.effort
    reach = (1.0 - share) * effort_limit
    excess = share * user.excess
    held = _at_the_limit(share, user, effort_limit)
    limit = np.sign(user.excess) * effort_limit
    lower = middle - reach - np.minimum(excess, 0.0)
    upper = middle + reach - np.maximum(excess, 0.0)
    return EffortBounds(
        lower=np.where(held, limit, lower),
        upper=np.where(held, limit, upper),
        user_held=held | (share >= 1.0),
        added_inertia=np.where(held, 0.0, share * user.inertia),
        authority=np.where(held, 0.0, 1.0 - share),
    )


def behavior_share(
    total: np.ndarray,
    joint_acceleration: np.ndarray,
    share: np.ndarray,
    user: UserForecast,
    effort_limit: np.ndarray,
) -> np.ndarray:
    """The behavior's own effort that makes up ``total`` [N·m], shape (n,).

    For a joint that the user has alone it is the total itself: what the behavior
    would go on with if it were given the joint now. Likewise for one that the user
    keeps at its limit whatever the behavior does.
    """
    rest = 1.0 - share
    shared = (rest > 0.0) & ~_at_the_limit(share, user, effort_limit)
    users = share * (user.effort - user.inertia * joint_acceleration)
    own = np.where(shared, (total - users) / np.where(shared, rest, 1.0), total)
    return np.minimum(np.maximum(own, -effort_limit), effort_limit)


def _at_the_limit(
    share: np.ndarray, user: UserForecast, effort_limit: np.ndarray
) -> np.ndarray:
    """Which joints the user keeps at their limit, whatever the behavior does, (n,)."""
    return share * np.abs(user.excess) > 2.0 * (1.0 - share) * effort_limit
