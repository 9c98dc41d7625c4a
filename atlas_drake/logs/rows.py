"""Samples of control ticks, and the rows of a log that are computed from them.

What follows from a sample, such as the center of mass, is computed for many rows at
once: between the steps of a simulation the same code takes twice as long. ``recorder``
samples, and writes the rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from atlas_drake.control.balance.feedback import pendulum_frequency
from atlas_drake.control.wrenches import center_of_pressure, shift_to_frames
from atlas_drake.logs.channels import Tick, recorded_channels
from atlas_drake.logs.layout import SIDES, Layout
from atlas_drake.logs.world_state import world_coordinates
from atlas_drake.robot import Robot
from atlas_drake.scenario.world import WorldMaker


class RowMaker:
    """Makes rows of one robot's log.

    Attributes:
        layout: Layout of the rows.
        port_sizes: Lengths of the station's vector-valued ports that a tick holds, by
            name.
        sample_size: Length of a sample: the numbers of a row that a tick has as they
            are, the state that the controller reads, and the plan's natural frequency.
    """

    def __init__(self, robot: Robot, world: Sequence[WorldMaker] = ()):
        """Takes the robot and its world, which define the coordinates of the plant."""
        self._plant: Any = robot.make_plant()
        # Overwritten by each row, and no part of the simulation.
        self._context = self._plant.CreateDefaultContext()
        beside = world_coordinates(robot, world)
        recorded = recorded_channels(robot, self._plant, beside)
        self.layout = Layout(channel for channel, _ in recorded)
        places = self.layout.places
        known = {channel.name: read for channel, read in recorded if read is not None}
        self._reads = known.values()
        self._targets = np.r_[tuple(places[name] for name in known)]
        self._num_states = self._plant.num_multibody_states()
        self.sample_size = len(self._targets) + self._num_states + 1
        efforts = "effort", "user_effort", "behavior_effort"
        self.port_sizes = {
            "state": self._num_states,
            "behavior_state": self._num_states,
            "contact_wrenches": 24,
            **dict.fromkeys(efforts, robot.num_joints),
        }
        if beside.places:
            self.port_sizes["plant_state"] = beside.num_states
        self._soles = [
            self._plant.GetFrameByName(foot.sole_frame) for foot in robot.file.feet
        ]
        hands = [self._plant.GetBodyByName(name) for name in robot.file.hands]
        self._touching = [*self._soles, *(hand.body_frame() for hand in hands)]
        self._positions = [places[f"feet.{side}_position"] for side in SIDES]
        self._orientations = [places[f"feet.{side}_orientation"] for side in SIDES]
        self._wrenches = slice(
            places["feet.left_torque"].start, places["hands.right_force"].stop
        )
        self._q = places["state.q"]
        self._com, self._com_velocity, self._dcm, self._cop = (
            places[f"balance.{name}"] for name in ("com", "com_velocity", "dcm", "cop")
        )

    def sample(self, tick: Tick) -> np.ndarray:
        """Reads what only the ports know of a tick, shape (sample_size,)."""
        numbers = [read(tick) for read in self._reads]
        omega = tick.status.plan.omega or np.nan
        return np.concatenate([*numbers, tick.ports["behavior_state"], (omega,)])

    def rows(self, samples: np.ndarray) -> np.ndarray:
        """Computes rows, shape (k, layout's width), of k samples.

        Missing values are NaN.
        """
        table = np.full((len(samples), self.layout.width), np.nan)
        table[:, self._targets] = samples[:, : len(self._targets)]
        for row, sample in zip(table, samples, strict=True):
            wrenches = row[self._wrenches].reshape(-1, 6)
            self._plant.SetPositions(self._context, row[self._q])
            shift_to_frames(wrenches, self._touching, self._context)
            measured, omega = sample[-1 - self._num_states : -1], float(sample[-1])
            self._complete(row, measured, omega, wrenches)
        return table

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
