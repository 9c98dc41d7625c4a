"""Scenarios: every field is checked, and every fault named."""

import dataclasses
import json
import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from pydrake.common.yaml import yaml_dump, yaml_load
from pydrake.multibody.plant import MultibodyPlantConfig
from pydrake.systems.analysis import SimulatorConfig

from atlas_drake import Block, Scenario, ScenarioError, Start, load_scenario
from atlas_drake.behaviors.config import ControllerConfig
from atlas_drake.behaviors.walk.config import WalkRules
from atlas_drake.campaigns import load_campaign
from atlas_drake.config import as_plain
from atlas_drake.control.gains import PdGains
from atlas_drake.control.pelvis.pelvis_reach import PelvisReserves
from atlas_drake.errors import RobotDescriptionError, shown
from atlas_drake.messages import Behavior
from atlas_drake.robot import load_robot
from atlas_drake.scenario import Jitter, scenario_from, with_settings
from atlas_drake.scenario.drake_configs import plant_config
from atlas_drake.scenario.time_grid import on_common_grid
from atlas_drake.scenario.world_file import load_world

RATES = "controller.manipulate.rates"
EXAMPLES = sorted((Path(__file__).parents[2] / "examples/scenarios").glob("*.yaml"))


def load(tmp_path, text):
    path = tmp_path / "scenario.yaml"
    path.write_text(text)
    return load_scenario(path)


def test_omitted_fields_have_their_defaults(tmp_path):
    scenario = load(tmp_path, "seed: 3\njitter: {mass: 0.05}\n")
    assert scenario.seed == 3
    assert scenario.jitter.mass == 0.05
    assert scenario.jitter.position == 0.0
    assert scenario.model == Scenario().model
    assert scenario.duration == Scenario().duration


@pytest.mark.parametrize("text", ["true", "True", '"true"', "'true'"])
def test_the_true_state_needs_no_quotes(text, tmp_path):
    assert load(tmp_path, f"state: {text}\n").state == "true"
    assert load(tmp_path, "state: estimated\n").state == "estimated"
    assert Scenario(state=True).validate().state == "true"


@pytest.mark.parametrize("text", ["false", "1", "[true]", "null"])
def test_other_values_of_state_are_refused(text, tmp_path):
    with pytest.raises(ScenarioError, match="state"):
        load(tmp_path, f"state: {text}\n")


@pytest.mark.parametrize(
    ("step", "period"),
    [
        *((0.002 / parts, 0.002) for parts in (1, 2, 3, 4, 7)),
        (0.003, 0.009),
        (1e-5, 7e-5),
        (0.02 / 7, 0.02),
    ],
)
def test_every_physics_step_that_divides_the_control_period_is_accepted(step, period):
    scenario = Scenario(physics_step=step, control_period=period).resolved()
    # Also a second time, as when a scenario was written to a file and is read again.
    scenario = dataclasses.replace(scenario).resolved()
    assert scenario.plant.time_step == scenario.physics_step
    assert scenario.physics_step == step
    station = scenario.on_time_grid()
    again = (station.physics_step, station.control_period)
    assert again == pytest.approx((step, period), rel=1e-9)
    assert station.plant.time_step == station.physics_step
    assert on_common_grid(*again) == again


@pytest.mark.parametrize("name", ["STAND", "stand", "Stand-Prep", "user", "FREEZE"])
def test_behaviors_are_named_in_any_case(name):
    behavior = Scenario(initial_behavior=name).validate().behavior()
    assert behavior.name == name.upper().replace("-", "_")
    assert isinstance(behavior, Behavior)


