"""The robot's report on its joints and its sensors.

Behaviors are reported in ``atlas_sim_interface_state``.
"""

from dataclasses import dataclass, field

from atlas_drake.messages.base import Message
from atlas_drake.messages.fields import Numbers, Shares
from atlas_drake.messages.geometry import Header, Quaternion, Vector3, Wrench
from atlas_drake.messages.joint_indices import JointIndices


@dataclass(slots=True, eq=False)
class AtlasState(JointIndices, Message):
    """Measured joint states, gains in force, motion of the pelvis and contact wrenches.

    Every array has one element per joint in message order. ``AtlasState.neck_ry`` and
    similar constants are joint indices of the 28-joint Atlas; the indices of any robot
    are in ``robot.joints``.

    Attributes:
        header: Time of the measurement.
        position: Joint positions [rad].
        velocity: Joint velocities [rad/s].
        effort: Joint efforts [N·m].
        kp_position: Proportional gains in force [N·m/rad].
        ki_position: Integral gains in force [N·m/(rad·s)].
        kd_position: Damping of the joints in force [N·m·s/rad].
        kp_velocity: Gains on the velocity error in force [N·m·s/rad].
        i_effort_min: Lower bounds of the integral term in force [N·m].
        i_effort_max: Upper bounds of the integral term in force [N·m].
        k_effort: Shares of user control in force, 0 to 255.
        orientation: Orientation of the pelvis in the world frame.
        angular_velocity: Angular velocity of the pelvis, in the pelvis frame [rad/s].
        linear_acceleration: Specific force at the IMU, in the IMU's frame [m/s²].
        l_foot: Contact wrench on the left foot, in the world frame about the center of
            the sole, one control tick old.
        r_foot: Contact wrench on the right foot, as for the left foot.
        l_hand: Contact wrench on the left hand, in the world frame about the origin of
            its link, one control tick old.
        r_hand: Contact wrench on the right hand, as for the left hand.
    """

    header: Header = field(default_factory=Header)
    position: Numbers = field(default_factory=list)
    velocity: Numbers = field(default_factory=list)
    effort: Numbers = field(default_factory=list)
    kp_position: Numbers = field(default_factory=list)
    ki_position: Numbers = field(default_factory=list)
    kd_position: Numbers = field(default_factory=list)
    kp_velocity: Numbers = field(default_factory=list)
    i_effort_min: Numbers = field(default_factory=list)
    i_effort_max: Numbers = field(default_factory=list)
    k_effort: Shares = field(default_factory=list)
    orientation: Quaternion = field(default_factory=Quaternion)
    angular_velocity: Vector3 = field(default_factory=Vector3)
    linear_acceleration: Vector3 = field(default_factory=Vector3)
    l_foot: Wrench = field(default_factory=Wrench)
    r_foot: Wrench = field(default_factory=Wrench)
    l_hand: Wrench = field(default_factory=Wrench)
    r_hand: Wrench = field(default_factory=Wrench)
