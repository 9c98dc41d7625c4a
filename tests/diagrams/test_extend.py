"""The user's own systems in the simulation's diagram."""

import pytest
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import LeafSystem
from pydrake.systems.primitives import ConstantValueSource

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
)
from atlas_drake.errors import AtlasError


def manipulate(builder, station):
    """Adds a source that asks for MANIPULATE, always."""
    message = AtlasSimInterfaceCommand(behavior="MANIPULATE")
    source = builder.AddNamedSystem(
        "source", ConstantValueSource(AbstractValue.Make(message))
    )
    builder.Connect(
        source.get_output_port(), station.GetInputPort("atlas_sim_interface_command")
    )


def test_a_system_may_command_beside_publish():
    sim = AtlasSimulation(extend=manipulate)
    assert not sim.diagram.HasInputPort("atlas_sim_interface_command")
    sim.advance(0.02)
    assert sim.current_behavior is Behavior.MANIPULATE
    sim.publish(AtlasCommand(k_effort=[0] * 27 + [255]))
    sim.publish(AtlasSimInterfaceCommand(behavior="FREEZE"))
    sim.advance(0.02)
    assert sim.output("commands").k_effort[-1] == 255
    # The message that stays on its port was received before; the later one counts.
    assert sim.current_behavior is Behavior.FREEZE


def test_several_extensions_are_called_in_their_order():
    called = []
    AtlasSimulation(
        extend=[lambda *_: called.append("first"), lambda *_: called.append("second")]
    )
    assert called == ["first", "second"]


@pytest.mark.parametrize("wrong", ["view.py", None, [print, 3]])
def test_what_is_no_extension_is_named(wrong):
    with pytest.raises(AtlasError, match=r"extend must be a callable .* or a list"):
        AtlasSimulation(extend=wrong)


def test_a_schedule_leaves_the_command_ports_to_others():
    arms = {"time": 0.1, "atlas_command": {"k_effort": 255}}
    sim = AtlasSimulation(Scenario(messages=[arms]), extend=manipulate)
    sim.advance(0.2)
    assert sim.current_behavior is Behavior.MANIPULATE
    assert all(sim.atlas_state.k_effort)


@pytest.mark.parametrize("names", [["scheduler"], ["mine", "mine"], []])
def test_an_extension_that_drake_cannot_build_is_refused(names):
    def extend(builder, station):
        for name in names:
            builder.AddNamedSystem(name, LeafSystem())
        if not names:
            builder.Build()

    with pytest.raises(AtlasError, match="extend"):
        AtlasSimulation(Scenario(schedule="tutorial"), extend=extend)
