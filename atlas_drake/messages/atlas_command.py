"""The command to the joint controllers (user mode).

``door`` checks it; the control law is in ``control.joints.joint_pid``.
"""

from dataclasses import dataclass, field

from atlas_drake.messages.base import Message
from atlas_drake.messages.fields import Byte, Gains, Numbers, Shares
from atlas_drake.messages.geometry import Header


@dataclass(slots=True, eq=False)
class AtlasCommand(Message):
    """Set-points, gains and the share of control for each joint.

    Every array has one element per joint in message order, or is empty and leaves the
    values in force unchanged.

    Attributes:
        header: Time at which the command was sent. A stamp earlier than the previous
            command's is an error.
        position: Desired positions [rad].
        velocity: Desired velocities [rad/s].
        effort: Feed-forward efforts, added to the efforts of the gains [N·m].
        kp_position: Proportional gains [N·m/rad], not negative.
        ki_position: Integral gains [N·m/(rad·s)], not negative.
        kd_position: Damping of the joint [N·m·s/rad], not negative: the gain on the
            rate of the position error for a constant set-point.
        kp_velocity: Gains on the velocity error [N·m·s/rad], not negative.
        i_effort_min: Lower bounds of the integral term [N·m].
        i_effort_max: Upper bounds of the integral term [N·m].
        k_effort: Share of user control: 0 for the behavior alone, 255 for the user
            alone.
        desired_controller_period_ms: Period at which the sender intends to send [ms]; 0
            means not given.
    """

    header: Header = field(default_factory=Header)
    position: Numbers = field(default_factory=list)
    velocity: Numbers = field(default_factory=list)
    effort: Numbers = field(default_factory=list)
    kp_position: Gains = field(default_factory=list)
    ki_position: Gains = field(default_factory=list)
    kd_position: Gains = field(default_factory=list)
    kp_velocity: Gains = field(default_factory=list)
    i_effort_min: Numbers = field(default_factory=list)
    i_effort_max: Numbers = field(default_factory=list)
    k_effort: Shares = field(default_factory=list)
    desired_controller_period_ms: Byte = 0
