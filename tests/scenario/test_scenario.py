"""Scenarios: every field is checked, and every fault named."""

import dataclasses
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.common.yaml import yaml_dump
from pydrake.multibody.plant import MultibodyPlantConfig
from pydrake.systems.analysis import SimulatorConfig

from atlas_drake import Block, Scenario, ScenarioError, Start, load_scenario
from atlas_drake.config import as_plain, read_yaml
from atlas_drake.control.gains import PdGains
from atlas_drake.messages import Behavior
from atlas_drake.parts.manipulate.pelvis_reach import PelvisReserves
from atlas_drake.scenario import Jitter, scenario_from, with_settings
from atlas_drake.scenario.differences import scenario_yaml
from atlas_drake.scenario.physics import nominal_period, on_common_grid, plant_config
from atlas_drake.shipped import CONTROLLER

EXAMPLES = sorted((Path(__file__).parents[2] / "examples/scenarios").glob("*.yaml"))


def load(tmp_path, text):
    path = tmp_path / "scenario.yaml"
    path.write_text(text)
    return load_scenario(path)


def test_omitted_fields_have_their_defaults(tmp_path):
    scenario = load(tmp_path, "seed: 3\njitter: {mass: 0.05}\n")
    assert scenario == Scenario(seed=3, jitter=Jitter(mass=0.05)).validate()


@pytest.mark.parametrize("text", ["true", "True", '"true"'])
def test_the_true_state_needs_no_quotes(text, tmp_path):
    assert load(tmp_path, f"state: {text}\n").state == "true"
    assert load(tmp_path, "state: estimated\n").state == "estimated"
    assert Scenario(state=True).validate().state == "true"


@given(step=st.floats(1e-5, 0.01), ratio=st.integers(1, 2000))
def test_ticks_meet_the_physics_step(step, ratio):
    again = on_common_grid(step, ratio * step)
    assert again == pytest.approx((step, ratio * step), rel=1e-9)
    ticks = np.arange(1, 4096)
    assert (ratio * ticks * again[0] == ticks * again[1]).all()
    assert on_common_grid(*again) == again
    assert on_common_grid(0.001, 0.002) == (0.001, 0.002)


@pytest.mark.parametrize(
    ("step", "period"),
    [(0.002 / 3, 0.002), (0.003, 0.009), (1e-5, 7e-5), (0.02 / 7, 0.02)],
)
def test_every_physics_step_that_divides_the_control_period_is_accepted(step, period):
    scenario = Scenario(physics_step=step, control_period=period).resolved()
    # Also a second time, as when a scenario was written to a file and is read again.
    scenario = dataclasses.replace(scenario).resolved()
    assert scenario.plant.time_step == scenario.physics_step == step
    station = scenario.on_time_grid()
    assert station.plant.time_step == station.physics_step
    assert station.control_period == pytest.approx(period, rel=1e-9)


@pytest.mark.parametrize(
    ("step", "period"),
    [(0.003, 0.009), (0.002, 0.008), (0.001, 0.009), (1e-5, 0.009), (0.0025, 0.01)],
)
def test_a_physics_step_alone_gets_the_nearest_control_period(step, period):
    assert nominal_period(step) == period
    scenario = Scenario(physics_step=step)
    assert scenario.resolved().control_period == period
    # The scenario itself still has none, whatever its step will be.
    assert scenario.control_period == 0.0


@pytest.mark.parametrize("name", ["STAND", "stand", "Stand-Prep", "user", "FREEZE"])
def test_behaviors_are_named_in_any_case(name):
    behavior = Scenario(initial_behavior=name).validate().behavior()
    assert isinstance(behavior, Behavior)
    assert behavior.name == name.upper().replace("-", "_")