@pytest.mark.parametrize(
    ("field", "values"),
    [
        ("model", ["spot"]),
        ("name", [3]),
        ("schedule", ["dance"]),
        ("noise", ["deafening"]),
        ("state", ["guessed", False]),
        ("physics_step", [-0.001, 0.0, 1e-6, 0.004, math.nan, 10**400]),
        ("control_period", [-0.006, 0.0016, 0.1, 1e308, math.inf]),
        ("initial_behavior", ["SITT", "WALK"]),
        ("duration", [0.0, math.inf, "5", 1e308, 10**400, np.timedelta64(1, "s")]),
        ("ground_friction", [-0.1, math.nan, 1e308, Fraction(10**400, 3)]),
        ("seed", [-1, 1.5, True, 2**64, 10**400, 10**5000]),
        ("friction_jitter", [0.9, -0.1, math.nan, 10**400]),
        ("terrain", ["flat"]),
        ("start.tilt", [0.0]),
        ("start.yaws", [1.0]),
        ("start.yaw", [math.nan, 10**400]),
        ("start.position", [[0.0]]),
        ("start.position[0]", [[1e308, 0.0]]),
        ("start.release_time", [1e308]),
        ("jitter.position", [-0.1, math.nan, math.inf, 1e308, "much"]),
        ("jitter.orientation", [-0.1, math.nan, "much"]),
        ("jitter.joints", [-0.1, math.inf, "much"]),
        ("jitter.mass", [-0.1, math.nan, "much", 1.0]),
        ("plant.stiction_tolerance", ["1e-3"]),
        ("terrain[1].size", [[1.0, 1.0], [1.0, 0.0, 0.1]]),
        ("terrain[1].size[1]", [[1.0, 1e308, 0.1], [1.0, "1", 0.1]]),
        ("terrain[1].size[2]", [[1.0, 1.0, math.inf]]),
        ("terrain[1].position", [[0.0, 0.0]]),
        ("terrain[1].position[1]", [[0.0, math.nan, 0.0]]),
        ("terrain[1].position[2]", [[0, 0, 10**400]]),
        ("terrain[1].rpy", [[0.0]]),
        ("terrain[1].rpy[2]", [[0.0, 0.0, math.nan], [0, 0, 1e308]]),
        ("terrain[1].friction", [0.0, -0.5, math.nan, 1e308]),
    ],
)
def test_a_value_that_cannot_be_used_is_named_by_its_path(field, values):
    part, _, name = field.partition(".")
    name = name.partition("[")[0]
    for value in values:
        if part == "terrain[1]":
            scenario = Scenario(terrain=[Block(), Block(**{name: value})])
        else:
            scenario = Scenario(**{part: {name: value} if name else value})
        with pytest.raises(ScenarioError) as error:
            scenario.validate()
        assert error.value.field == field
        assert str(error.value).startswith(f"{field}: ")
        if not field.startswith("terrain["):
            assert error.value.value is (value[0] if field.endswith("]") else value)
        elif not field.endswith("]"):
            assert f"is {shown(value)}" in str(error.value)


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
        duration=Fraction(1, 2),
        seed=np.int64(3),
        ground_friction=np.float32(0.5),
        start=Start(position=np.array([1.0, 2.0]), yaw=np.float32(0.25)),
        terrain=(Block(size=(1, 1, Fraction(1, 10)), friction=np.float16(0.5)),),
    )
    plain = Scenario(
        duration=0.5,
        seed=3,
        ground_friction=0.5,
        start=Start(position=[1.0, 2.0], yaw=0.25),
        terrain=[Block(size=[1, 1, 0.1], friction=0.5)],
    )
    odd, plain = odd.validate(), plain.validate()
    assert odd == plain
    assert type(odd.start.yaw) is type(odd.ground_friction) is float
    assert json.loads(json.dumps(vars(odd.start))) == vars(plain.start)


@pytest.mark.parametrize(
    ("step", "period"),
    [(0.003, 0.009), (0.002, 0.008), (0.001, 0.009), (1e-5, 0.009), (0.0025, 0.01)],
)
def test_a_physics_step_alone_gets_the_nearest_control_period(step, period):
    scenario = Scenario(physics_step=step)
    assert scenario.resolved().control_period == period
    # The scenario itself still has none, whatever its step will be.
    assert scenario.control_period == 0.0


def test_a_step_of_less_precision_is_not_the_same():
    with pytest.raises(ScenarioError, match=r"physics_step \(0\.001000000047"):
        Scenario(physics_step=np.float32(0.001), control_period=0.002).validate()


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("durration: 3.0\n", "durration: .*Did you mean 'duration'"),
        ("jitter: {weight: 0.1}\n", r"jitter\.weight: .*position, orientation"),
        ("duration: soon\n", "duration: is 'soon'; must be a valid number"),
        ("duration: 5 s\n", "duration: is '5 s'; must be a valid number"),
        ("start: {yaw: ninety}\n", r"start\.yaw: is 'ninety'"),
        ("start: {harnessed: 1}\n", r"start\.harnessed: .*true or false"),
        ("jitter: 0.02\n", "jitter: is 0.02; must be fields of a Jitter"),
        ("terrain: [{sizes: [1, 1, 1]}]\n", r"terrain\[0\]\.sizes: .*'size'"),
        ("terrain: [{size: [1, 1, high]}]\n", r"terrain\[0\]\.size\[2\]: is 'high'"),
        ("", "file: must have fields of a scenario"),
        ("duration: 1e308\n", "duration: is 1e\\+308; must be within"),
        (f"ground_friction: 1{'0' * 400}\n", "ground_friction: .*within"),
        (f"seed: 1{'0' * 5000}\n", "file"),
        ("duration: [\n", "file"),
        ("- duration\n", "file"),
    ],
)
def test_a_file_that_is_no_scenario_is_refused(text, word, tmp_path):
    with pytest.raises(ScenarioError, match=word) as error:
        load(tmp_path, text)
    assert str(tmp_path) in str(error.value)


@pytest.mark.parametrize("load", [load_scenario, load_world, load_robot, load_campaign])
def test_a_file_with_an_alias_within_what_it_names_is_refused(load, tmp_path):
    path = tmp_path / "endless.yaml"
    path.write_text("name: &name one\nterrain: &all\n  - [*name]\n  - size: *all\n")
    with pytest.raises((ScenarioError, RobotDescriptionError)) as error:
        load(path)
    for told in (str(path), r"\*all", "line 4, column 11"):
        assert error.match(told)


