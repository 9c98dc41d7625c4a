"""Messages in a scenario: made from their fields, sent at their time, faults named."""

import pytest

from atlas_drake import AtlasSimulation, Behavior, Scenario, ScenarioError
from atlas_drake.scenario import scenario_from
from atlas_drake.scenario.timed_message import TimedMessage


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
    message = entry.message(["joint"], "messages[0]")
    queue = message.walk_params.step_queue
    assert [data.step_index for data in queue] == [1, -1, -1, -1]
    assert queue[0].pose.position.x == 0.25
    assert queue[0].pose.orientation.w == 1.0


@pytest.mark.parametrize(
    ("message", "field", "told"),
    [
        ({"atlas_command": {"k_effort": 255}, "time": -1.0}, ".time", "is -1.0"),
        ({"time": 1.0}, "", "not neither"),
        (sim_message(behavior=3) | {"atlas_command": {"k_effort": 1}}, "", "not both"),
        (sim_message(behaviour=3), ".atlas_sim_interface_command.behaviour", "no such"),
        (
            sim_message(walk_params={"step_queue": [{"foot_indx": 0}]}),
            ".atlas_sim_interface_command.walk_params.step_queue[0].foot_indx",
            "'foot_index'",
        ),
        (
            sim_message(walk_params=3),
            ".atlas_sim_interface_command.walk_params",
            "is 3; must be fields of",
        ),
        (
            sim_message(behavior="RUN"),
            ".atlas_sim_interface_command.behavior",
            "'RUN'",
        ),
        (
            {"atlas_command": {"position": [0.0, 1.0]}},
            ".atlas_command.position",
            "28",
        ),
        ({"atlas_command": {"k_effort": 300}}, ".atlas_command.k_effort[0]", "300"),
        ({"atlas_command": 3}, ".atlas_command", "is 3; must be a mapping"),
    ],
)
def test_a_message_that_cannot_be_sent_is_named_before_the_run(message, field, told):
    with pytest.raises(ScenarioError, match=told) as error:
        AtlasSimulation(scenario_from({"messages": [message]}))
    assert error.value.field == f"messages[0]{field}"
