"""Any messages in any order: faulty ones are refused by name, and change nothing."""

import copy
import functools

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from atlas_drake import (
    AtlasBehaviorStepData,
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    BehaviorStatus,
    Header,
    InvalidMessageError,
    read_log,
)
from atlas_drake.messages.commands import KEPT
from atlas_drake.messages.fields import LARGEST

from .hostile import spoiled_commands

ARRAYS = (
    "position",
    "velocity",
    "effort",
    "kp_position",
    "ki_position",
    "kp_velocity",
    "k_effort",
)
"""Those that both commands have."""


def steps_ahead(sim, command):
    """Adds enough steps on the spot for the whole test."""
    report = sim.atlas_sim_interface_state
    for place in range(4):
        command.walk_params.step_queue[place] = AtlasBehaviorStepData(
            step_index=place + 1,
            foot_index=place % 2,
            duration=3.0,
            swing_height=0.05,
            pose=copy.deepcopy(report.foot_pos_est[place % 2]),
        )
    return command


@functools.cache
def robot_in(behavior):
    """A robot in that behavior, the same for all messages of a test."""
    sim = AtlasSimulation()
    sim.advance(0.1)
    if behavior is not Behavior.STAND:
        command = AtlasSimInterfaceCommand(behavior=behavior)
        if behavior is Behavior.WALK:
            steps_ahead(sim, command)
        sim.publish(command)
        sim.advance(0.02)
    if behavior is Behavior.STAND:
        sim.advance(2.0)
    assert sim.current_behavior is behavior
    return sim


