"""Models beside the robot in a scenario: read, placed, and refused by field."""

import logging
import re
from pathlib import Path

import numpy as np
import pytest
from pydrake.common.schema import Transform
from pydrake.common.yaml import yaml_dump, yaml_load
from pydrake.math import RigidTransform

from atlas_drake import (
    AtlasSimulation,
    Model,
    Scenario,
    ScenarioError,
    Start,
    load_scenario,
)
from atlas_drake.config import as_plain
from atlas_drake.scenario import scenario_from
from atlas_drake.worlds.world import WorldError

EXAMPLES = Path(__file__).parents[2] / "examples/scenarios"
BALL = str(EXAMPLES / "world/ball.sdf")
DIRECTIVES = """
directives:
- add_model: {{name: left, file: "file://{ball}"}}
- add_model: {{name: right, file: "file://{ball}"}}
- add_weld: {{parent: world, child: right::ball}}
"""


@pytest.mark.slow
def test_the_example_has_a_ball_and_a_ramp():
    scenario = load_scenario(EXAMPLES / "ball.yaml")
    assert [Path(model.file).is_file() for model in scenario.models] == [True, True]
    again = scenario_from(yaml_load(data=yaml_dump(as_plain(scenario))))
    assert again == scenario
    sim = AtlasSimulation(scenario)
    ball = sim.output("ball.state")
    np.testing.assert_array_equal(ball[4:7], [2.5, 0.0, 1.2])
    np.testing.assert_array_equal(ball[7:], [0, 0, 0, -5.0, 0.0, 2.5])
    ramp = sim.plant.GetBodyByName("board")
    X_WB = sim.plant.EvalBodyPoseInWorld(
        sim.plant.GetMyContextFromRoot(sim.context), ramp
    )
    assert X_WB.rotation().ToRollPitchYaw().pitch_angle() == pytest.approx(
        -0.1396, 1e-3
    )
    sim.advance(0.1)
    assert sim.output("ball.state")[4] == pytest.approx(2.0, abs=0.02)
    sim.reset()
    np.testing.assert_array_equal(sim.output("ball.state"), ball)
    sim.advance(0.1)
    sim.reset(seed=3)
    np.testing.assert_array_equal(sim.output("ball.state"), ball)


DOOR = (
    '<mujoco model="door"><worldbody><body name="door"><joint name="hinge" '
    'type="hinge" range="1 -1" limited="true"/><geom type="box" size="1 1 1" '
    'mass="1"/></body></worldbody></mujoco>'
)
MASSLESS = re.sub("<mass>.*?</mass>", "<mass>MASS</mass>", Path(BALL).read_text())


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("ball.sdf", MASSLESS.replace("MASS", "0"), "ball"),
        ("ball.sdf", MASSLESS.replace("MASS", "-1"), "ball"),
        # Limits in the wrong order.
        ("door.xml", DOOR, "limits"),
    ],
)
def test_a_model_that_drake_would_change_or_abort_at_is_refused(
    tmp_path, name, text, words
):
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(ScenarioError) as error:
        Scenario(models=[Model(file=str(file))]).validate()
    assert error.value.field == "models[0].file"
    assert words in error.value.problem
    assert "\n" not in error.value.problem


def test_a_fault_counts_though_its_log_is_silent(tmp_path, monkeypatch):
    """As after ``logging.config.dictConfig``, which disables loggers."""
    monkeypatch.setattr(logging.getLogger("drake"), "disabled", True)
    file = tmp_path / "ball.sdf"
    file.write_text(MASSLESS.replace("MASS", "0"))
    with pytest.raises(ScenarioError, match="ball"):
        Scenario(models=[Model(file=str(file))]).validate()
    assert logging.getLogger("drake").disabled


@pytest.mark.slow
def test_models_of_one_file_get_names_of_their_own(tmp_path):
    file = tmp_path / "two.dmd.yaml"
    file.write_text(DIRECTIVES.format(ball=BALL))
    models = [
        Model(file=BALL, X_WB=RigidTransform([0.0, 2.0, 1.0])),
        Model(file=BALL, X_WB=Transform(RigidTransform([0.0, 3.0, 1.0]))),
        Model(file=BALL, name="mine"),
        Model(file=str(file)),
    ]
    sim = AtlasSimulation(Scenario(models=models))
    for name, y in (("ball", 2.0), ("ball_2", 3.0), ("mine", 0.0), ("left", 0.0)):
        assert sim.output(f"{name}.state")[5] == y
    assert not sim.diagram.HasOutputPort("right.state")


