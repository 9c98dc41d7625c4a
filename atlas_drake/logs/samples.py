"""Computes a log's row at one instant from the values of a station's ports.

``recorder`` samples and writes the rows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydrake.systems.framework import Context

from atlas_drake.control.balance.center_of_pressure import center_of_pressure
from atlas_drake.control.balance.feedback import pendulum_frequency
from atlas_drake.logs.channels import GAINS, robot_layout
from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.report_channels import REPORT_CHANNELS, reported
from atlas_drake.logs.world_state import world_coordinates
from atlas_drake.messages import AtlasSimInterfaceState
from atlas_drake.messages.controller_status import LARGEST_SUPPORT
from atlas_drake.robot import Robot
from atlas_drake.scenario.world import WorldMaker

NO_QP = -1
"""Value of ``controller.solved`` where a controller has, or needed, no QP."""


class RowSampler:
    """Makes rows of one robot's log.

    Attributes:
        layout: Layout of the rows.
        port_sizes: Lengths of the vector-valued ports that rows are made of, by name.
    """

    def __init__(self, robot: Robot, world: Sequence[WorldMaker] = ()):
        """Takes the robot and its world, which define the coordinates of the plant."""
        self._plant = plant = robot.make_plant()
        self._world = world_coordinates(robot, world)
        self.layout = robot_layout(
            robot,
            plant.GetPositionNames(add_model_instance_prefix=False),
            plant.GetVelocityNames(add_model_instance_prefix=False),
            self._world,
        )
        places = [self.layout.places[entry.channel.name] for entry in REPORT_CHANNELS]
        self._reported = np.r_[tuple(places)]
        num_states, num_joints = plant.num_multibody_states(), robot.num_joints
        self.port_sizes = {
            "state": num_states,
            "behavior_state": num_states,
            "foot_wrenches": 12,
            "hand_wrenches": 12,
            "effort": num_joints,
            "user_effort": num_joints,
            "behavior_effort": num_joints,
        }
        if self._world.q:
            self.port_sizes["plant_state"] = self._world.num_states
        self._indices = robot.indices(plant)
        self._num_q = plant.num_positions()

    def create_context(self) -> Context:
        """Creates a scratch context for ``row``, which overwrites it."""
        return self._plant.CreateDefaultContext()

    def row(
        self, scratch: Context, time: float, tick_time: float, ports: Mapping[str, Any]
    ) -> np.ndarray:
        """Computes one row, shape (layout's width,); NaN for missing values.

        Args:
            scratch: Context from ``create_context``.
            time: Present time [s].
            tick_time: Wall time of the controller's tick [s].
            ports: Values of the station's ports, by name.
        """
        status = ports["controller_status"]
        values: dict[str, Any] = {
            "time": time,
            "controller.tick_time": tick_time,
            "controller.unsolved": status.unsolved,
            "controller.solved": NO_QP if status.solved is None else status.solved,
            **self._joints(ports),
            **_commanded(ports["commands"]),
            **_measured_by_imu(ports["imu"]),
            **self._coordinates(ports),
            **self._balance(scratch, ports),
        }
        for owner, wrenches in (
            ("feet", ports["foot_wrenches"]),
            ("hands", ports["hand_wrenches"]),
        ):
            for k, side in enumerate(SIDES):
                values[f"{owner}.{side}_torque"] = wrenches[6 * k : 6 * k + 3]
                values[f"{owner}.{side}_force"] = wrenches[6 * k + 3 : 6 * k + 6]
        report: AtlasSimInterfaceState = ports["atlas_sim_interface_state"]
        soles = [pose.position.to_array() for pose in report.foot_pos_est]
        cop = center_of_pressure(soles, ports["foot_wrenches"])
        if cop is not None:
            values["balance.cop"] = cop[:2]
        row = np.full(self.layout.width, np.nan)
        row[self._reported] = reported(report)
        for name, value in values.items():
            row[self.layout.places[name]] = value
        return row

    def _joints(self, ports: Mapping[str, Any]) -> dict[str, Any]:
        measured = ports["behavior_state"]
        return {
            "joints.position": measured[self._indices.q],
            "joints.velocity": measured[self._num_q + self._indices.v],
            "joints.effort": ports["effort"],
            "joints.user_effort": ports["user_effort"],
            "joints.behavior_effort": ports["behavior_effort"],
        }

    def _coordinates(self, ports: Mapping[str, Any]) -> dict[str, Any]:
        return {
            "pelvis.orientation": ports["behavior_state"][
                self._indices.pelvis.orientation
            ],
            "state.q": ports["state"][: self._num_q],
            "state.v": ports["state"][self._num_q :],
            **self._world.channels(ports),
        }

    def _balance(self, scratch: Context, ports: Mapping[str, Any]) -> dict[str, Any]:
        """Center of mass and DCM from the controller's state, and their references."""
        plant: Any = self._plant
        plant.SetPositionsAndVelocities(scratch, ports["behavior_state"])
        com = plant.CalcCenterOfMassPositionInWorld(scratch)
        velocity = plant.CalcCenterOfMassTranslationalVelocityInWorld(scratch)
        report: AtlasSimInterfaceState = ports["atlas_sim_interface_state"]
        soles = [foot.position.z for foot in report.foot_pos_est]
        height = com[2] - 0.5 * sum(soles)
        plan = ports["controller_status"].plan
        omega = plan.omega or pendulum_frequency(height)
        values = {
            "balance.com": com,
            "balance.com_velocity": velocity,
            "balance.dcm": com[:2] + velocity[:2] / omega,
        }
        for name in ("com", "dcm", "cop"):
            reference = getattr(plan, f"{name}_reference")
            if reference is not None:
                values[f"balance.{name}_reference"] = reference
        if plan.support is not None:
            values["balance.support"] = flat_polygon(plan.support)
        return values


def flat_polygon(corners: np.ndarray) -> np.ndarray:
    """Flattens corners to a row of numbers, padded with NaN to the channel's size."""
    row = np.full(2 * LARGEST_SUPPORT, np.nan)
    kept = corners[:LARGEST_SUPPORT]
    row[: 2 * len(kept)] = kept.ravel()
    return row


def polygon_from(row: np.ndarray) -> np.ndarray | None:
    """The reverse of ``flat_polygon``: shape (k, 2), or None without a polygon."""
    corners = row.reshape(-1, 2)
    corners = corners[np.isfinite(corners).all(axis=1)]
    return corners if len(corners) else None


def _commanded(commands: Any) -> dict[str, Any]:
    """Values of ``CommandsInForce`` about joints and requests."""
    joints = commands.joints
    return {
        "behavior.request_number": commands.request.number,
        "joints.k_effort": commands.k_effort,
        "joints.position_setpoint": joints.position,
        "joints.velocity_setpoint": joints.velocity,
        "joints.effort_setpoint": joints.effort,
        **{f"gains.{name}": getattr(joints, name) for name in GAINS},
    }


def _measured_by_imu(imu: Any) -> dict[str, Any]:
    return {
        "imu.orientation": imu.orientation.to_wxyz(),
        "imu.angular_velocity": imu.angular_velocity.to_array(),
        "imu.linear_acceleration": imu.linear_acceleration.to_array(),
    }
