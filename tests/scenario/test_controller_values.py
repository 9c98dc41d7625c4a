"""Values of the controller: defaults, then the robot's file, then the scenario."""

from dataclasses import replace

import pytest
from pydrake.common.yaml import yaml_dump

from atlas_drake import ScenarioError
from atlas_drake.config import as_plain, read_yaml
from atlas_drake.robot import MODELS_FOLDER, available_robots
from atlas_drake.scenario import Scenario, scenario_from, with_settings
from atlas_drake.systems.sensor_noise import NOISE_MODELS, NoiseModel

SHORT = {"walk": {"limits": {"forward": 0.3}, "swing": {"height": 0.07}}}


@pytest.fixture
def robot_with(tmp_path):
    """Returns the file of Atlas with values of its own for the controller."""

    def write(controller):
        fields = read_yaml((MODELS_FOLDER / "atlas.yaml").read_text())
        path = tmp_path / "short.yaml"
        path.write_text(yaml_dump({**fields, "controller": controller}))
        return str(path)

    return write


def test_values_of_a_robots_file_replace_defaults(robot_with):
    limits = {"forward": 0.3, "duration": 0.5}
    model = robot_with(
        {"walk": {"limits": limits}, "step": {"limits": {"forward": 0.3}}}
    )
    config = Scenario(model=model).controller_config()
    assert config.walk.limits.forward == config.step.limits.forward == 0.3
    assert config.walk.limits.duration == (0.5, 3.0)
    # STEP has limits of its own.
    assert (config.walk.limits.backward, config.step.limits.backward) == (0.32, 0.36)


def test_values_of_a_scenario_replace_those_of_the_robots_file(robot_with):
    given = {"controller": {"walk": {"limits": {"forward": 0.42}}}}
    scenario = scenario_from({"model": robot_with(SHORT), **given})
    assert scenario.controller_config().walk.limits.forward == 0.42
    assert scenario.controller_config().walk.swing.height == 0.07
    changed = with_settings(
        scenario,
        [
            "controller.walk.swing.height=0.12",
            "controller.walk.limits.duration=[0.5, 2]",
            "controller.walk.limits.width[1]=0.4",
        ],
    )
    config = changed.resolved().controller
    assert config.walk.swing.height == 0.12
    assert config.walk.limits.duration == (0.5, 2.0)
    assert config.walk.limits.width == (0.18, 0.4)
    assert config.walk.limits.forward == 0.42
    # A log has every value, and does not depend on the robot's file.
    written = scenario_from(as_plain(changed.resolved()))
    assert written.resolved() == changed.resolved()


def test_another_robot_brings_its_own_values(robot_with):
    scenario = scenario_from({"controller": {"walk": {"swing": {"height": 0.2}}}})
    changed = with_settings(scenario, [f"model={robot_with(SHORT)}"])
    assert changed.controller_config().walk.limits.forward == 0.3
    assert changed.controller_config().walk.swing.height == 0.2


@pytest.mark.parametrize("robot", available_robots())
def test_shipped_robots_have_usable_values(robot):
    config = Scenario(model=robot).controller_config()
    assert config.gait() == config.gait().nearest()


def test_a_robots_value_that_cannot_be_used_is_named(robot_with):
    model = robot_with({"walk": {"limits": {"forwards": 0.3}}})
    with pytest.raises(ScenarioError) as raised:
        Scenario(model=model).validate()
    assert raised.value.field == "controller.walk.limits.forwards"
    assert model in raised.value.problem


@pytest.mark.parametrize(
    ("controller", "field"),
    [
        ("{walk: {limits: {width: [0.6, 0.5]}}}", "walk.limits.width"),
        ("{walk: {limits: {width: 0.5}}}", "walk.limits.width"),
        ("{walk: {limits: {duration: 1.5}}}", "walk.limits.far_duration"),
        ("{walk: {limits: {duration: [0, 1]}}}", "walk.limits.duration"),
        ("{walk: {limits: {far: 0.1}}}", "walk.limits.far"),
        ("{walk: {steps: {stride: 0.7}}}", "walk.steps.stride"),
        ("{walk: {swing: {height: 0.5}}}", "walk.swing.height"),
        ("{stance: {width: 0.7}}", "stance.width"),
        ("{manipulate: {range: {yaw: [1, -1]}}}", "manipulate.range.yaw"),
    ],
)
def test_values_that_contradict_each_other_are_refused(controller, field):
    with pytest.raises(ScenarioError) as raised:
        with_settings(Scenario(), [f"controller={controller}"])
    assert raised.value.field == f"controller.{field}"


def test_noise_of_a_name_can_be_changed_in_part():
    scenario = with_settings(Scenario(noise="rough"), ["noise.gyro=0.1"])
    assert scenario.noise == replace(NOISE_MODELS["rough"], gyro=0.1)
    assert scenario_from({"noise": "none"}, scenario).noise == NoiseModel()