@pytest.mark.parametrize(
    ("fields", "field", "problem"),
    [
        ({}, "file", "must be given"),
        ({"file": "nowhere.sdf"}, "file", "no such file"),
        ({"file": __file__}, "file", "cannot be read"),
        ({"file": BALL, "X_WB": {"translation": [1, 2]}}, "X_WB", "incompatible"),
        ({"file": BALL, "X_WB": {"translatio": [1, 2, 3]}}, "X_WB", "translatio"),
        ({"file": BALL, "X_WB": [1, 2, 3]}, "X_WB", "a pose"),
        ({"file": BALL, "X_WB": {"base_frame": "pelvis"}}, "X_WB", "one pose in W"),
        ({"file": BALL, "V_WB": [1, 2, 3]}, "V_WB", "at least 6"),
        ({"file": BALL, "V_WB": [0] * 6, "weld": True}, "V_WB", "welded"),
        ({"file": BALL, "weld": "yes"}, "weld", "boolean"),
        ({"file": BALL, "weld": True, "jitter": {"yaw": 1}}, "jitter", "welded"),
        ({"file": BALL, "jitter": {"mass": 1.0}}, "jitter.mass", "less than 1"),
        ({"file": BALL, "jitter": {"yaw": -1.0}}, "jitter.yaw", "greater than"),
        ({"file": BALL, "wled": True}, "wled", "Did you mean 'weld'?"),
    ],
)
def test_a_model_that_cannot_be_used_is_named(fields, field, problem):
    good = {"file": BALL}
    with pytest.raises(ScenarioError) as error:
        scenario_from({"models": [good, fields]})
    assert error.value.field == f"models[1].{field}"
    assert problem in error.value.problem


def test_a_file_of_several_models_may_not_be_welded(tmp_path):
    file = tmp_path / "two.dmd.yaml"
    file.write_text(DIRECTIVES.format(ball=BALL))
    with pytest.raises(ScenarioError, match="2 models"):
        Scenario(models=[Model(file=str(file), weld=True)]).validate()


@pytest.mark.slow
def test_a_crate_that_nobody_touches_stays_where_it_is():
    sim = AtlasSimulation(Scenario(world="tables"))
    sim.advance(0.3)
    before = sim.output("crate.state")
    sim.advance(2.0)
    np.testing.assert_allclose(sim.output("crate.state"), before, atol=1e-5)


@pytest.mark.slow
def test_every_seed_has_a_place_and_a_mass_of_its_own_within_the_jitter():
    ball = {"file": BALL, "X_WB": {"translation": [2.0, 1.0, 0.8]}}
    ball["jitter"] = {"position": 0.2, "yaw": 0.5, "mass": 0.3}
    sim = AtlasSimulation(scenario_from({"models": [ball, ball]}))
    body = sim.plant.GetBodyByName("ball", sim.plant.GetModelInstanceByName("ball"))
    usual = body.default_spatial_inertia()

    def drawn():
        inertia = body.CalcSpatialInertiaInBodyFrame(sim.part("plant")[1])
        assert inertia.get_unit_inertia().IsNearlyEqualTo(
            usual.get_unit_inertia(), 1e-12
        )
        return *sim.output("ball.state")[:7], inertia.get_mass() / usual.get_mass()

    first, other = drawn(), sim.output("ball_2.state")[:7]
    assert np.abs(first[4:6] - other[4:6]).max() > 1e-3
    sim.advance(0.1)
    sim.reset()
    assert drawn() == first
    seen = [first]
    for seed in range(1, 20):
        sim.reset(seed=seed)
        seen.append(drawn())
    again = AtlasSimulation(scenario_from({"models": [ball, ball], "seed": 19}))
    np.testing.assert_array_equal(again.output("ball.state"), sim.output("ball.state"))
    w, _, _, z, x, y, up, mass = np.transpose(seen)
    for values, middle, half in (
        (x, 2.0, 0.2),
        (y, 1.0, 0.2),
        (2.0 * np.arctan2(z, w), 0.0, 0.5),
        (mass, 1.0, 0.3),
    ):
        assert np.abs(values - middle).max() <= half + 1e-9
        assert np.ptp(values) > half
    np.testing.assert_array_equal(up, 0.8)


def test_a_robot_is_refused_where_this_seed_has_put_a_model():
    ball = {"file": BALL, "X_WB": {"translation": [0.0, 0.0, 1.0]}}
    ball["jitter"] = {"position": 3.0}
    sim = AtlasSimulation(scenario_from({"models": [ball], "seed": 1}))
    x, y = sim.output("ball.state")[4:6]
    with pytest.raises(WorldError, match="ball"):
        sim.reset(pose=Start(position=[x, y]))
    sim.reset(pose=Start(position=[x - 2.0, y]))
