"""The channels of a log with their units, and where in a control tick each comes from.

The channels of ``AtlasSimInterfaceState`` are in ``report_channels``. ``rows`` computes
those that follow from others.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from operator import attrgetter
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from atlas_drake.logs.layout import SIDES, WXYZ, XY, XYZ, Channel
from atlas_drake.logs.report_channels import REPORT_CHANNELS, ReportChannel
from atlas_drake.logs.world_state import WorldCoordinates
from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.messages.commands import ActiveCommand
from atlas_drake.messages.controller_status import LARGEST_SUPPORT, ControllerStatus
from atlas_drake.messages.imu import Imu
from atlas_drake.robot import Robot

NO_QP = -1
"""Value of ``controller.solved`` where a controller has, or needed, no QP."""
GAINS = {
    "kp_position": "N·m/rad",
    "ki_position": "N·m/(rad·s)",
    "kd_position": "N·m·s/rad",
    "kp_velocity": "N·m·s/rad",
    "i_effort_min": "N·m",
    "i_effort_max": "N·m",
}


class Tick(NamedTuple):
    """What a station's ports hold at a control tick.

    Attributes:
        time: Time of the tick [s].
        tick_time: Wall time of the controller's tick [s]; NaN if unknown.
        ports: Values of the vector-valued ports, by name.
        commands: The commands in force.
        status: Value of the controller's status port.
        report: The status as a report; nothing in it is measured.
        imu: Measurement of the IMU.
    """

    time: float
    tick_time: float
    ports: Mapping[str, np.ndarray]
    commands: ActiveCommand
    status: ControllerStatus
    report: AtlasSimInterfaceState
    imu: Imu


Read = Callable[[Tick], Any]
"""Reads a channel's numbers: a sequence or an array."""


RecordedChannel: TypeAlias = tuple[Channel, Read | None]
"""A channel, and what reads its numbers; None if they follow from other channels."""


def recorded_channels(
    robot: Robot, plant: Any, world: WorldCoordinates
) -> list[RecordedChannel]:
    """Makes the channels of a robot's log, in order.

    Args:
        robot: The simulated robot.
        plant: Plant of the robot alone.
        world: Coordinates of the models beside the robot.
    """
    return [
        (Channel("time", "s", about="time of the tick"), lambda tick: (tick.time,)),
        *_report(robot, plant),
        (
            Channel(
                "behavior.request_number",
                kind="i8",
                about="number of the behavior command in force among all messages",
            ),
            lambda tick: (tick.commands.request.number,),
        ),
        *_joints(robot, plant),
        *_body(robot, plant),
        *_balance(),
        (
            Channel("controller.tick_time", "s", about="wall time of the tick"),
            lambda tick: (tick.tick_time,),
        ),
        (
            Channel("controller.unsolved", kind="i8", about="QPs without a solution"),
            lambda tick: (tick.status.unsolved,),
        ),
        (
            Channel(
                "controller.solved",
                kind="i8",
                about="1 if the last QP had a solution, 0 if not; -1 without a QP",
            ),
            lambda tick: (NO_QP if tick.status.solved is None else tick.status.solved,),
        ),
        *_states(plant, world),
    ]


def _from_port(name: str, places: Any = slice(None)) -> Read:
    """Reads the numbers at some places of a port."""
    return lambda tick: tick.ports[name][places]


def _report(robot: Robot, plant: Any) -> Iterable[RecordedChannel]:
    indices = robot.indices(plant)
    for entry in REPORT_CHANNELS:
        name = entry.channel.name
        if not entry.is_measured:
            yield entry.channel, _from_report(entry)
        elif name.startswith("pelvis"):
            places = getattr(indices.pelvis, name.removeprefix("pelvis."))
            yield entry.channel, _from_port("behavior_state", places)
        else:
            yield entry.channel, None


def _from_report(entry: ReportChannel) -> Read:
    return lambda tick: entry.read(tick.report)


def _joints(robot: Robot, plant: Any) -> Iterable[RecordedChannel]:
    names, indices = robot.joint_names, robot.indices(plant)

    def from_commands(field: str) -> Read:
        get = attrgetter(f"joints.{field}")
        return lambda tick: get(tick.commands)

    velocities = plant.num_positions() + indices.v
    for name, unit, places in (
        ("position", "rad", indices.q),
        ("velocity", "rad/s", velocities),
    ):
        channel = Channel(f"joints.{name}", unit, names, about=f"measured {name}")
        yield channel, _from_port("behavior_state", places)
    for name, about in (
        ("effort", "effort applied by the motors"),
        ("user_effort", "effort of the joint controllers, before the limit"),
        ("behavior_effort", "effort of the behavior"),
    ):
        channel = Channel(f"joints.{name}", "N·m", names, about=about)
        yield channel, _from_port(name)
    about = "set-point in force for the user's share"
    for name, unit in (("position", "rad"), ("velocity", "rad/s"), ("effort", "N·m")):
        channel = Channel(f"joints.{name}_setpoint", unit, names, about=about)
        yield channel, from_commands(name)
    yield (
        Channel("joints.k_effort", "", names, "u1", "the user's share, 0 to 255"),
        lambda tick: tick.commands.k_effort,
    )
    for name, unit in GAINS.items():
        channel = Channel(f"gains.{name}", unit, names, about="gain in force")
        yield channel, from_commands(name)


