"""Peaks and work of a run, from made-up states."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from atlas_drake.systems.run_statistics import RunStatistics

TICK = 0.01
"""[s]"""


def test_peaks_are_peaks_in_message_order(robot):
    plant = robot.plant
    indices = robot.indices(plant)
    system = RunStatistics(robot, indices, plant.num_multibody_states(), TICK)
    simulator = Simulator(system)
    context = simulator.get_mutable_context()
    elbow = robot.joint_index("l_arm_ely")
    share = 0.5 * robot.effort_limit[elbow]
    for tick, (height, tilt, effort) in enumerate(
        [(0.9, 0.1, 0.0), (0.7, -0.4, -share), (0.8, 0.2, 0.5 * share)]
    ):
        state = np.zeros(plant.num_multibody_states())
        quaternion = [np.cos(0.5 * tilt), 0.0, np.sin(0.5 * tilt), 0.0]
        state[indices.pelvis.orientation] = quaternion
        state[indices.pelvis.position] = [0.0, 0.0, height]
        efforts = np.zeros(robot.num_joints)
        efforts[elbow] = effort
        system.GetInputPort("state").FixValue(context, state)
        system.GetInputPort("effort").FixValue(context, efforts)
        simulator.AdvanceTo((tick + 0.5) * TICK)
    peaks = np.zeros(robot.num_joints)
    peaks[elbow] = 0.5
    found = system.GetOutputPort("peaks").Eval(context)
    assert found == pytest.approx([*peaks, 0.7, 0.4])
