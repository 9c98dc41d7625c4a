"""The two commands: to the joint controllers, and to the behaviors.

``door`` checks them; ``commands`` merges them into the commands in force.
"""

from dataclasses import dataclass, field
from typing import Annotated, Any

from pydantic import PlainValidator

from atlas_drake.config import plain_number
from atlas_drake.messages.base import Message
from atlas_drake.messages.behavior import Behavior
from atlas_drake.messages.behavior_params import (
    AtlasBehaviorManipulateParams,
    AtlasBehaviorStandParams,
    AtlasBehaviorStepParams,
    AtlasBehaviorWalkParams,
)
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


@dataclass(slots=True, eq=False)
class AtlasSimInterfaceCommand(Message):
    """The desired behavior, its parameters, and the share of control of each joint.

    Every array has one element per joint in message order, or is empty and leaves the
    values in force unchanged.

    Attributes:
        header: Time at which the command was sent. A stamp earlier than the previous
            command's is an error.
        behavior: A ``Behavior``, its number, or its name in any case. An empty message
            requests NONE.
        walk_params: Read by WALK.
        step_params: Read by STEP.
        stand_params: Read by STAND.
        manipulate_params: Read by MANIPULATE.
        params: Read by a user's own behavior: an instance of the dataclass of its
            parameters; None means defaults.
        position: Servo positions [rad]. These six arrays set the joint controllers as
            the arrays of the same names in ``AtlasCommand`` do; the later message
            counts. They act on joints with a user share above 0.
        velocity: Servo velocities [rad/s].
        effort: Servo efforts [N·m].
        kp_position, ki_position, kp_velocity: Servo gains, see ``AtlasCommand``.
        k_effort: Share of user control: 0 for the behavior alone, 255 for the user
            alone. ``AtlasCommand`` sets it too.
    """

    NONE = Behavior.NONE
    FREEZE = Behavior.FREEZE
    STAND_PREP = Behavior.STAND_PREP
    STAND = Behavior.STAND
    WALK = Behavior.WALK
    STEP = Behavior.STEP
    MANIPULATE = Behavior.MANIPULATE
    USER = Behavior.USER

    header: Header = field(default_factory=Header)
    behavior: Annotated[int | str, PlainValidator(plain_number)] = Behavior.NONE
    walk_params: AtlasBehaviorWalkParams = field(
        default_factory=AtlasBehaviorWalkParams
    )
    step_params: AtlasBehaviorStepParams = field(
        default_factory=AtlasBehaviorStepParams
    )
    stand_params: AtlasBehaviorStandParams = field(
        default_factory=AtlasBehaviorStandParams
    )
    manipulate_params: AtlasBehaviorManipulateParams = field(
        default_factory=AtlasBehaviorManipulateParams
    )
    params: Any = None
    position: Numbers = field(default_factory=list)
    velocity: Numbers = field(default_factory=list)
    effort: Numbers = field(default_factory=list)
    kp_position: Gains = field(default_factory=list)
    ki_position: Gains = field(default_factory=list)
    kp_velocity: Gains = field(default_factory=list)
    k_effort: Shares = field(default_factory=list)


COMMANDS: dict[str, type[AtlasCommand | AtlasSimInterfaceCommand]] = {
    "atlas_command": AtlasCommand,
    "atlas_sim_interface_command": AtlasSimInterfaceCommand,
}
"""Both commands, by the names of their ports, topics and fields in a scenario."""