def _body(robot: Robot, plant: Any) -> Iterable[RecordedChannel]:
    pelvis = robot.indices(plant).pelvis
    yield (
        Channel("pelvis.orientation", "", WXYZ, about="orientation in W"),
        _from_port("behavior_state", pelvis.orientation),
    )
    yield (
        Channel("imu.orientation", "", WXYZ, about="orientation in W"),
        lambda tick: attrgetter(*WXYZ)(tick.imu.orientation),
    )
    yield (
        Channel("imu.angular_velocity", "rad/s", XYZ, about="in the IMU's frame"),
        lambda tick: attrgetter(*XYZ)(tick.imu.angular_velocity),
    )
    yield (
        Channel("imu.linear_acceleration", "m/s²", XYZ, about="specific force"),
        lambda tick: attrgetter(*XYZ)(tick.imu.linear_acceleration),
    )
    sole = "the sole's center, in W, of the tick before"
    place = 0
    for owner, torque, force in (
        ("feet", f"contact moment about {sole}", f"contact force at {sole}"),
        ("hands", "contact moment, in W", "contact force, in W"),
    ):
        for side in SIDES:
            for name, unit, about in (("torque", "N·m", torque), ("force", "N", force)):
                channel = Channel(f"{owner}.{side}_{name}", unit, XYZ, about=about)
                three = slice(place, place + 3)
                yield channel, _from_port("contact_wrenches", three)
                place += 3


def _balance() -> Iterable[RecordedChannel]:
    for channel in (
        Channel("balance.com", "m", XYZ, about="center of mass, in W"),
        Channel("balance.com_velocity", "m/s", XYZ),
        Channel("balance.dcm", "m", XY, about="divergent component of motion"),
        Channel("balance.cop", "m", XY, about="measured CoP; NaN without load"),
    ):
        yield channel, None
    unknown = np.full(2, np.nan)

    def from_plan(field: str) -> Read:
        def read(tick: Tick) -> np.ndarray:
            point = getattr(tick.status.plan, field)
            return unknown if point is None else point

        return read

    for point in ("CoM", "DCM", "CoP"):
        field = f"{point.lower()}_reference"
        about = f"planned {point}; NaN if none"
        channel = Channel(f"balance.{field}", "m", XY, about=about)
        yield channel, from_plan(field)
    yield (
        Channel(
            "balance.support",
            "m",
            tuple(f"{axis}{i}" for i in range(LARGEST_SUPPORT) for axis in XY),
            about="corners of the region planned for the CoP; NaN beyond the last",
        ),
        lambda tick: flat_polygon(tick.status.plan.support),
    )


def flat_polygon(corners: np.ndarray | None) -> np.ndarray:
    """Flattens corners to a row of numbers, padded with NaN to the channel's size."""
    row = np.full(2 * LARGEST_SUPPORT, np.nan)
    if corners is not None:
        row[: 2 * len(corners)] = corners.ravel()
    return row


def polygon_from(row: np.ndarray) -> np.ndarray | None:
    """The reverse of ``flat_polygon``: shape (k, 2), or None without a polygon."""
    corners = row.reshape(-1, 2)
    corners = corners[np.isfinite(corners).all(axis=1)]
    return corners if len(corners) else None


def _states(plant: Any, world: WorldCoordinates) -> Iterable[RecordedChannel]:
    q = tuple(plant.GetPositionNames(add_model_instance_prefix=False))
    v = tuple(plant.GetVelocityNames(add_model_instance_prefix=False))
    yield (
        Channel("state.q", labels=q, about="true positions"),
        _from_port("state", slice(len(q))),
    )
    yield (
        Channel("state.v", labels=v, about="true velocities"),
        _from_port("state", slice(len(q), None)),
    )
    for name, places in world.places.items():
        about = f"other models' {name[-1]}"
        yield (
            Channel(name, labels=tuple(places), about=about),
            _from_port("plant_state", [*places.values()]),
        )
