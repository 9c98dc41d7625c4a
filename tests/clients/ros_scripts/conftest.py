"""A robot for programs to run on."""

import math
import sys
import threading
import time
from collections import namedtuple

import pytest

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.clients.ros_scripts.program import Program

Ran = namedtuple("Ran", "problem at_fault printed said complained sim")
STEPS = {"physics_step": 0.002, "control_period": 0.004}
"""The tests know at which times messages come."""


@pytest.fixture(scope="module")
def shared_sim():
    return AtlasSimulation(Scenario(**STEPS))


@pytest.fixture
def sim(shared_sim):
    """One that has just begun."""
    shared_sim.hooks.clear()
    shared_sim.reset(seed=0)
    return shared_sim


@pytest.fixture
def run(sim, tmp_path, capsys):
    """Runs the text of a program for at most ``end`` simulated seconds."""

    def run(text, *arguments, end=math.inf, on=sim, ended=lambda: False):
        path = tmp_path / "program.py"
        path.write_text(text)
        said, complained = [], []
        program = Program(path, arguments)
        threads = set(threading.enumerate())
        before = dict(sys.modules), sys.argv, list(sys.path), time.time
        problem = program.run(on, ended, end, said.append, complained.append)
        assert (sys.argv, sys.path, time.time) == before[1:]
        assert "rospy" not in sys.modules
        for thread in set(threading.enumerate()) - threads:
            thread.join(1.0)
        assert set(threading.enumerate()) <= threads
        assert sys.modules["__main__"] is before[0]["__main__"]
        return Ran(
            problem,
            program.at_fault,
            capsys.readouterr().out.split("\n")[:-1],
            said,
            "\n".join(complained),
            on,
        )

    return run
