"""The numbers of a record, in groups: a column of a log has the path of its field.

``log["balance.dcm"]`` holds what ``record.balance.dcm`` was in every tick.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from atlas_drake.messages.controller_status import MAX_CORNERS
from atlas_drake.messages.fields import K_EFFORT_MAX
from atlas_drake.records.column import WXYZ, XY, XYZ, Column, Group, Names

Array = np.ndarray
_JOINTS, _PAIRS = Names.JOINTS, Names.CONTACT_PAIRS
_CORNERS = tuple(f"{axis}{i}" for i in range(MAX_CORNERS) for axis in XY)
_Torque = Annotated[Array, Column("contact moment in W", "N·m", XYZ)]
_Force = Annotated[Array, Column("contact force in W", "N", XYZ)]
_Planned = Annotated[Array | None, Column("plan; NaN if none", "m", XY, optional=True)]


@dataclass(frozen=True, eq=False)
class BehaviorNumbers(Group):
    """The behavior, and the answer to the last command."""

    current: Annotated[int, Column("active behavior", kind="i8")]
    desired: Annotated[int, Column("requested behavior", kind="i8")]
    error_code: Annotated[int, Column("ErrorCode of the last command", kind="i8")]
    status_flags: Annotated[int, Column("bits of BehaviorStatus", kind="i8")]
    trans_from: Annotated[int, Column("last behavior left", kind="i8")]
    trans_to: Annotated[int, Column("last behavior entered or refused", kind="i8")]
    request_number: Annotated[int, Column("of the request in force", kind="i8")]


@dataclass(frozen=True, eq=False)
class Joints(Group):
    """The joints, in message order."""

    position: Annotated[Array, Column("measured position", "rad", _JOINTS)]
    velocity: Annotated[Array, Column("measured velocity", "rad/s", _JOINTS)]
    effort: Annotated[Array, Column("effort of the motors", "N·m", _JOINTS)]
    user_effort: Annotated[Array, Column("effort of the user's law", "N·m", _JOINTS)]
    behavior_effort: Annotated[Array, Column("effort of the behavior", "N·m", _JOINTS)]
    position_setpoint: Annotated[Array, Column("the user's set-point", "rad", _JOINTS)]
    velocity_setpoint: Annotated[Array, Column("the user's rate", "rad/s", _JOINTS)]
    effort_setpoint: Annotated[Array, Column("the user's set-point", "N·m", _JOINTS)]
    k_effort: Annotated[Array, Column("user's share, 0 to 255", "", _JOINTS, kind="u1")]

    @property
    def k(self) -> Array:
        """The user's blend weight of each joint, 0 to 1, shape (n,)."""
        return self.k_effort * (1.0 / K_EFFORT_MAX)


@dataclass(frozen=True, eq=False)
class Gains(Group):
    """The user's gains in force, in message order."""

    kp_position: Annotated[Array, Column("gain in force", "N·m/rad", _JOINTS)]
    ki_position: Annotated[Array, Column("gain in force", "N·m/(rad·s)", _JOINTS)]
    kd_position: Annotated[Array, Column("gain in force", "N·m·s/rad", _JOINTS)]
    kp_velocity: Annotated[Array, Column("gain in force", "N·m·s/rad", _JOINTS)]
    i_effort_min: Annotated[Array, Column("bound in force", "N·m", _JOINTS)]
    i_effort_max: Annotated[Array, Column("bound in force", "N·m", _JOINTS)]


@dataclass(frozen=True, eq=False)
class Pelvis(Group):
    """The pelvis in W, as the behaviors read it."""

    position: Annotated[Array, Column("of the pelvis in W", "m", XYZ)]
    velocity: Annotated[Array, Column("of the pelvis in W", "m/s", XYZ)]
    orientation: Annotated[Array, Column("of the pelvis in W", "", WXYZ)]


@dataclass(frozen=True, eq=False)
class ImuNumbers(Group):
    """The measurement of the IMU."""

    orientation: Annotated[Array, Column("of the IMU in W", "", WXYZ)]
    angular_velocity: Annotated[Array, Column("in the IMU's frame", "rad/s", XYZ)]
    linear_acceleration: Annotated[Array, Column("specific force", "m/s²", XYZ)]


