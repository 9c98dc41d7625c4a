"""Samples of a log: what only a station's ports know, one array of numbers per tick.

``rows`` computes from samples what follows from them.
"""

from __future__ import annotations

from collections.abc import Iterable
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
        measured: Place of the state that the controller reads.
        sources: Index into a sample of each number that a row has as it is.
        targets: Index into a row of the same numbers.
    """

    def __init__(
        self, robot: Robot, plant: Any, beside: WorldCoordinates, layout: Layout
    ):
        """Makes the layout of the samples.

        Args:
            robot: The simulated robot.
            plant: Plant of the robot alone.
            beside: Coordinates of the models beside the robot.
            layout: Layout of the rows.
        """
        num_states, num_joints = plant.num_multibody_states(), robot.num_joints
        self.port_sizes = {
            "state": num_states,
            "contact_wrenches": 24,
            "effort": num_joints,
            "user_effort": num_joints,
            "behavior_effort": num_joints,
            "behavior_state": num_states,
        }
        if beside.q:
            self.port_sizes["plant_state"] = beside.num_states
        # By channel: index into a sample of each of its numbers.
        sources: dict[str, np.ndarray] = {}
        end = _add(sources, _FIRST, layout, 0)
        for port, size in self.port_sizes.items():
            if port == "behavior_state":
                self.measured = slice(end, end + size)
                sources |= _measured(plant, robot, end)
            elif port == "plant_state":
                sources |= {name: end + at for name, at in beside.indices.items()}
            else:
                _add(sources, _PORTS[port], layout, end)
            end += size
        self.size = _add(sources, _LAST, layout, end) + 1
        places = [layout.places[name] for name in sources]
        self.sources = np.concatenate([*sources.values()])
        self.targets = np.r_[tuple(places)]


def _add(
    sources: dict[str, np.ndarray], channels: Iterable[str], layout: Layout, start: int
) -> int:
    """Adds channels that lie one after the other; returns where they end."""
    for name in channels:
        place = layout.places[name]
        end = start + place.stop - place.start
        sources[name] = np.arange(start, end)
        start = end
    return start


def _measured(plant: Any, robot: Robot, start: int) -> dict[str, np.ndarray]:
    """Channels of the state that the controller reads, which begins at ``start``."""
    indices = robot.indices(plant)
    pelvis = indices.pelvis
    places = start + np.arange(plant.num_multibody_states())
    return {
        "joints.position": places[indices.q],
        "joints.velocity": places[plant.num_positions() + indices.v],
        "pelvis.orientation": places[pelvis.orientation],
        "pelvis.position": places[pelvis.position],
        "pelvis.velocity": places[pelvis.velocity],
    }


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
    return [
        *(
            _UNKNOWN if reference is None else reference
            for reference in (
                plan.com_reference,
                plan.dcm_reference,
                plan.cop_reference,
            )
        ),
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
