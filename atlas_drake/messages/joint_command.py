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
    """Set-points, gains and shares of the joint PIDs; arrays (n,) in message order.

    All are read-only.

    Attributes:
        position: Desired positions [rad].
        velocity: Desired velocities [rad/s].
        effort: Feed-forward effort [N·m].
        kp_position: Proportional gains [N·m/rad].
        ki_position: Integral gains [N·m/(rad·s)].
        kd_position: Damping of the joints [N·m·s/rad].
        kp_velocity: Gains on the velocity error [N·m·s/rad].
        i_effort_min: Least effort of the integral term [N·m].
        i_effort_max: Greatest effort of the integral term [N·m].
        k_effort: Shares of user control, 0 to 255.
    """

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
    def share(self) -> np.ndarray:
        """The user's blend weight k of each joint, 0 to 1, shape (n,); read-only."""
        return read_only(share_of(self.k_effort))

    @cached_property
    def has_user(self) -> bool:
        """True if the user has a share of any joint."""
        return bool(self.k_effort.any())


def share_of(k_effort: np.ndarray) -> np.ndarray:
    """Converts k_effort, 0 to 255, to the user's blend weight k, 0 to 1."""
    return k_effort * (1.0 / K_EFFORT_MAX)


JOINT_FIELDS = tuple(JointCommand.__dataclass_fields__)
