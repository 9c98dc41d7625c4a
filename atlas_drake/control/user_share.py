"""How joints under user control, whole or in part, enter the whole-body QP.

The QP reasons about total efforts. A joint's total lies between what the behaviour's
own limits can add to the user's share; where the user has the joint alone it is one
known number. Whether and why a joint is shared is the user's business.
"""

from __future__ import annotations

import numpy as np

from atlas_drake.control.whole_body_command import EffortBounds


def effort_bounds(
    share: np.ndarray, user_effort: np.ndarray, effort_limit: np.ndarray
) -> EffortBounds:
    """Range of each joint's total effort k·user + (1 - k)·behaviour.

    Args:
        share: The user's share k, 0 to 1, shape (n,).
        user_effort: [N·m], shape (n,).
        effort_limit: [N·m], shape (n,).
    """
    middle = share * np.clip(user_effort, -effort_limit, effort_limit)
    reach = (1.0 - share) * effort_limit
    return EffortBounds(
        lower=middle - reach, upper=middle + reach, user_held=share >= 1.0
    )


def behavior_share(
    total: np.ndarray,
    share: np.ndarray,
    user_effort: np.ndarray,
    effort_limit: np.ndarray,
) -> np.ndarray:
    """The behaviour's own effort that makes up ``total`` [N·m], shape (n,).

    For a joint that the user has alone it is the total itself: what the behaviour
    would go on with if it were given the joint now.
    """
    rest = 1.0 - share
    shared = rest > 0.0
    own = np.where(
        shared, (total - share * user_effort) / np.where(shared, rest, 1.0), total
    )
    return np.clip(own, -effort_limit, effort_limit)
