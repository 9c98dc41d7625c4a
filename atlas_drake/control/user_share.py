"""How joints under user control, whole or in part, enter the whole-body QP.

The QP reasons about total efforts. A joint's total lies between what the behaviour's
own limits can add to the user's share; where the user has the joint alone it is the
user's effort and nothing else. Whether and why a joint is shared is the user's
business.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from atlas_drake.control.whole_body_command import EffortBounds


@dataclass(frozen=True)
class UserForecast:
    """The user's effort over one control tick: effort - inertia·v̇.

    Attributes:
        effort: For a joint that does not accelerate [N·m], shape (n,).
        inertia: How much less per acceleration of the joint, because the user's
            damping and stiffness resist within the tick [kg·m²], shape (n,).
    """

    effort: np.ndarray
    inertia: np.ndarray


def forecast_user_effort(
    static_effort: np.ndarray,
    stiffness: np.ndarray,
    damping: np.ndarray,
    v: np.ndarray,
    effort_limit: np.ndarray,
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

    Where stiffness and feed-forward alone exceed the motor, the effort is its limit.
    A damper that would exceed it for an instant is not cut off: with v̇ it brings the
    joint to rest within the tick, by an effort far smaller than d·v.

    Args:
        static_effort: kp·e, integral and all that does not depend on the joint's
            velocity [N·m], shape (n,).
        stiffness: kp [N·m/rad], shape (n,).
        damping: All gains on velocity together d [N·m·s/rad], shape (n,).
        v: Joint velocities [rad/s], shape (n,).
        effort_limit: [N·m], shape (n,).
        dt: Length of the tick [s].
        step: Of the user's law h [s].
    """
    limited = np.minimum(np.maximum(static_effort, -effort_limit), effort_limit)
    yields = limited == static_effort
    law = static_effort - (0.5 * (dt - step) * stiffness + damping) * v
    inertia = dt * damping + ((dt * dt - step * step) / 6.0) * stiffness
    return UserForecast(np.where(yields, law, limited), np.where(yields, inertia, 0.0))


def effort_bounds(
    share: np.ndarray, user: UserForecast, effort_limit: np.ndarray
) -> EffortBounds:
    """Range of each joint's total effort k·user + (1 - k)·behaviour.

    Args:
        share: The user's share k, 0 to 1, shape (n,).
        user: What the user will do.
        effort_limit: [N·m], shape (n,).
    """
    middle = share * user.effort
    authority = 1.0 - share
    reach = authority * effort_limit
    return EffortBounds(
        lower=middle - reach,
        upper=middle + reach,
        user_held=share >= 1.0,
        added_inertia=share * user.inertia,
        authority=authority,
    )


def behavior_share(
    total: np.ndarray,
    joint_acceleration: np.ndarray,
    share: np.ndarray,
    user: UserForecast,
    effort_limit: np.ndarray,
) -> np.ndarray:
    """The behaviour's own effort that makes up ``total`` [N·m], shape (n,).

    For a joint that the user has alone it is the total itself: what the behaviour
    would go on with if it were given the joint now.
    """
    rest = 1.0 - share
    shared = rest > 0.0
    users = share * (user.effort - user.inertia * joint_acceleration)
    own = np.where(shared, (total - users) / np.where(shared, rest, 1.0), total)
    return np.minimum(np.maximum(own, -effort_limit), effort_limit)
