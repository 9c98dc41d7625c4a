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
    InvalidMessageError,
    read_log,
)
from atlas_drake.messages.commands import KEPT
from atlas_drake.messages.fields import LARGEST
from atlas_drake.messages.joint_command import JOINT_FIELDS

from .hostile import spoiled_commands


@functools.cache
def robot_in(behavior):
    """A robot in that behavior, the same for all messages of a test."""
    sim = AtlasSimulation()
    sim.advance(0.1)
    command = AtlasSimInterfaceCommand(behavior=behavior)
    for place in range(4):  # Steps on the spot, for the whole test.
        command.walk_params.step_queue[place] = AtlasBehaviorStepData(
            step_index=place + 1,
            foot_index=place % 2,
            duration=3.0,
            swing_height=0.05,
            pose=copy.deepcopy(sim.atlas_sim_interface_state.foot_pos_est[place % 2]),
        )
    sim.publish(command)
    sim.advance(2.0 if behavior is Behavior.STAND else 0.02)
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
        assert (after.joints, after.request) == (force.joints, force.request)
        assert after.error_code is caught.value.error_code
        assert sim.atlas_sim_interface_state.error_code == after.error_code != 0
        fresh = [e for e in sim.events[number:] if e.kind == "refusal"]
        assert [caught.value.field in event.text for event in fresh] == [True]
        assert np.isfinite(sim.output("state")).all()
        assert np.isfinite(sim.output("effort")).all()
    if behavior is not Behavior.USER:
        assert sim.current_behavior in (behavior, Behavior.STAND)
        assert not sim.has_fallen
    if behavior is Behavior.STAND:
        assert np.abs(sim.atlas_state.velocity).max() < 0.1


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
        for thing in things:
            with pytest.raises(TypeError, match="publish"):
                sim.publish(thing)
        sim.publish(AtlasSimInterfaceCommand(behavior="FREEZE"))
        sim.advance(0.01)
        assert sim.current_behavior is Behavior.FREEZE
    log = read_log(tmp_path / "run.mcap")
    assert [entry.message.behavior for entry in log.commands] == ["FREEZE"]
    assert [e.kind for e in log.events] == [*["refusal"] * len(things), "behavior"]
    assert sum("must be" in record.getMessage() for record in caplog.records) == 1


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
    assert events.count("refusal") == sim.output("commands").refused == count
    assert events.count("behavior") == count
    log = read_log(tmp_path / "run.mcap")
    assert [command.time for command in log.commands] == pytest.approx(count * [0.01])
    assert len(log.events) == len(sim.events)


def violent(random, decades):
    """A command that is legal, and that no sane person would send."""
    kind = (AtlasCommand, AtlasSimInterfaceCommand)[random.random() < 0.5]
    command = kind()
    if kind is AtlasSimInterfaceCommand:
        command.behavior = str(random.choice([b.name for b in sorted(Behavior)]))
    for name in JOINT_FIELDS[:-1]:
        if hasattr(command, name) and random.random() < 0.4:
            sign = 1.0 if name.startswith("k") else random.choice([-1.0, 1.0], 28)
            setattr(command, name, sign * 10.0 ** random.uniform(-3, decades, 28))
    if kind is AtlasCommand:
        command.i_effort_min = -(10.0 ** random.uniform(-3, 3, 28))
        command.i_effort_max = 10.0 ** random.uniform(-3, 3, 28)
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
