"""All arrays that sockets hand out are read-only, so that nobody changes a Context."""

from dataclasses import replace

import numpy as np
import pytest

from atlas_drake import (
    AtlasCommand,
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
)
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.shipped import shipped_entry

PERIOD = 0.01
"""Of the controller that only listens [s]."""


def writable(value, path, seen=None):
    """Paths of the arrays within a value that can be written into."""
    seen = {} if seen is None else seen
    if id(value) in seen or isinstance(value, type):
        return set()
    seen[id(value)] = value
    if isinstance(value, np.ndarray):
        return {path} if value.flags.writeable else set()
    if isinstance(value, (tuple, list)):
        parts = enumerate(value)
    elif isinstance(value, dict):
        parts = value.items()
    elif type(value).__module__.startswith("atlas_drake"):
        # Fields, cached properties and attributes.
        names = [*getattr(value, "__slots__", ()), *getattr(value, "__dict__", ())]
        parts = [(name, getattr(value, name)) for name in names]
    else:
        return set()
    return {
        found
        for name, part in parts
        for found in writable(part, f"{path}.{name}", seen)
    }


class Around:
    """A behavior that hands all calls on to another one."""

    def __init__(self, behavior):
        self._behavior = behavior

    def __getattr__(self, name):
        return getattr(self._behavior, name)


def listening(behavior):
    """The entry of a shipped behavior that looks at all that it gets."""
    found, heard = set(), set()

    def look(name, *values):
        heard.add(name)
        found.update(writable(values, name))

    class Own(Around):
        def __init__(self, tools, config):
            look("tools", tools.robot, tools.balance)
            super().__init__(shipped_entry(behavior).make(tools, config))

        def enter(self, observation, body, request):
            look("enter", observation, body, request)
            return self._behavior.enter(observation, body, request)

        def update(self, state, observation, body, request, leaving):
            _ = observation.user_held, observation.terms.frame("l_hand")
            look("update", state, observation, body, request)
            outcome = self._behavior.update(state, observation, body, request, leaving)
            # Its targets are new in each tick; the weights are constants of all.
            command = outcome.command
            tasks = (command.posture, *command.tasks)
            look("command", [task.weight for task in tasks], command.contacts)
            return outcome

        def plan(self, state, com, omega):
            look("plan", state, com)
            return self._behavior.plan(state, com, omega)

    def condition(asked):
        look("condition", asked.observation, asked.command)
        return ""

    entry = replace(
        shipped_entry(behavior),
        name=f"MY_{behavior.name}",
        number=100,
        make=Own,
        follows=("STAND",),
        conditions=(condition,),
    )
    return entry, found, heard


@pytest.mark.parametrize("behavior", ["STAND", "WALK"])
def test_a_behavior_gets_read_only_arrays(behavior):
    entry, found, heard = listening(Behavior[behavior])
    sim = AtlasSimulation(behaviors=[entry])
    arms = AtlasCommand()
    arms.k_effort = [0] * 16 + [255] * 6 + [100] * 6
    sim.publish(arms)
    command = AtlasSimInterfaceCommand(behavior=entry.name)
    command.walk_params.use_demo_walk = True
    sim.publish(command)
    sim.advance(0.1)
    status = sim.output("controller_status")
    paths = sim.output("planned_paths")
    assert sim.current_behavior == entry.behavior
    assert heard == {"tools", "condition", "enter", "update", "command", "plan"}
    assert found == set()
    assert writable((status, paths), "status") == set()


class InPlace(Around):
    """Writes into the body reference that it is given."""

    def update(self, state, observation, body, request, leaving):
        body.joints[3] += 0.002
        return self._behavior.update(state, observation, body, request, leaving)


def test_a_behavior_that_writes_into_its_arguments_is_an_error():
    def make(tools, _config):
        return InPlace(tools.stand())

    entry = BehaviorEntry(name="MINE", number=100, make=make)
    sim = AtlasSimulation(behaviors=[entry])
    sim.publish(AtlasSimInterfaceCommand(behavior="MINE"))
    with pytest.raises(ValueError, match="read-only"):
        sim.advance(0.05)