@dataclass(frozen=True, eq=False)
class Feet(Group):
    """The soles in W, and the contact wrenches of the tick before at their centers."""

    left_position: Annotated[Array, Column("of the left sole in W", "m", XYZ)]
    left_orientation: Annotated[Array, Column("of the left sole in W", "", WXYZ)]
    right_position: Annotated[Array, Column("of the right sole in W", "m", XYZ)]
    right_orientation: Annotated[Array, Column("of the right sole in W", "", WXYZ)]
    left_torque: _Torque
    left_force: _Force
    right_torque: _Torque
    right_force: _Force

    @property
    def positions(self) -> tuple[Array, Array]:
        """Positions of both soles' centers in W [m], each of shape (3,)."""
        return self.left_position, self.right_position

    @property
    def orientations(self) -> tuple[Array, Array]:
        """Orientations of both soles in W, quaternions with w first."""
        return self.left_orientation, self.right_orientation

    @property
    def loads(self) -> tuple[float, float]:
        """Vertical contact forces on both soles [N]."""
        return float(self.left_force[2]), float(self.right_force[2])


@dataclass(frozen=True, eq=False)
class Hands(Group):
    """The contact wrenches of the tick before on the hands, at their origins."""

    left_torque: _Torque
    left_force: _Force
    right_torque: _Torque
    right_force: _Force


@dataclass(frozen=True, eq=False)
class Balance(Group):
    """Center of mass, DCM, CoP and CMP, and their plan."""

    com: Annotated[Array, Column("center of mass in W", "m", XYZ)]
    com_velocity: Annotated[Array, Column("of the center of mass in W", "m/s", XYZ)]
    dcm: Annotated[Array, Column("divergent component of motion", "m", XY)]
    cop: Annotated[
        Array | None, Column("measured CoP; NaN without load", "m", XY, optional=True)
    ]
    cmp: Annotated[
        Array | None,
        Column("CMP of the controller's forces; NaN if none", "m", XY, optional=True),
    ]
    com_reference: _Planned
    dcm_reference: _Planned
    cop_reference: _Planned
    cmp_reference: _Planned
    support: Annotated[
        Array | None,
        Column(
            "corners of the region of the CoP; NaN beyond the last",
            "m",
            _CORNERS,
            optional=True,
            width=2,
        ),
    ]
    omega: Annotated[
        float | None,
        Column("natural frequency of the plan; NaN if none", "1/s", optional=True),
    ]


@dataclass(frozen=True, eq=False)
class ControllerNumbers(Group):
    """The work of the controller; wall time takes no part in comparisons."""

    unsolved: Annotated[int, Column("infeasible ticks so far", kind="i8")]
    solved: Annotated[int, Column("by the QP: 1, 0, or -1 without one", kind="i8")]
    tick_time: Annotated[
        float | None, Column("wall time of the tick", "s", optional=True)
    ] = field(default=None, compare=False)


@dataclass(frozen=True, eq=False)
class State(Group):
    """The true state of the robot, in plant order."""

    q: Annotated[Array, Column("true positions", "", Names.POSITIONS)]
    v: Annotated[Array, Column("true velocities", "", Names.VELOCITIES)]


@dataclass(frozen=True, eq=False)
class World(Group):
    """The state of the models beside the robot."""

    q: Annotated[Array, Column("other models' positions", "", Names.WORLD_POSITIONS)]
    v: Annotated[Array, Column("other models' velocities", "", Names.WORLD_VELOCITIES)]


@dataclass(frozen=True, eq=False)
class Estimator(Group):
    """The error of the state estimator, estimated minus true."""

    position: Annotated[Array, Column("of the pelvis in W", "m", XYZ)]
    velocity: Annotated[Array, Column("of the pelvis in W", "m/s", XYZ)]
    rotation: Annotated[Array, Column("of the pelvis in W", "rad", XYZ)]


@dataclass(frozen=True, eq=False)
class ContactPairs(Group):
    """The sums of contacts between chosen bodies, of the tick before, shape (k, 3)."""

    torque: Annotated[
        Array,
        Column("on the first body in W, at its origin", "N·m", _PAIRS, width=3),
    ]
    force: Annotated[Array, Column("on the first body in W", "N", _PAIRS, width=3)]
