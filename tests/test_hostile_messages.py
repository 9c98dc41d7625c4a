"""Any messages in any order: faulty ones are refused by name, and change nothing."""

import numpy as np
import pytest

from atlas_drake import (
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
        sim.publish(None)  # Nothing to send, and nothing is.
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
