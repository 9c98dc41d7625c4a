"""Samples of a log: what only a station's ports know, one array of numbers per tick.

``rows`` computes from samples what follows from them.
"""

from __future__ import annotations

from itertools import chain
from typing import Any

import numpy as np

from atlas_drake.logs.channels import GAINS
from atlas_drake.logs.layout import SIDES, Layout
from atlas_drake.logs.report_channels import STATUS_CHANNELS, reported
from atlas_drake.logs.world_state import WorldCoordinates
from atlas_drake.messages.commands import CommandsInForce
from atlas_drake.messages.controller_status import (
    LARGEST_SUPPORT,
    ControllerStatus,
    Plan,
)
from atlas_drake.messages.imu import Imu
from atlas_drake.robot import Robot
from atlas_drake.systems.interface_reporter import behavior_report

NO_QP = -1
"""Value of ``controller.solved`` where a controller has, or needed, no QP."""
_FIRST = (
    "time",
    "controller.tick_time",
    "controller.unsolved",
    "controller.solved",
    "behavior.request_number",
    *(entry.channel.name for entry in STATUS_CHANNELS),
    "imu.orientation",
    "imu.angular_velocity",
    "imu.linear_acceleration",
)
"""The channels at the beginning of a sample; the numbers of the ports follow."""
_PORTS = {
    "state": ("state.q", "state.v"),
    "contact_wrenches": tuple(
        f"{owner}.{side}_{name}"
        for owner in ("feet", "hands")
        for side in SIDES
        for name in ("torque", "force")
    ),
    "effort": ("joints.effort",),
    "user_effort": ("joints.user_effort",),
    "behavior_effort": ("joints.behavior_effort",),
}
"""The channels that the numbers of a port are, in its order."""
_LAST = (
    "joints.k_effort",
    "joints.position_setpoint",
    "joints.velocity_setpoint",
    "joints.effort_setpoint",
    *(f"gains.{name}" for name in GAINS),
    "balance.com_reference",
    "balance.dcm_reference",
    "balance.cop_reference",
    "balance.support",
)
"""The channels at the end of a sample, before the plan's natural frequency."""
_UNKNOWN = np.full(2, np.nan)
_NO_SUPPORT = np.full(2 * LARGEST_SUPPORT, np.nan)


class SampleLayout:
    """Where the numbers of a sample come from, and where in a row they go.

    Attributes:
        port_sizes: Lengths of the station's ports whose numbers a sample holds, by
            name, in order.
        size: Length of a sample. Its last number is the plan's natural frequency.
        measured: Index of each number of the state that the controller reads.
        sources: Index into a sample of each number that a row has as it is.
        targets: Index into a row of the same numbers.
    """

    def __init__(
        self, robot: Robot, plant: Any, beside: WorldCoordinates, layout: Layout
    ):
        """Makes the layout of the samples for rows of ``layout``.

        Args:
            robot: The simulated robot.
            plant: Plant of the robot alone.
            beside: Coordinates of the models beside the robot.
            layout: Layout of the rows.
        """
        sizes = {
            name: place.stop - place.start for name, place in layout.places.items()
        }
        states = {"behavior_state": plant.num_multibody_states()}
        if beside.places:
            states["plant_state"] = beside.num_states
        self.port_sizes = {
            port: sum(sizes[name] for name in channels)
            for port, channels in _PORTS.items()
        } | states
        own = [*_FIRST, *chain.from_iterable(_PORTS.values())]
        parts = [(name, sizes[name]) for name in own]
        parts += [*states.items(), *((name, sizes[name]) for name in _LAST)]
        ends = np.cumsum([size for _, size in parts])
        self.size = int(ends[-1]) + 1
        pieces = np.split(np.arange(ends[-1]), ends[:-1])
        at = {name: piece for (name, _), piece in zip(parts, pieces, strict=True)}
        self.measured = at.pop("behavior_state")
        world = at.pop("plant_state", None)
        if world is not None:
            for name, places in beside.places.items():
                at[name] = world[[*places.values()]]
        indices = robot.indices(plant)
        at["joints.position"] = self.measured[indices.q]
        at["joints.velocity"] = self.measured[plant.num_positions() + indices.v]
        for name in ("orientation", "position", "velocity"):
            at[f"pelvis.{name}"] = self.measured[getattr(indices.pelvis, name)]
        self.sources = np.concatenate([*at.values()])
        self.targets = np.r_[tuple(layout.places[name] for name in at)]


def take_sample(
    time: float,
    tick_time: float,
    numbers: np.ndarray,
    commands: CommandsInForce,
    status: ControllerStatus,
    imu: Imu,
) -> np.ndarray:
    """Makes one sample, as ``SampleLayout`` describes it; NaN for missing values.

    Args:
        time: Present time [s].
        tick_time: Wall time of the controller's tick [s].
        numbers: Values of the ports in ``port_sizes``, one after the other.
        commands: The commands in force.
        status: Value of the controller's status port.
        imu: Measurement of the IMU.
    """
    report = behavior_report(status, commands)
    plan, joints = status.plan, commands.joints
    orientation, rate = imu.orientation, imu.angular_velocity
    force = imu.linear_acceleration
    first = [
        time,
        tick_time,
        status.unsolved,
        NO_QP if status.solved is None else status.solved,
        commands.request.number,
        *reported(report, STATUS_CHANNELS),
        *(orientation.w, orientation.x, orientation.y, orientation.z),
        *(rate.x, rate.y, rate.z),
        *(force.x, force.y, force.z),
    ]
    return np.concatenate(
        (
            first,
            numbers,
            commands.k_effort,
            joints.position,
            joints.velocity,
            joints.effort,
            *(getattr(joints, name) for name in GAINS),
            *_references(plan),
            (plan.omega or np.nan,),
        )
    )


def _references(plan: Plan) -> list[np.ndarray]:
    """Returns the references of CoM, DCM and CoP, and the support polygon."""
    points = plan.com_reference, plan.dcm_reference, plan.cop_reference
    return [
        *(_UNKNOWN if point is None else point for point in points),
        _NO_SUPPORT if plan.support is None else flat_polygon(plan.support),
    ]


def flat_polygon(corners: np.ndarray) -> np.ndarray:
    """Flattens corners to a row of numbers, padded with NaN to the channel's size."""
    row = _NO_SUPPORT.copy()
    row[: 2 * len(corners)] = corners.ravel()
    return row


def polygon_from(row: np.ndarray) -> np.ndarray | None:
    """The reverse of ``flat_polygon``: shape (k, 2), or None without a polygon."""
    corners = row.reshape(-1, 2)
    corners = corners[np.isfinite(corners).all(axis=1)]
    return corners if len(corners) else None