REFUSED = {
    "model": ["spot"],
    "name": [3],
    "schedule": ["dance"],
    "noise": ["deafening"],
    "state": ["guessed", False, 1, ["true"], None],
    "physics_step": [-0.001, 0.0, 1e-6, 0.011, math.nan, 10**400],
    "effort_delay": [-0.003, 0.001, 0.0045, math.inf],
    "noise.effort": [-0.01, math.nan],
    "control_period": [-0.006, 0.0016, 0.1, 1e308, math.inf],
    "initial_behavior": ["SITT", "WALK"],
    "duration": [0.0, math.inf, "5", 1e308, 10**400],
    "ground_friction": [-0.1, math.nan, 1e308],
    "seed": [-1, 1.5, True, 2**64, 10**5000],
    "friction_jitter": [0.9, -0.1],
    "terrain": ["flat"],
    "start.tilt": [0.0],
    "start.yaw": [math.nan, "ninety"],
    "start.position": [[0.0]],
    "start.position[0]": [[1e308, 0.0]],
    "start.release_time": [1.0],
    "jitter.position": [-0.1, math.inf, "much"],
    "jitter.orientation": [-0.1],
    "jitter.joints": [-0.1],
    "jitter.mass": [-0.1, 1.0],
    "plant": [{"contact_model": "magnetic"}, {"stiction_tolerance": 0.0}],
    "plant.stiction_tolerance": ["1e-3"],
    "plant.time_step": [0.0005],
    "simulator.max_step_size": [-1.0, math.nan],
    "simulator.integration_scheme": ["guess", "cenic"],
    "simulator.start_time": [1.0],
    "controller.fall.height": [1.5],
    "controller.body.easing": [0.0],
    "terrain[0].size": [[1.0, 1.0], [1.0, 0.0, 0.1]],
    "terrain[0].size[1]": [[1.0, math.inf, 0.1]],
    "terrain[0].friction": [0.0],
}


@pytest.mark.parametrize("path", REFUSED)
def test_a_value_that_cannot_be_used_is_named_by_its_path(path):
    # An element is refused within the list that is given.
    part, *inner = re.sub(r"\[\d\]$", "", path).split(".")
    for value in REFUSED[path]:
        for name in reversed(inner):
            value = {name: value}
        if part == "terrain[0]":
            scenario = Scenario(terrain=[value])
        else:
            scenario = Scenario(**{part: value})
        with pytest.raises(ScenarioError) as error:
            scenario.validate()
        assert error.value.field == path
        assert str(error.value).startswith(f"{path}: ")


def test_mappings_stand_for_drakes_configurations_and_for_ours():
    given = Scenario(
        plant={"discrete_contact_approximation": "sap"},
        simulator={"accuracy": 1e-3},
        start={"yaw": 1.0},
        terrain=[{"size": [1.0, 1.0, 0.2]}],
    )
    assert given.validate() == Scenario(
        # Of the other fields the scenario's defaults count, not Drake's.
        plant=plant_config(discrete_contact_approximation="sap"),
        simulator=SimulatorConfig(accuracy=1e-3),
        start=Start(yaw=1.0),
        terrain=[Block(size=[1.0, 1.0, 0.2])],
    )


def test_numbers_of_other_types_become_floats():
    odd = Scenario(
        duration=np.float64(0.5),
        seed=np.int64(3),
        start=Start(position=np.array([1.0, 2.0]), yaw=np.float32(0.25)),
        terrain=(Block(size=(1, 1, 0.1), friction=np.float16(0.5)),),
    )
    plain = Scenario(
        duration=0.5,
        seed=3,
        start=Start(position=[1.0, 2.0], yaw=0.25),
        terrain=[Block(size=[1, 1, 0.1], friction=0.5)],
    )
    odd, plain = odd.validate(), plain.validate()
    assert odd == plain
    assert json.loads(json.dumps(vars(odd.start))) == vars(plain.start)


def test_a_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(ScenarioError, match="nowhere"):
        load_scenario(tmp_path / "nowhere.yaml")


def test_the_examples_load_under_their_own_name():
    assert {path.stem for path in EXAMPLES} >= {"tutorial", "rough"}
    for path in EXAMPLES:
        assert load_scenario(path).name == path.stem


