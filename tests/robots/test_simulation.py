"""A robot that is not Atlas, simulated, recorded, replayed and steered."""

import json

import numpy as np
import pytest

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
    load_scenario,
    steps_ahead,
)
from atlas_drake.clients.cli.main import main
from atlas_drake.clients.cockpit.describe import describe_run
from atlas_drake.clients.film.replay import make_replay
from atlas_drake.clients.logs import LogError, read_log
from atlas_drake.clients.steering.pilot import pilot_of
from atlas_drake.errors import ScenarioError
from atlas_drake.messages import BehaviorStatus
from atlas_drake.robot import load_robot
from atlas_drake.simulation.tutorial import tutorial_schedule

from .conftest import HERON

SHORT = "duration: 0.1\nphysics_step: 0.002\ncontrol_period: 0.004\n"


def simulate(model=HERON):
    return AtlasSimulation(Scenario(model=str(model)))


def test_a_scenario_names_its_robot_beside_itself(copied, tmp_path, monkeypatch):
    path = copied()
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(SHORT + "model: heron/heron.yaml\n")
    # Wherever the program is run.
    assert load_scenario(scenario).model == str(path)
    # In Python the working folder counts.
    monkeypatch.chdir(path.parent)
    sim = simulate(model="heron.yaml")
    assert sim.robot.name == "heron"
    assert sim.scenario.model == str(path)
    assert sim.summary()["model"] == str(path)
    path.rename(path.parent / "gone.yaml")
    with pytest.raises(ScenarioError, match=r"model: there is no file .*heron.yaml"):
        load_scenario(scenario)
    with pytest.raises(ScenarioError, match="model: there is no file"):
        Scenario(model="heron.yaml").validate()


def test_the_command_line_takes_a_path(copied, tmp_path, monkeypatch, capsys):
    path = copied()
    scenario, summary = tmp_path / "scenario.yaml", tmp_path / "summary.json"
    scenario.write_text(SHORT)
    monkeypatch.chdir(tmp_path)
    options = ["--model", "heron/heron.yaml", "--headless", "--json", str(summary)]
    assert main(["run", str(scenario), *options]) == 0
    assert json.loads(summary.read_text())["model"] == str(path)
    (path.parent / "heron.urdf").unlink()
    assert main(["run", str(scenario), *options]) == 2
    error = capsys.readouterr().err
    assert "urdf: there is no file" in error
    assert str(path) in error


def test_the_tutorial_is_for_robots_with_two_arms(copied, tmp_path):
    kept = tmp_path / "kept.mcap"
    kept.write_text("an earlier run")
    path = copied()
    path.write_text(path.read_text().replace("limb: r_arm", "limb: neck"))
    scenario = Scenario(model=str(path), schedule="tutorial")
    with pytest.raises(ScenarioError, match="no joint of limb r_arm; choose sched"):
        AtlasSimulation(scenario, log=kept)
    assert kept.read_text() == "an earlier run"


def test_the_tutorial_moves_the_shoulders_of_any_robot(heron):
    arms = tutorial_schedule(heron)[3].command
    moved = [heron.joint_index(f"{side}_shoulder") for side in ("left", "right")]
    assert np.flatnonzero(arms.k_effort).tolist() == moved


def test_a_log_knows_where_its_robot_is(copied, tmp_path):
    path = copied()
    file = tmp_path / "run.mcap"
    scenario = Scenario(model=str(path))
    with AtlasSimulation(scenario, log=file) as sim:
        sim.advance(0.05)
    log = read_log(file)
    assert log.header.model == log.scenario.model == str(path)
    assert log["joints.effort"].shape[1] == log.robot.num_joints == 15
    # It has no hands, so nothing is measured at them.
    assert not log["hands.left_force"].any()
    make_replay(log)

    path.write_text(path.read_text().replace("name: waist_yaw", "name: waist"))
    urdf = path.parent / "heron.urdf"
    urdf.write_text(urdf.read_text().replace('"waist_yaw"', '"waist"'))
    with pytest.raises(LogError, match=r"heron.yaml, has other joints than when"):
        make_replay(read_log(file))
    path.unlink()
    with pytest.raises(LogError, match=r"robot cannot be loaded: .*no file .*heron.y"):
        make_replay(read_log(file))


def test_the_cockpit_fits_the_robot(heron):
    sim = simulate()
    described = describe_run(sim)
    assert described["gait"]["stride"]["usual"] == 0.14
    height = described["pelvis"]["pelvis_height"]
    above = np.array([height["low"], height["high"]]) - height["usual"]
    size = heron.com_height / load_robot().com_height
    np.testing.assert_allclose(above, np.array([-0.36, 0.04]) * size, rtol=1e-4)
    assert described["pushed"][:2] == ["trunk", "hips"]
    assert {one["name"] for one in described["joints"]} == set(heron.joint_names)
    for one in (*described["gait"].values(), height):
        assert one["low"] <= one["usual"] <= one["high"]


def test_steering_commands_the_robot(heron):
    sim = simulate()
    pilot = pilot_of(sim)
    pilot.walk(forward=1.0)
    sim.advance(0.06)
    assert sim.current_behavior is Behavior.WALK
    pilot.behave("USER")
    sim.advance(0.06)
    assert sim.current_behavior is Behavior.USER
    assert set(sim.atlas_sim_interface_state.k_effort) == {255}


@pytest.mark.slow
def test_heron_stands_walks_and_squats(walk):
    sim = simulate()
    sim.advance(1.0)
    stood = sim.atlas_sim_interface_state.pos_est.position
    assert stood.z == pytest.approx(0.66, abs=0.01)
    gait = sim.scenario.controller_config().gait()
    footsteps = walk(sim, steps_ahead(sim.atlas_sim_interface_state, 0.42, gait))
    assert len(footsteps) == 4
    assert max(step["error_m"] for step in footsteps) < 0.005
    walked = sim.atlas_sim_interface_state.pos_est.position
    assert walked.x - stood.x == pytest.approx(0.42, abs=0.02)

    squat = AtlasSimInterfaceCommand(behavior="MANIPULATE")
    squat.manipulate_params.use_desired = True
    squat.manipulate_params.desired.pelvis_height = 0.3
    sim.publish(squat)
    sim.advance(3.0)
    # As low as its size allows.
    allowed = sim.scenario.controller_config().manipulate.range
    lowest = sim.robot.pelvis_height + allowed.height.least
    assert sim.pelvis_pose.translation()[2] == pytest.approx(lowest, abs=0.01)
    summary = sim.summary()
    assert summary["success"]
    status = sim.atlas_sim_interface_state.behavior_feedback.status_flags
    assert not status & BehaviorStatus.ERROR_FALLING
    # Torques far from their limits: nothing was thrown.
    assert max(summary["peak_effort_fraction"].values()) < 0.7
    assert np.isfinite(sim.atlas_state.effort).all()
