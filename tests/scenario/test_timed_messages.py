"""Messages in a scenario: made from their fields, sent at their time, faults named."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray

from atlas_drake import AtlasSimulation, Behavior, Scenario, ScenarioError
from atlas_drake.messages.behavior_catalog import (
    SHIPPED,
    BehaviorCatalog,
    BehaviorInterface,
)
from atlas_drake.messages.checks import check_number
from atlas_drake.robot import load_robot
from atlas_drake.scenario import scenario_from
from atlas_drake.scenario.timed_message import TimedMessage

SIM = ".atlas_sim_interface_command"


def sim_message(**fields):
    return {"time": 0.1, "atlas_sim_interface_command": fields}


def test_messages_are_sent_at_their_time():
    fields = {
        "messages": [
            # In any order: their times count.
            {"time": 0.2, "atlas_command": {"k_effort": 255}},
            sim_message(behavior="MANIPULATE") | {"text": "servo"},
        ]
    }
    sim = AtlasSimulation(scenario_from(fields, Scenario()))
    sim.advance(0.15)
    assert sim.current_behavior is Behavior.MANIPULATE
    assert set(sim.atlas_state.k_effort) == {0}
    sim.advance(0.1)
    assert set(sim.atlas_state.k_effort) == {255}
    told = [event.text for event in sim.events if event.kind == "command"]
    assert told == ["servo", "[joint command]"]


def test_steps_are_made_from_their_fields():
    pose = {"position": {"x": 0.25, "y": 0.12}}
    step = {"step_index": 1, "foot_index": 0, "duration": 0.63, "pose": pose}
    entry = TimedMessage(
        atlas_sim_interface_command={
            "behavior": "WALK",
            "walk_params": {"step_queue": [step]},
        }
    )
    message = entry.message(load_robot(), "messages[0]")
    queue = message.walk_params.step_queue
    assert [data.step_index for data in queue] == [1, -1, -1, -1]
    assert queue[0].pose.position.x == 0.25
    assert queue[0].pose.orientation.w == 1.0


@dataclass
class BowParams:
    depth: float = 0.4
    sides: tuple[float, ...] = ()
    manner: Literal["deep", "curt"] = "deep"
    goal: NDArray[np.float64] | None = None


def check_bow(params, field):
    check_number(params.depth, f"{field}.depth", 0.0, 0.6)


BOW = BehaviorInterface(name="BOW", number=100, params=BowParams, check=check_bow)
CATALOG = BehaviorCatalog((*SHIPPED, BOW))


def bow(behavior="BOW", **params):
    fields = {"behavior": behavior, "params": params}
    entry = TimedMessage(atlas_sim_interface_command=fields)
    return entry.message(load_robot(), "messages[0]", CATALOG)


def test_parameters_of_a_users_behavior_are_made_from_their_fields():
    assert bow(depth=0.3).params == BowParams(depth=0.3)
    assert bow(depth=0.1, sides=[0, 1]).params == BowParams(0.1, (0.0, 1.0))
    assert bow(manner="curt", behavior=100).params == BowParams(manner="curt")


@pytest.mark.parametrize(
    ("fields", "field", "told"),
    [
        ({"dept": 0.3}, ".dept", "Did you mean 'depth'"),
        ({"depth": "deep"}, ".depth", "is 'deep'; must be a valid number"),
        ({"depth": 0.7}, ".depth", "0.7"),
        ({"manner": "long"}, ".manner", "is 'long'; must be"),
        ({"goal": [1.0]}, ".goal", r"is \[1.0\]; must be"),
        ({"behavior": "STAND", "depth": 1.0}, "", "for the user's own behaviors"),
        ({"behavior": "BOWL"}, None, "Did you mean 'BOW'"),
    ],
)
def test_parameters_that_cannot_be_used_are_named(fields, field, told):
    with pytest.raises(ScenarioError, match=told) as error:
        bow(**fields)
    path = "messages[0].atlas_sim_interface_command."
    assert error.value.field == path + (
        "behavior" if field is None else f"params{field}"
    )


@pytest.mark.parametrize(
    ("message", "field", "told"),
    [
        ({"atlas_command": {"k_effort": 255}, "time": -1.0}, ".time", "is -1.0"),
        ({"time": 1.0}, "", "exactly one"),
        (
            sim_message(behavior=3) | {"atlas_command": {"k_effort": 1}},
            "",
            "exactly one",
        ),
        (sim_message(behaviour=3), ".atlas_sim_interface_command.behaviour", "no such"),
        (
            sim_message(walk_params={"step_queue": [{"foot_indx": 0}]}),
            ".atlas_sim_interface_command.walk_params.step_queue[0].foot_indx",
            "'foot_index'",
        ),
        (sim_message(walk_params=3), f"{SIM}.walk_params", "is 3; must be fields of"),
        (sim_message(behavior="RUN"), f"{SIM}.behavior", "'RUN'"),
        ({"atlas_command": {"position": [0.0]}}, ".atlas_command.position", "28"),
        ({"atlas_command": {"k_effort": 300}}, ".atlas_command.k_effort[0]", "300"),
        ({"atlas_command": 3}, ".atlas_command", "is 3; must be a valid dictionary"),
    ],
)
def test_a_message_that_cannot_be_sent_is_named_before_the_run(message, field, told):
    with pytest.raises(ScenarioError, match=told) as error:
        AtlasSimulation(scenario_from({"messages": [message]}))
    assert error.value.field == f"messages[0]{field}"
