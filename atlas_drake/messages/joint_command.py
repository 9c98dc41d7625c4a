"""Set-points, gains and shares of the joint controllers, as data.

Made by ``commands`` from messages, used by ``control.joints.joint_pid``. No law, no
messages.
"""

from dataclasses import dataclass

import numpy as np

from atlas_drake.frozen import Frozen


@dataclass(frozen=True)
class JointCommand(Frozen):
    """Set-points, gains and shares of the joint PIDs; arrays (n,) in message order.

    Attributes:
        position: [rad]
        velocity: [rad/s]
        effort: Feed-forward effort [N·m].
        kp_position: [N·m/rad]
        ki_position: [N·m/(rad·s)]
        kd_position: [N·m·s/rad]
        kp_velocity: [N·m·s/rad]
        i_effort_min: Least effort of the integral term [N·m].
        i_effort_max: Greatest effort of the integral term [N·m].
        k_effort: The user's share of each joint, 0 to 255.
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


JOINT_FIELDS = tuple(JointCommand.__dataclass_fields__)
