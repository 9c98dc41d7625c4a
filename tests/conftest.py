"""Fixtures and hooks that several test files share."""

import contextlib
import logging
import os
import resource
import runpy
import signal
import sys

# Small matrices: threads of the linear algebra only wait for each other. Before numpy.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pytest
from hypothesis import settings
from pydrake.common.value import AbstractValue, Value

from atlas_drake import AtlasCommand, StepStream
from atlas_drake.errors import RobotDescriptionError
from atlas_drake.robot import LOCAL_MODELS, load_robot

from .filled import filled
from .page_numbers import numbers_on_page as numbers_of_page

# A busy machine must not fail a test, and a failure must come back when looked for.
settings.register_profile(
    "atlas_drake", deadline=None, derandomize=True, max_examples=40
)
settings.load_profile("atlas_drake")

SHORT = "duration: 0.1\n"
BROWSER = "tests/browser/"
LAWS = "_laws.py"
"""End of the name of a file whose tests share the records of a few runs."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Has one worker take all tests in a browser, first; the others share the rest.

    The laws of one file stay with one worker, which plays their runs once.
    """
    from xdist.scheduler import LoadScopeScheduling

    class OneBrowser(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            file = nodeid.partition("::")[0]
            if nodeid.startswith(BROWSER):
                return BROWSER
            return file if file.endswith(LAWS) else nodeid

    return OneBrowser(config, log) if config.getoption("dist") == "load" else None


@pytest.fixture(autouse=True, scope="session")
def _no_none_in_abstract_values():
    """Refuses None as Drake's nanobind bindings do, also where Drake has pybind11's."""

    def refused(call):
        def checked(*arguments):
            if arguments[-1] is None:
                raise TypeError("an abstract value cannot hold None; see NOTHING")
            return call(*arguments)

        return checked

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(AbstractValue, "Make", staticmethod(refused(AbstractValue.Make)))
        of_python = Value[object]
        patch.setattr(of_python, "set_value", refused(of_python.set_value))
        yield


@pytest.fixture(scope="session")
def load_or_skip():
    """Loads a robot by name; skips the test if its files are not available offline."""

    def load(name):
        with pytest.MonkeyPatch.context() as patch:
            if name == "drake_atlas":
                patch.setenv("DRAKE_ALLOW_NETWORK", "none")
            try:
                return load_robot(name)
            except RobotDescriptionError as error:
                if LOCAL_MODELS in error.problem:
                    pytest.skip("Drake's models are not in its cache")
                raise

    return load


@pytest.fixture
def restored_loggers():
    """Loggers after the test as before it: the command line sets them up."""
    names = ("atlas_drake", "drake", "trimesh", "yourdfpy")
    loggers = [logging.getLogger(name) for name in names]
    before = [(log.propagate, log.level, list(log.filters)) for log in loggers]
    yield
    for log, (propagate, level, filters) in zip(loggers, before, strict=True):
        log.propagate, log.filters = propagate, filters
        log.setLevel(level)


@pytest.fixture
def run_program(monkeypatch, capsys):
    """Runs a program in this process; gives its exit status and what it printed."""
    handler = signal.getsignal(signal.SIGINT)

    def run(path, *arguments):
        monkeypatch.setattr(sys, "argv", [str(path), *arguments])
        monkeypatch.setattr(sys, "stdin", None)  # Nobody answers, should it ask.
        status = 0
        try:
            runpy.run_path(str(path), run_name="__main__")
        except SystemExit as ended:
            status = ended.code or 0
        return int(status), capsys.readouterr().out

    yield run
    signal.signal(signal.SIGINT, handler)


@pytest.fixture
def take():
    """Gives the user joints, bool (n,), with the default gains and a k_effort.

    The set-points are where the joints are, or ``jump`` [rad] away.
    """

    def take(sim, joints, k=255, jump=0.0):
        command = AtlasCommand()
        command.position = sim.atlas_state.position + jump * joints
        command.kp_position = sim.robot.default_kp
        command.kd_position = sim.robot.default_kd
        command.k_effort = np.where(joints, k, 0)
        sim.publish(command)

    return take


@pytest.fixture(name="filled", scope="session")
def _filled():
    """Makes a message with another number in each field."""
    return filled


@pytest.fixture
def walk():
    """Sends steps as they are needed, until the robot stands; gives the footsteps."""

    def walk(sim, steps, **params):
        stream, end = StepStream(steps), sim.time + 1.5 * len(steps) + 5.0
        while not stream.is_over(sim.atlas_sim_interface_state):
            assert sim.time < end
            assert not sim.has_fallen
            command = stream.next_command(sim.atlas_sim_interface_state)
            if command is not None:
                for name, value in params.items():
                    setattr(command.walk_params, name, value)
                sim.publish(command)
            sim.advance(0.1)
        return sim.footsteps

    return walk


@pytest.fixture
def scenario(tmp_path):
    """Writes a scenario's file and gives its path."""

    def write(text=SHORT):
        path = tmp_path / "scenario.yaml"
        path.write_text(text)
        return str(path)

    return write


@pytest.fixture
def largest_file():
    """Lets files of this process get no larger than a size [byte], in a `with`."""

    @contextlib.contextmanager
    def limit(size):
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)

    return limit


@pytest.fixture
def summary_keys():
    """What a summary holds at least."""
    return {
        "success",
        "fell",
        "model",
        "seed",
        "sim_time",
        "wall_time",
        "real_time_factor",
        "physics_step",
        "control_period",
        "controller_tick_ms",
        "min_pelvis_height",
        "max_pelvis_tilt_rad",
        "final_pelvis_pose",
        "footsteps",
        "peak_effort_fraction",
        "events",
    }


@pytest.fixture
def numbers_on_page():
    """A function (sim, record) that finds every number where the page does."""
    return numbers_of_page