@pytest.mark.parametrize("setting", ["terrain", "parameters.kind"])
def test_a_setting_with_an_alias_within_what_it_names_is_refused(setting, tmp_path):
    path = tmp_path / "campaign.yaml"
    path.write_text("duration: 1.0\n")
    with pytest.raises(ScenarioError, match=r"\*all stands within") as error:
        load_campaign(path, [f"{setting}=&all [*all]"])
    assert error.value.field == setting


@pytest.mark.parametrize("text", ["1.0e-2", "1e-2", "0.01"])
def test_a_number_may_be_written_in_any_way(text, tmp_path):
    assert load(tmp_path, f"jitter: {{joints: {text}}}\n").jitter.joints == 0.01


def test_a_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(ScenarioError, match="nowhere"):
        load_scenario(tmp_path / "nowhere.yaml")


def test_the_examples_load_under_their_own_name():
    assert {path.stem for path in EXAMPLES} >= {"tutorial", "rough"}
    for path in EXAMPLES:
        assert load_scenario(path).name == path.stem


def test_steps_and_period_are_rounded_so_that_ticks_meet_the_physics_step():
    step, period = on_common_grid(0.002 / 3, 0.002)
    ticks = np.arange(1, 1_000_000)
    assert not (3 * ticks * (0.002 / 3) == ticks * 0.002).all()
    assert (3 * ticks * step == ticks * period).all()
    assert on_common_grid(0.001, 0.002) == (0.001, 0.002)


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
    assert controller.walk.rules == WalkRules(dcm_ready=0.03)
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
    assert ControllerConfig() == Scenario(model="atlas_v3").controller_config()
    assert scenario != Scenario()
    assert scenario_from(yaml_load(data=yaml_dump(as_plain(scenario)))) == scenario


@pytest.mark.parametrize(
    ("setting", "field", "problem"),
    [
        ("controller.gains.dcm_gian=2", "controller.gains.dcm_gian", "'dcm_gain'"),
        ("controler.gains.dcm_gain=2", "controler", "'controller'"),
        ("controller.gains.dcm_gain=-1", "controller.gains.dcm_gain", "equal to 0"),
        ("controller.gains.dcm_gain=.nan", "controller.gains.dcm_gain", "finite"),
        ("controller.gains.dcm_gain=fast", "controller.gains.dcm_gain", "valid number"),
        ("controller.gains=2", "controller.gains", "fields of a ControlGains"),
        ("controller.fall.height=1.5", "controller.fall.height", "less than or equal"),
        ("controller.body.easing=0", "controller.body.easing", "greater than 0"),
        (
            "controller.freeze.contact_force=2",
            "controller.freeze.contact_force",
            "less",
        ),
        ("controller.manipulate.rates.turn.speed=9", f"{RATES}.turn", "does not stop"),
        ("plant.time_step=0.0005", "plant.time_step", "physics_step"),
        ("plant.contact_model=magnetic", "plant", "magnetic"),
        ("plant.discrete_contact_approximation=exact", "plant", "exact"),
        ("simulator.integration_scheme=guess", "simulator", "guess"),
        ("simulator.start_time=1", "simulator.start_time", "must be 0"),
        ("simulator.max_step_size=-1", "simulator", "maximum step size"),
        ("plant.stiction_tolerance=0", "plant", "stiction"),
        ("control_period=0.0007", "control_period", "whole multiple"),
        ("seed", "--set", "KEY.PATH=VALUE"),
        ("=3", "--set", "KEY.PATH=VALUE"),
        ("seed=[", "seed", "YAML"),
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
        Scenario(seed=1),
        ["seed=2", "jitter={mass: 0.1}", "jitter.joints=0.2", "seed=3", "name=a=b"],
    )
    assert scenario.seed == 3
    assert scenario.jitter == Jitter(mass=0.1, joints=0.2)
    assert scenario.name == "a=b"


def test_the_steps_of_a_valid_scenario_may_change():
    scenario = Scenario().validate()
    scenario = dataclasses.replace(scenario, physics_step=0.0005, control_period=0.001)
    assert scenario.validate().resolved().plant.time_step == 0.0005
    finer = with_settings(scenario, ["physics_step=0.00025"])
    assert finer.resolved().plant.time_step == 0.00025


def test_a_configuration_made_with_drakes_defaults_is_the_stations(tmp_path):
    sap = MultibodyPlantConfig(discrete_contact_approximation="sap")
    plant = Scenario(plant=sap, physics_step=0.0005).resolved().plant
    assert plant.time_step == pytest.approx(0.0005, rel=1e-9)
    assert not plant.use_sampled_output_ports
    assert plant.discrete_contact_approximation == "sap"
