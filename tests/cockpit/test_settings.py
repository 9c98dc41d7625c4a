"""The settings of a scenario: listed, searched, changed, written."""

import io
from dataclasses import replace

import pytest
from pydrake.common.yaml import yaml_load

from atlas_drake import ScenarioError
from atlas_drake.app.progress import Progress
from atlas_drake.app.teleop import followed
from atlas_drake.cockpit.next_run import NextRun
from atlas_drake.cockpit.operator import Operator
from atlas_drake.cockpit.setting_list import list_settings, settings_card
from atlas_drake.cockpit.settings import matching, text_of
from atlas_drake.scenario import Scenario, scenario_from, with_settings
from atlas_drake.scenario.differences import scenario_yaml
from atlas_drake.scenario.world import WorldError

GAIN = "controller.gains.dcm_gain"


@pytest.fixture(scope="module")
def settings():
    return {one.path: one for one in list_settings(Scenario().resolved())}


def test_a_setting_has_unit_bounds_and_usual_value(settings):
    step = settings["physics_step"]
    assert (step.value, step.usual, step.unit) == (0.0015, 0.0015, "s")
    assert (step.kind, step.bounds, step.needs) == ("number", "> 0", "a restart")
    assert settings["jitter.mass"].bounds == "≥ 0, < 1"
    assert settings["jitter.mass"].needs == "a new run"
    assert settings["state"].choices == ("true", "estimated")
    assert settings["start.on_gantry"].kind == "flag"
    assert settings["controller.walk.limits.duration"].kind == "yaml"


def test_settings_of_the_package_say_what_they_are(settings):
    silent = [path for path, one in settings.items() if not one.text]
    assert all(path.startswith(("plant.", "simulator.")) for path in silent)


def test_every_value_is_read_back_from_its_text(settings):
    usual = Scenario().resolved()
    texts = [f"{path}={text_of(one.value)}" for path, one in settings.items()]
    assert with_settings(Scenario(), texts).resolved() == usual


def test_search_takes_words_and_changes():
    scenario = with_settings(Scenario(), [f"{GAIN}=2.5"]).resolved()
    every = settings_card(scenario, "").settings
    assert GAIN in [one.path for one in matching(every, "gains DCM", {}, False)]
    assert [one.path for one in matching(every, "", {}, True)] == [GAIN]
    waiting = matching(every, "", {"seed": "3"}, True)
    assert [one.path for one in waiting] == [GAIN, "seed"]


def test_yaml_has_what_differs_and_makes_the_same_scenario():
    asked = with_settings(
        Scenario(model="atlas_v3", world="stairs"),
        [f"{GAIN}=2.5", "physics_step=0.001", "noise=rough", "world.stairs.rise=0.05"],
    ).resolved()
    text = scenario_yaml(asked)
    fields = yaml_load(data=text)
    assert fields["controller"] == {"gains": {"dcm_gain": 2.5}}
    assert "gantry" not in fields
    assert scenario_from(fields).resolved() == asked
    named = yaml_load(data=scenario_yaml(replace(Scenario(), world="ramp").resolved()))
    assert named["world"] == "ramp"


@pytest.fixture
def teleop(shared_sim):
    shared_sim.reset(seed=0)
    return Operator(shared_sim, next_run=NextRun(why_not=""))


def test_a_value_that_is_refused_says_why(teleop):
    with pytest.raises(ScenarioError, match="physics_step"):
        teleop.scenario.check({"physics_step": "1.0"})
    with pytest.raises(ScenarioError, match=GAIN):
        teleop.scenario.check({GAIN: "much"})
    assert teleop.scenario.check({GAIN: "2.5"})


def test_a_scenario_with_errors_is_not_started(teleop):
    for text in ("", "a: b: c", "controler: {}", "model: nobody", "[1, 2]"):
        with pytest.raises(ScenarioError):
            teleop.scenario.start(text=text)
    assert teleop.next_run.scenario is None


def test_another_controller_waits_for_the_program(teleop):
    teleop.scenario.start({GAIN: "2.5", "model": "atlas_v3"})
    asked = teleop.next_run.take()
    assert asked.model == "atlas_v3"
    assert asked.controller_config().gains.dcm_gain == 2.5


def test_another_seed_begins_at_once(teleop, shared_sim):
    shared_sim.advance(0.02)
    teleop.scenario.start({"seed": "3", "jitter.position": "0.01"})
    assert teleop.next_run.scenario is None
    assert (shared_sim.time, shared_sim.scenario.seed) == (0.0, 3)
    shared_sim.restart(Scenario())


def test_a_program_of_one_simulation_says_so(shared_sim):
    operator = Operator(shared_sim)
    with pytest.raises(ScenarioError, match="teleop"):
        operator.scenario.start({GAIN: "2.5"})


def test_a_simulation_that_cannot_be_built_leaves_the_present_one():
    said = []

    class Page:
        def say(self, text, lasting=False):
            said.append(text)

    def build(scenario, cockpit):
        raise WorldError("it is full")

    asked = Scenario(name="crowd")
    assert followed("now", asked, build, Page(), Progress(io.StringIO(), 1.0)) == "now"
    assert said[-1] == "crowd cannot be simulated: it is full"
