"""The command to the joint controllers (user mode).

What is valid is in ``validation``; what the joint controllers make of it, elsewhere.
"""

from dataclasses import dataclass, field

from atlas_drake.messages.base import FloatArray, IntArray, Message
from atlas_drake.messages.geometry import Header


@dataclass(slots=True, eq=False)
class AtlasCommand(Message):
    """Setpoints, gains and the share of control for each joint.

    Every array has one element per joint in message order, or is empty and leaves the
    values in force as they are.

    Attributes:
        header: When it was sent. An earlier stamp than that of the command before is
            an error.
        position: Desired positions [rad].
        velocity: Desired velocities [rad/s].
        effort: Efforts added to what the gains give [N·m].
        kp_position: Proportional gains [N·m/rad], not negative.
        ki_position: Integral gains [N·m/(rad·s)], not negative.
        kd_position: Damping of the joint [N·m·s/rad], not negative: the gain on the
            rate of the position error, of a set-point taken to stand still.
        kp_velocity: Gains on the velocity error [N·m·s/rad], not negative.
        i_effort_min: Lower bounds of the integral term [N·m].
        i_effort_max: Upper bounds of the integral term [N·m].
        k_effort: Share of user control: 0 the behavior alone, 255 the user alone.
        desired_controller_period_ms: How often the sender means to send [ms]; 0 means
            that it does not say.
    """

    header: Header = field(default_factory=Header)
    position: FloatArray = field(default_factory=list)
    velocity: FloatArray = field(default_factory=list)
    effort: FloatArray = field(default_factory=list)
    kp_position: FloatArray = field(default_factory=list)
    ki_position: FloatArray = field(default_factory=list)
    kd_position: FloatArray = field(default_factory=list)
    kp_velocity: FloatArray = field(default_factory=list)
    i_effort_min: FloatArray = field(default_factory=list)
    i_effort_max: FloatArray = field(default_factory=list)
    k_effort: IntArray = field(default_factory=list)
    desired_controller_period_ms: int = 0
