"""Set-points, gains and shares of the joint controllers, as data.

``commands`` makes the values from messages; ``control.joints.joint_pid`` holds the law.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from atlas_drake.frozen import Frozen, read_only
from atlas_drake.messages.fields import K_EFFORT_MAX


@dataclass(frozen=True)
class JointCommand(Frozen):
    """The values of ``AtlasCommand`` in force, as read-only arrays of shape (n,)."""

    position: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray
    kp_position: np.ndarray
    ki_position: np.ndarray
    kd_position: np.ndarray
    kp_velocity: np.ndarray
    i_effort_min: np.ndarray
    i_effort_max: np.ndarray
    k_effort: np.ndarray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        read_only(self)

    # Read many times between two commands.

    @cached_property
    def numbers(self) -> np.ndarray:
        """All values, in the order of ``JOINT_FIELDS``, shape (10·n,); read-only."""
        return read_only(np.concatenate([getattr(self, name) for name in JOINT_FIELDS]))

    @cached_property
    def k(self) -> np.ndarray:
        """The user's blend weight of each joint, 0 to 1, shape (n,); read-only."""
        return read_only(self.k_effort * (1.0 / K_EFFORT_MAX))

    @cached_property
    def has_user(self) -> bool:
        """True if the user has a part in any joint."""
        return bool(self.k_effort.any())


JOINT_FIELDS = tuple(JointCommand.__dataclass_fields__)
