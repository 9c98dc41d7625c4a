"""One short recorded run that covers all kinds of data."""

import math

import numpy as np
import pytest

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    AtlasState,
    InvalidMessageError,
    Scenario,
    read_log,
)
from atlas_drake.clients.logs.header import Header
from atlas_drake.clients.logs.mcap_writer import McapWriter
from atlas_drake.frozen import replace
from atlas_drake.systems.record_reader import add_listener

ARM = AtlasState.r_arm_ely
PERIOD = Scenario().resolved().on_time_grid().control_period
END = 0.3
"""End of the run [s]."""
TICKS = math.ceil(END / PERIOD)


def arm_command():
    command = AtlasCommand()
    command.position = [0.0] * 28
    command.position[ARM] = 1.9
    command.kp_velocity = [20.0] * 28
    command.k_effort = [0] * 28
    command.k_effort[ARM] = 255
    return command


def walk_command():
    command = AtlasSimInterfaceCommand()
    command.behavior = command.WALK
    for place in range(4):
        step = AtlasBehaviorStepData()
        step.step_index, step.foot_index, step.duration = place + 1, place % 2, 0.63
        step.pose.position.x = 0.1 * place
        step.pose.position.y = (-1) ** place * 0.13
        step.swing_height = 0.1
        command.walk_params.step_queue[place] = step
    return command


def drive(sim):
    """The same commands, push and refusals for whoever is driven."""
    sim.advance_to(0.05)
    sim.publish(arm_command())
    sim.advance_to(0.1)
    # Neither fits: a share that is too large, a number that is too large for a float.
    for values in ([0, 300, *[0] * 26], [10**400] * 28):
        with pytest.raises(InvalidMessageError):
            sim.publish(AtlasCommand(k_effort=values))
    sim.apply_push("utorso", [5.0, 0.0, 0.0], 0.02)
    sim.advance_to(0.14)
    sim.publish(walk_command())
    sim.advance_to(END)


@pytest.fixture(scope="session")
def scenario():
    return Scenario(name="recorded", noise="reference", seed=3)


@pytest.fixture(scope="session")
def recorded(tmp_path_factory, scenario):
    """The simulation after its run, its log, and the records as a listener had them."""
    path, records = tmp_path_factory.mktemp("logs") / "run.mcap", []

    def listen(builder, station):
        add_listener(builder, station, "listener", records.append, paths=True)

    sim = AtlasSimulation(scenario, log=path, extend=listen)
    drive(sim)
    sim.close()
    return sim, read_log(path), records


@pytest.fixture(scope="session")
def run(recorded):
    """The simulation after its run, and its log."""
    return recorded[:2]


@pytest.fixture(scope="session")
def log(recorded):
    return recorded[1]


@pytest.fixture
def writer(log, tmp_path):
    """Writes another file with the schema of the log."""
    writer = McapWriter(tmp_path / "other.mcap")
    writer.begin(log.header, log.schema)
    return writer


def with_header(log, **facts):
    """The log with other facts in its header."""
    return replace(log, header=Header({**log.header.given, **facts}, log.path))


def assert_beginning_of(whole, found):
    """All that was found is as it was written; returns the number of records."""
    rows = len(found)
    assert 0 < rows <= len(whole)
    assert found.arrays.keys() == whole.arrays.keys()
    for name, values in found.arrays.items():
        assert values.dtype == whole[name].dtype, name
        np.testing.assert_array_equal(values, whole[name][:rows], err_msg=name)
    return rows