@pytest.mark.slow
@pytest.mark.parametrize(
    "behavior", [Behavior.STAND, Behavior.WALK, Behavior.MANIPULATE, Behavior.USER]
)
@settings(
    max_examples=15,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
@given(
    letters=st.lists(
        st.tuples(spoiled_commands(), st.floats(0.0, 0.01)), min_size=10, max_size=10
    )
)
def test_hostile_messages_are_refused_and_change_nothing(behavior, letters):
    sim = robot_in(behavior)
    for (message, path), wait in letters:
        force, number = sim.output("commands"), len(sim.events)
        with pytest.raises(InvalidMessageError) as caught:
            sim.publish(message)
        sim.advance(0.004 + wait)
        assert caught.value.field.startswith(path)
        after = sim.output("commands")
        assert after.joints is force.joints
        assert after.request is force.request
        assert after.error_code is caught.value.error_code
        assert after.error_code != 0
        assert sim.atlas_sim_interface_state.error_code == after.error_code
        fresh = [e for e in sim.events[number:] if e.kind == "refusal"]
        assert [caught.value.field in event.text for event in fresh] == [True]
        assert np.isfinite(sim.output("state")).all()
        assert np.isfinite(sim.output("effort")).all()
    report = sim.atlas_sim_interface_state
    if behavior is not Behavior.USER:
        assert report.current_behavior in (behavior, Behavior.STAND)
        assert not sim.has_fallen
    if behavior is Behavior.STAND:
        assert sim.pelvis_pose.translation()[2] > 0.8
        assert np.abs(sim.atlas_state.velocity).max() < 0.1
        assert not report.behavior_feedback.status_flags & BehaviorStatus.ERROR_FALLING


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    """A robot whose log gets all that is accepted."""
    file = tmp_path_factory.mktemp("hostile") / "run.mcap"
    with AtlasSimulation(log=file) as sim:
        sim.advance(0.01)  # Each test may run alone; a log has a sample.
        yield sim
        commands = sim.output("commands")
    assert len(read_log(file).commands) == commands.received - commands.refused


def test_a_port_refuses_values_that_are_no_command_and_the_log_continues(
    tmp_path, caplog
):
    things = ["STAND", [1.0], {"behavior": 3}, 10**5000]
    with AtlasSimulation(log=tmp_path / "run.mcap") as sim:
        port = sim.diagram.GetInputPort("atlas_sim_interface_command")
        for number, thing in enumerate(things, 1):
            port.FixValue(sim.context, thing)
            sim.advance(0.02)
            assert sim.output("commands").refused == number
        sim.publish(AtlasSimInterfaceCommand(behavior="FREEZE"))
        sim.advance(0.01)
        assert sim.current_behavior is Behavior.FREEZE
    log = read_log(tmp_path / "run.mcap")
    assert [entry.message.behavior for entry in log.commands] == ["FREEZE"]
    assert [e.kind for e in log.events] == [*["refusal"] * len(things), "behavior"]
    assert sum("must be" in record.getMessage() for record in caplog.records) == 1


def test_numbers_of_every_kind_are_numbers(logged):
    """Python's own from then on, so that behaviors can calculate with them."""
    sim = logged
    command = AtlasSimInterfaceCommand(behavior=np.int64(Behavior.MANIPULATE))
    command.manipulate_params.use_desired = np.True_
    desired = command.manipulate_params.desired
    desired.pelvis_height = np.float64(0.85)
    desired.pelvis_pitch = np.float32(0.125)
    desired.com_v0 = np.int16(0)
    command.position = [np.float16(0.5), *[np.uint8(1)] * 27]
    sim.publish(command)
    sim.advance(0.01)
    assert sim.current_behavior is Behavior.MANIPULATE
    heard = sim.output("commands").request.command
    assert type(heard.manipulate_params.desired.pelvis_height) is float
    assert heard.manipulate_params.desired.pelvis_pitch == 0.125
    assert sim.output("commands").joints.position[1] == 1.0


def test_none_of_many_messages_of_one_instant_is_lost(tmp_path):
    count = KEPT + 10
    with AtlasSimulation(log=tmp_path / "run.mcap") as sim:
        sim.advance(0.01)
        for number in range(count):
            behavior = ("FREEZE", "STAND")[number % 2]
            sim.publish(AtlasSimInterfaceCommand(behavior=behavior))
            with pytest.raises(InvalidMessageError):
                sim.publish(AtlasCommand(position=[float(number)]))
        sim.advance(0.01)
    events = [event.kind for event in sim.events]
    assert events.count("refusal") == count
    assert sim.output("commands").refused == count
    assert events.count("behavior") == count
    log = read_log(tmp_path / "run.mcap")
    assert len(log.commands) == count
    assert all(command.time == pytest.approx(0.01) for command in log.commands)
    assert len(log.events) == len(sim.events)


def test_the_same_message_published_again_counts_again(logged):
    message = AtlasSimInterfaceCommand(behavior="STAND")
    for _ in range(3):
        before = logged.output("commands").received
        logged.publish(message)
        assert logged.output("commands").request.number == before + 1


def test_publish_refuses_values_that_are_no_command(logged):
    for thing in (None, 5, "STAND", Header(), object()):
        with pytest.raises(TypeError, match="publish takes an AtlasCommand"):
            logged.publish(thing)


def violent(random, decades):
    """A command that is legal, and that no sane person would send."""
    if random.random() < 0.5:
        behavior = random.choice([b.name for b in sorted(Behavior)])
        command = AtlasSimInterfaceCommand(behavior=str(behavior))
    else:
        command = AtlasCommand()
        command.kd_position = 10.0 ** random.uniform(-3, 3, 28)
        command.i_effort_min = -(10.0 ** random.uniform(-3, 3, 28))
        command.i_effort_max = 10.0 ** random.uniform(-3, 3, 28)
    for name in ARRAYS[:-1]:
        if random.random() < 0.4:
            sign = 1.0 if name.startswith("k") else random.choice([-1.0, 1.0], 28)
            setattr(command, name, sign * 10.0 ** random.uniform(-3, decades, 28))
    if random.random() < 0.7:
        command.k_effort = random.integers(0, 256, 28)
    return command


@pytest.mark.slow
def test_violent_messages_throw_the_robot_down_and_nothing_else():
    random, decades = np.random.default_rng(2), np.log10(LARGEST)
    sim = AtlasSimulation()
    limit = sim.robot.effort_limit
    for number in range(150):
        sim.publish(violent(random, decades))
        sim.advance(float(random.uniform(0.0, 0.04)))
        assert np.isfinite(sim.output("state")).all()
        assert (np.abs(sim.output("effort")) <= limit + 1e-9).all()
        if number % 50 == 49:
            sim.reset()
    sim.advance(1.0)
    assert sim.current_behavior is Behavior.STAND
    assert not sim.has_fallen