def test_every_number_of_the_controller_can_be_given(tmp_path):
    text = """
controller:
  gains: {dcm_gain: 2.5, com_height: {kp: 50}}
  walk: {rules: {dcm_ready: 0.03}, cop_inward: 0.02}
  step: {posture: {knee_efforts: [0.7, 0.8]}}
  manipulate: {rates: {turn: {speed: 0.3}}, reserves: {com_margin: 0.06}}
estimator: {slip: 2e-3}
plant: {stiction_tolerance: 1e-3, contact_model: point}
simulator: {accuracy: 1e-3}
"""
    scenario = load(tmp_path, text)
    controller = scenario.controller_config()
    assert controller.gains.dcm_gain == 2.5
    assert controller.gains.com_height == PdGains(kp=50.0, kd=12.0)
    assert controller.walk.rules.dcm_ready == 0.03
    assert controller.walk.cop_inward == 0.02
    assert controller.manipulate.reserves == PelvisReserves(com_margin=0.06)
    assert controller.step.posture.knee_efforts == (0.7, 0.8)
    assert controller.manipulate.rates.turn.speed == 0.3
    assert controller.manipulate.rates.turn.acceleration == 1.2
    assert scenario.estimator.slip == 2e-3
    assert scenario.plant.stiction_tolerance == 1e-3
    assert scenario.plant.discrete_contact_approximation == "similar"
    assert scenario.simulator.accuracy == 1e-3
    # A robot whose file gives no values of its own has the defaults.
    assert Scenario(model="atlas_v3").controller_config() == CONTROLLER
    assert scenario != Scenario()
    assert scenario_from(read_yaml(yaml_dump(as_plain(scenario)))) == scenario
    # A file with what differs from the defaults alone is the same scenario.
    brief = load(tmp_path, scenario_yaml(scenario.resolved()))
    assert brief.resolved() == scenario.resolved()


@pytest.mark.parametrize(
    ("setting", "field", "problem"),
    [
        ("controller.gains.dcm_gian=2", "controller.gains.dcm_gian", "'dcm_gain'"),
        ("controler.gains.dcm_gain=2", "controler", "'controller'"),
        ("controller.gains.dcm_gain=.nan", "controller.gains.dcm_gain", "finite"),
        ("controller.gains=2", "controller.gains", "ControlGains"),
        (
            "controller.manipulate.rates.turn.speed=9",
            "controller.manipulate.rates.turn",
            "does not stop",
        ),
        ("pushes[0].impulse=3", "pushes[0].impulse", "whole list"),
        ("control_period=0.0007", "control_period", "whole multiple"),
        ("seed", "--set", "KEY.PATH=VALUE"),
        ("=3", "--set", "KEY.PATH=VALUE"),
    ],
)
def test_a_setting_that_cannot_be_used_is_named(setting, field, problem):
    scenario = Scenario()
    with pytest.raises(ScenarioError) as error:
        with_settings(scenario, [setting])
    assert error.value.field == field
    assert problem in error.value.problem
    assert scenario == Scenario()


def test_settings_win_in_their_order():
    scenario = with_settings(
        Scenario(seed=1, terrain=[Block(), Block()]),
        [
            "seed=2",
            "jitter={mass: 0.1}",
            "jitter.joints=0.2",
            "seed=3",
            "name=a=b",
            "terrain[1].size[2]=0.3",
        ],
    )
    assert scenario.seed == 3
    assert scenario.jitter == Jitter(mass=0.1, joints=0.2)
    assert scenario.name == "a=b"
    assert scenario.terrain == [Block(), Block(size=[1.0, 1.0, 0.3])]


def test_the_steps_of_a_valid_scenario_may_change():
    scenario = Scenario().validate()
    scenario = dataclasses.replace(scenario, physics_step=0.0005, control_period=0.001)
    assert scenario.validate().resolved().plant.time_step == 0.0005
    finer = with_settings(scenario, ["physics_step=0.00025"])
    assert finer.resolved().plant.time_step == 0.00025


def test_a_configuration_made_with_drakes_defaults_is_the_stations():
    sap = MultibodyPlantConfig(discrete_contact_approximation="sap")
    plant = Scenario(plant=sap, physics_step=0.0005).resolved().plant
    assert plant.time_step == pytest.approx(0.0005, rel=1e-9)
    assert not plant.use_sampled_output_ports
    assert plant.discrete_contact_approximation == "sap"
