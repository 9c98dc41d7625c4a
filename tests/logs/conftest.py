"""One short recorded run that covers all kinds of data."""

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

ARM = AtlasState.r_arm_ely
PACKAGES = {".npz": "numpy", ".mcap": "mcap", ".parquet": "pyarrow"}


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


END = 0.3
"""End of the run [s]."""


def drive(sim):
    """The same commands, push and refusals for whoever is driven."""
    sim.advance_to(0.05)
    sim.publish(arm_command())
    sim.advance_to(0.1)
    bad = AtlasCommand()
    bad.k_effort = [0, 300, *[0] * 26]
    with pytest.raises(InvalidMessageError):
        sim.publish(bad)
    sim.apply_push("utorso", [5.0, 0.0, 0.0], 0.02)
    sim.advance_to(0.14)
    sim.publish(walk_command())
    sim.advance_to(END)


@pytest.fixture(scope="session")
def scenario():
    return Scenario(name="recorded", noise="reference", seed=3)


@pytest.fixture(scope="session")
def run(tmp_path_factory, scenario):
    """The simulation after its run, and its log."""
    path = tmp_path_factory.mktemp("logs") / "run.npz"
    sim = AtlasSimulation(scenario, log=path)
    drive(sim)
    sim.close()
    return sim, read_log(path)


@pytest.fixture
def log(run):
    return run[1]


@pytest.fixture(params=sorted(PACKAGES))
def suffix(request):
    pytest.importorskip(PACKAGES[request.param])
    return request.param


def assert_same_arrays(a, b, rows=None):
    assert a.keys() == b.keys()
    for name in a:
        assert a[name].dtype == b[name].dtype, name
        np.testing.assert_array_equal(a[name][:rows], b[name][:rows], err_msg=name)
