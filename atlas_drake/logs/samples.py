"""Computes a log's rows from the values of a station's ports.

Each tick gives a sample, which holds what only the ports know. What follows from a
sample, such as the center of mass, is computed for many rows at once: between the steps
of a simulation the same code takes twice as long. ``recorder`` samples, and writes the
rows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from atlas_drake.control.balance.center_of_pressure import center_of_pressure
from atlas_drake.control.balance.feedback import pendulum_frequency
from atlas_drake.control.rotations import shift_wrench
from atlas_drake.logs.channels import GAINS, robot_layout
from atlas_drake.logs.layout import SIDES
from atlas_drake.logs.report_channels import STATUS_CHANNELS, reported
from atlas_drake.logs.world_state import world_coordinates
from atlas_drake.messages.controller_status import LARGEST_SUPPORT, Plan
from atlas_drake.messages.reported_status import reported_status
from atlas_drake.robot import Robot
from atlas_drake.scenario.world import WorldMaker

NO_QP = -1
"""Value of ``controller.solved`` where a controller has, or needed, no QP."""
_SAMPLED = (
    "time",
    "controller.tick_time",
    "controller.unsolved",
    "controller.solved",
    "behavior.request_number",
    *(entry.channel.name for entry in STATUS_CHANNELS),
    "imu.orientation",
    "imu.angular_velocity",
    "imu.linear_acceleration",
    *(
        f"{owner}.{side}_{name}"
        for owner in ("feet", "hands")
        for side in SIDES
        for name in ("torque", "force")
    ),
    "joints.effort",
    "joints.user_effort",
    "joints.behavior_effort",
    "joints.k_effort",
    "joints.position_setpoint",
    "joints.velocity_setpoint",
    "joints.effort_setpoint",
    *(f"gains.{name}" for name in GAINS),
    "balance.com_reference",
    "balance.dcm_reference",
    "balance.cop_reference",
    "balance.support",
    "state.q",
    "state.v",
)
"""The channels that a sample holds, in its order. After them come those of the world,
and then the plan's natural frequency and the controller's state."""
_UNKNOWN = np.full(2, np.nan)
_NO_SUPPORT = np.full(2 * LARGEST_SUPPORT, np.nan)


class RowSampler:
    """Makes rows of one robot's log.

    Attributes:
        layout: Layout of the rows.
        port_sizes: Lengths of the vector-valued ports that rows are made of, by name.
        sample_size: Length of a sample.
    """

    def __init__(self, robot: Robot, world: Sequence[WorldMaker] = ()):
        """Takes the robot and its world, which define the coordinates of the plant."""
        self._plant: Any = robot.make_plant()
        # Overwritten by each row, and no part of the simulation.
        self._context = self._plant.CreateDefaultContext()
        self._world = world_coordinates(robot, world)
        self._soles = [
            self._plant.GetFrameByName(foot.sole_frame) for foot in robot.file.feet
        ]
        hands = [self._plant.GetBodyByName(name) for name in robot.file.hands]
        self._touching = [*self._soles, *(hand.body_frame() for hand in hands)]
        self.layout = robot_layout(
            robot,
            self._plant.GetPositionNames(add_model_instance_prefix=False),
            self._plant.GetVelocityNames(add_model_instance_prefix=False),
            self._world,
        )
        places = self.layout.places
        sampled = [*_SAMPLED, *self._world.names]
        self._targets = np.r_[tuple(places[name] for name in sampled)]
        num_states, num_joints = self._plant.num_multibody_states(), robot.num_joints
        self.sample_size = len(self._targets) + 1 + num_states
        self.port_sizes = {
            "state": num_states,
            "behavior_state": num_states,
            "contact_wrenches": 24,
            "effort": num_joints,
            "user_effort": num_joints,
            "behavior_effort": num_joints,
        }
        if self._world.q:
            self.port_sizes["plant_state"] = self._world.num_states
        num_q, indices = self._plant.num_positions(), robot.indices(self._plant)
        self._measured = {
            "joints.position": indices.q,
            "joints.velocity": num_q + indices.v,
            "pelvis.orientation": indices.pelvis.orientation,
            "pelvis.position": indices.pelvis.position,
            "pelvis.velocity": indices.pelvis.velocity,
        }
        self._positions = [places[f"feet.{side}_position"] for side in SIDES]
        self._orientations = [places[f"feet.{side}_orientation"] for side in SIDES]
        self._wrenches = slice(
            places["feet.left_torque"].start, places["hands.right_force"].stop
        )
        self._q = places["state.q"]
        self._com, self._com_velocity, self._dcm, self._cop = (
            places[f"balance.{name}"] for name in ("com", "com_velocity", "dcm", "cop")
        )

    def sample(
        self, time: float, tick_time: float, ports: Mapping[str, Any]
    ) -> np.ndarray:
        """Reads one sample, shape (sample_size,); NaN for missing values.

        Args:
            time: Present time [s].
            tick_time: Wall time of the controller's tick [s].
            ports: Values of the station's ports, by name.

        Raises:
            TypeError: If the controller's status is not a status.
            ValueError: If it names a behavior that is not registered.
        """
        commands, imu = ports["commands"], ports["imu"]
        status = reported_status(ports["controller_status"], commands)
        plan, joints = status.plan, commands.joints
        orientation, rate = imu.orientation, imu.angular_velocity
        force = imu.linear_acceleration
        numbers = [
            time,
            tick_time,
            status.unsolved,
            NO_QP if status.solved is None else status.solved,
            commands.request.number,
            *reported(status, STATUS_CHANNELS),
            *(orientation.w, orientation.x, orientation.y, orientation.z),
            *(rate.x, rate.y, rate.z),
            *(force.x, force.y, force.z),
        ]
        return np.concatenate(
            (
                numbers,
                ports["contact_wrenches"],
                ports["effort"],
                ports["user_effort"],
                ports["behavior_effort"],
                commands.k_effort,
                joints.position,
                joints.velocity,
                joints.effort,
                *(getattr(joints, name) for name in GAINS),
                *_references(plan),
                ports["state"],
                *self._world.channels(ports),
                (plan.omega or np.nan,),
                ports["behavior_state"],
            )
        )

    def rows(self, samples: np.ndarray) -> np.ndarray:
        """Computes rows, shape (k, layout's width); NaN for missing values.

        Args:
            samples: Samples of ``sample``, shape (k, sample_size).
        """
        table = np.full((len(samples), self.layout.width), np.nan)
        end = len(self._targets)
        table[:, self._targets] = samples[:, :end]
        omegas, states = samples[:, end], samples[:, end + 1 :]
        for name, indices in self._measured.items():
            table[:, self.layout.places[name]] = states[:, indices]
        for row, state, omega in zip(table, states, omegas.tolist(), strict=True):
            wrenches = row[self._wrenches].reshape(-1, 6)
            self._shift(wrenches, row[self._q])
            self._complete(row, state, omega, wrenches)
        return table

    def _shift(self, wrenches: np.ndarray, q: np.ndarray) -> None:
        """Shifts wrenches on feet and hands from W's origin to their frames' origins.

        Args:
            wrenches: Moments and forces in W [N·m; N], shape (4, 6); they are changed.
            q: The robot's positions.
        """
        self._plant.SetPositions(self._context, q)
        for wrench, frame in zip(wrenches, self._touching, strict=False):
            if wrench.any():
                X_WF = frame.CalcPoseInWorld(self._context)
                shift_wrench(wrench, X_WF.translation())

    def _complete(
        self, row: np.ndarray, state: np.ndarray, omega: float, wrenches: np.ndarray
    ) -> None:
        """Adds soles, center of mass, DCM and CoP.

        Args:
            row: The row; it is changed.
            state: State that the controller reads, in plant order.
            omega: The plan's natural frequency [1/s]; NaN if there is none.
            wrenches: Wrenches on feet and hands, at their frames' origins.
        """
        self._plant.SetPositionsAndVelocities(self._context, state)
        soles = [frame.CalcPoseInWorld(self._context) for frame in self._soles]
        positions = [sole.translation() for sole in soles]
        for sole, p_WF, position, orientation in zip(
            soles, positions, self._positions, self._orientations, strict=True
        ):
            row[position] = p_WF
            row[orientation] = sole.rotation().ToQuaternion().wxyz()
        com = self._plant.CalcCenterOfMassPositionInWorld(self._context)
        velocity = self._plant.CalcCenterOfMassTranslationalVelocityInWorld(
            self._context
        )
        if np.isnan(omega):
            ground = 0.5 * sum(float(p_WF[2]) for p_WF in positions)
            omega = pendulum_frequency(float(com[2]) - ground)
        row[self._com], row[self._com_velocity] = com, velocity
        row[self._dcm] = com[:2] + velocity[:2] / omega
        cop = center_of_pressure(positions, wrenches[:2].ravel())
        if cop is not None:
            row[self._cop] = cop[:2]


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
