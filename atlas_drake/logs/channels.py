"""The channels of a log, one value per control tick, with units.

The channels of ``AtlasSimInterfaceState`` are in ``report_channels``. ``samples``
computes the values.
"""

from __future__ import annotations

from collections.abc import Iterable

from atlas_drake.logs.layout import SIDES, WXYZ, XY, XYZ, Channel, Layout
from atlas_drake.logs.report_channels import REPORT_CHANNELS
from atlas_drake.logs.world_state import WorldCoordinates
from atlas_drake.messages.controller_status import LARGEST_SUPPORT
from atlas_drake.robot import Robot

GAINS = {
    "kp_position": "N·m/rad",
    "ki_position": "N·m/(rad·s)",
    "kd_position": "N·m·s/rad",
    "kp_velocity": "N·m·s/rad",
    "i_effort_min": "N·m",
    "i_effort_max": "N·m",
}


def robot_layout(
    robot: Robot,
    positions: Iterable[str],
    velocities: Iterable[str],
    world: WorldCoordinates,
) -> Layout:
    """Make the layout of the log of a robot with these positions and velocities."""
    return Layout(
        [
            Channel("time", "s", about="time of the tick"),
            *(entry.channel for entry in REPORT_CHANNELS),
            Channel(
                "behavior.request_number",
                kind="i8",
                about="number of the behavior command in force among all messages",
            ),
            *_joints(robot.joint_names),
            *_body(),
            Channel("controller.tick_time", "s", about="wall time of the tick"),
            Channel("controller.unsolved", kind="i8", about="QPs without a solution"),
            Channel(
                "controller.solved",
                kind="i8",
                about="1 if the last QP had a solution, 0 if not; -1 without a QP",
            ),
            Channel("state.q", labels=tuple(positions), about="true positions"),
            Channel("state.v", labels=tuple(velocities), about="true velocities"),
            *(
                Channel(name, labels=tuple(places), about=f"other models' {name[-1]}")
                for name, places in world.places.items()
            ),
        ]
    )


def _joints(names: tuple[str, ...]) -> Iterable[Channel]:
    for name, unit, about in (
        ("position", "rad", "measured position"),
        ("velocity", "rad/s", "measured velocity"),
        ("effort", "N·m", "effort applied by the motors"),
        ("user_effort", "N·m", "effort of the joint controllers, before the limit"),
        ("behavior_effort", "N·m", "effort of the behavior"),
        ("position_setpoint", "rad", "set-point in force for the user's share"),
        ("velocity_setpoint", "rad/s", "set-point in force for the user's share"),
        ("effort_setpoint", "N·m", "set-point in force for the user's share"),
    ):
        yield Channel(f"joints.{name}", unit, names, about=about)
    yield Channel("joints.k_effort", "", names, "u1", "the user's share, 0 to 255")
    for name, unit in GAINS.items():
        yield Channel(f"gains.{name}", unit, names, about="gain in force")


def _body() -> Iterable[Channel]:
    yield Channel("pelvis.orientation", "", WXYZ, about="orientation in W")
    yield Channel("imu.orientation", "", WXYZ, about="orientation in W")
    yield Channel("imu.angular_velocity", "rad/s", XYZ, about="in the IMU's frame")
    yield Channel("imu.linear_acceleration", "m/s²", XYZ, about="specific force")
    for side in SIDES:
        yield Channel(
            f"feet.{side}_torque",
            "N·m",
            XYZ,
            about="contact moment about the sole's center, in W, of the tick before",
        )
        yield Channel(
            f"feet.{side}_force",
            "N",
            XYZ,
            about="contact force at the sole's center, in W, of the tick before",
        )
    for side in SIDES:
        yield Channel(f"hands.{side}_torque", "N·m", XYZ, about="contact moment, in W")
        yield Channel(f"hands.{side}_force", "N", XYZ, about="contact force, in W")
    yield Channel("balance.com", "m", XYZ, about="center of mass, in W")
    yield Channel("balance.com_velocity", "m/s", XYZ)
    yield Channel("balance.dcm", "m", XY, about="divergent component of motion")
    yield Channel("balance.cop", "m", XY, about="measured CoP; NaN without load")
    yield Channel("balance.com_reference", "m", XY, about="planned CoM; NaN if none")
    yield Channel("balance.dcm_reference", "m", XY, about="planned DCM; NaN if none")
    yield Channel("balance.cop_reference", "m", XY, about="planned CoP; NaN if none")
    yield Channel(
        "balance.support",
        "m",
        tuple(f"{axis}{i}" for i in range(LARGEST_SUPPORT) for axis in XY),
        about="corners of the region planned for the CoP; NaN beyond the last",
    )
