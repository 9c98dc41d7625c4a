"""Benchmarks: they run, and their figures have the documented names.

The measured values are not tested here.
"""

import importlib
import importlib.util
import itertools
import json
import re
import shutil
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from atlas_drake import AtlasSimulation, Scenario
from atlas_drake.clients.campaigns import load_campaign
from atlas_drake.clients.campaigns.plan import make_trial
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.config import LeastGreatest
from atlas_drake.control.feet.footstep import limit_duration, saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.messages.event import FOOTSTEP, PUSH
from atlas_drake.messages.footstep import RIGHT, FootPose
from atlas_drake.rotations import rotation_z
from tests.policy_networks import METADATA, save

FOLDER = Path(__file__).parents[1] / "benchmarks"
HERON = Path(__file__).parent / "robots" / "heron"
SCRIPTS = sorted(
    path.stem for path in FOLDER.glob("*.py") if "def main" in path.read_text()
)
CAMPAIGNS = sorted(
    path.stem
    for path in (FOLDER / "campaigns").glob("*.yaml")
    if not path.stem.startswith("disturbed")
)


@pytest.fixture
def load(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module


def module_of(name):
    """A Python file of a campaign as a module."""
    path = FOLDER / "campaigns" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"campaign_{name}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # Dataclasses look themselves up there.
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_benchmark_explains_itself(load, name, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as end:
        load(name).main()
    assert end.value.code == 0
    assert "--json" in capsys.readouterr().out


def test_versions_go_with_the_figures(load, tmp_path):
    path = tmp_path / "figures.json"
    load("report").write_figures(path, {"speed": 1.0})
    written = json.loads(path.read_text())
    assert written["speed"] == 1.0
    assert written["versions"]["drake"] == version("drake")


@pytest.mark.slow
def test_speed_has_the_figures_promised(load, monkeypatch):
    realtime = load("realtime")
    monkeypatch.setattr(realtime, "DURATION", 0.1)
    monkeypatch.setattr(realtime, "PIECE", 0.1)
    monkeypatch.setattr(realtime, "RESETS", 1)
    result = realtime.measure("atlas")
    assert result["bare_upright"]
    assert all(result[key] > 0.0 for key in realtime.GOALS)
    assert set(result["tick_ms"]) == {"median", "p99", "max"}
    assert all(result["stages_ms"][name] > 0.0 for name in realtime.STAGES)
    for name in ("default", "mcap", "view"):
        spread = result["ratios"][name]
        assert 0.0 < spread["low"] <= spread["median"] == result[name] <= spread["high"]


@pytest.mark.slow
@pytest.mark.parametrize("name", CAMPAIGNS)
def test_a_campaign_can_be_run(name, tmp_path, monkeypatch):
    if name.startswith("robot"):
        # Herons stand in for the robots that an import writes into the working folder.
        for robot in module_of("robots").ROBOTS:
            folder = tmp_path / "build" / "robots" / robot
            shutil.copytree(HERON, folder)
            (folder / "heron.yaml").rename(folder / "robot.yaml")
        monkeypatch.chdir(tmp_path)
    TrialRunner(load_campaign(FOLDER / "campaigns" / f"{name}.yaml"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("part", "aside", "link"),
    [("feet", False, "(foot|talus)"), ("trunk", True, "(torso|head)")],
)
def test_a_steered_robot_is_punched_once_on_the_part_asked_for(part, aside, link):
    parameters = {"change": 0.3, "part": part, "aside": aside}
    with AtlasSimulation(Scenario()) as sim:
        headings = []
        sim.hooks.append(lambda sim: headings.append((sim.time, sim.pelvis_pose)))
        done = module_of("steering").punched(sim, parameters)
        (push,) = [event for event in sim.events if event.kind == PUSH]
        impulse = np.linalg.norm(push.data["force_W"]) * push.data["duration"]
        assert impulse == pytest.approx(0.3 * sim.robot.mass)
        assert re.search(link, push.data["body"])
        _, X_WP = min(headings, key=lambda at: abs(at[0] - push.time))
        ahead = np.array(push.data["force_W"]) @ X_WP.rotation().matrix()[:, [0, 2]]
        assert (np.abs(ahead).max() * push.data["duration"] < 0.1 * impulse) == aside
        steps = [event.time for event in sim.events if event.kind == FOOTSTEP]
        assert steps[0] < push.time < steps[-1] - 3.0
    assert done["stays_up"]


@pytest.mark.slow
def test_an_imported_robot_walks_at_a_froude_number():
    with AtlasSimulation(Scenario()) as sim:
        done = module_of("robots").speed(sim, {"froude": 0.06})
        height = sim.robot.com_height
    assert done["stands"]
    assert done["froude_number"] == pytest.approx(0.06, rel=0.15)
    assert done["speed"] ** 2 == pytest.approx(done["froude_number"] * 9.81 * height)


@pytest.mark.slow
def test_an_imported_robot_is_pushed():
    parameters = {"walks": True, "speed": 0.2, "direction": "left"}
    with AtlasSimulation(Scenario(model=str(HERON / "heron.yaml"))) as sim:
        done = module_of("robots").trial(sim, parameters)
        assert any(event.kind == "push" for event in sim.events)
    assert done == {"stands": True, "all_steps": True}
    assert len(sim.footsteps) >= 8


FEET = [
    FootPose(np.array([0.0, y, 0.0]), rotation_z(yaw))
    for y, yaw in ((0.12, 0.05), (-0.12, -0.05))
]


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32), forward=st.sampled_from([0.42, 0.7]))
def test_random_walks_are_within_the_limits_whatever_they_are(seed, forward):
    walks = module_of("random_walks")
    limits = StepLimits(forward=forward, duration=LeastGreatest(0.5, 2.0))
    steps, again = (
        walks.random_steps(FEET, limits, np.random.default_rng(seed), 25)
        for _ in range(2)
    )
    assert [step.duration for step in steps] == [step.duration for step in again]
    assert [step.index for step in steps] == list(range(1, 26))
    now, last = list(FEET), RIGHT
    for step in steps:
        assert step.index == 1 or step.foot != last
        start, stance = now[step.foot], now[1 - step.foot]
        legal = limit_duration(saturate(step, stance, limits), start, stance, limits)
        np.testing.assert_allclose(legal.p_WF, step.p_WF, atol=1e-12)
        assert legal.yaw == pytest.approx(step.yaw)
        assert legal.duration == pytest.approx(step.duration)
        assert step.duration <= walks.SLOWEST
        assert legal.swing_height == step.swing_height
        now[step.foot], last = step.pose, step.foot
    side_by_side = (rotation_z(now[0].yaw).T @ (now[0].p_WF - now[1].p_WF))[:2]
    np.testing.assert_allclose(side_by_side, [0.0, 0.24], atol=1e-9)


CAUGHT = {
    # The foot that landed steps again, outward.
    ("double", "inward"): 0.48,
    # A long step.
    ("double", "forward"): 0.87,
    # A low, fast swing, and a quick step of the other foot.
    ("early", "inward"): 0.66,
    ("late", "outward"): 0.61,
    # A swing that is not hastened: a fast one would turn the stance sole.
    ("mid", "outward"): 0.9,
}
"""Speeds of pushes on the walking robot by moment and direction [m/s]."""


@pytest.mark.slow
def test_a_walk_bears_a_push_in_any_phase_and_pushes_share_it():
    pushes, scenario = module_of("push_moments"), Scenario(noise="reference", seed=3)
    pushes.NUM_STEPS = 8  # Two after the last push.
    stances = itertools.cycle(("left", "right"))
    with AtlasSimulation(scenario) as sim:
        for ((moment, direction), speed), stance in zip(
            CAUGHT.items(), stances, strict=False
        ):
            push = {"moment": moment, "direction": direction, "speed": speed}
            push["stance"] = stance
            assert pushes.pushed_walk(sim, push)["stands"], push
        # The last of them, in a walk of its own.
        with AtlasSimulation(scenario) as alone:
            pushes.pushed_walk(alone, push)
            np.testing.assert_array_equal(alone.output("state"), sim.output("state"))


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_a_random_walk_is_walked_to_its_end():
    path = FOLDER / "campaigns" / "random_walks.yaml"
    campaign = load_campaign(path, ["parameters.num_steps=4"])
    record = TrialRunner(campaign)(make_trial(campaign, 1))
    assert record["error"] is None
    assert record["success"], record["missed"]
    assert record["figures"]["last_index"] == 4


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_a_displaced_start_is_judged():
    path = FOLDER / "campaigns" / "entry_joints.yaml"
    steps = ["physics_step=0.002", "control_period=0.004"]
    campaign = load_campaign(path, steps)
    trial_runner = TrialRunner(campaign)
    for level, survived in ((1, True), (4, False)):
        record = trial_runner(make_trial(campaign, 4 * level))
        assert record["error"] is None
        assert record["figures"]["survived"] is survived
        assert record["figures"]["let_in"] == 0


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_a_robot_that_is_handed_back_in_mid_stride_stands():
    path = FOLDER / "campaigns" / "handed_back.yaml"
    campaign = load_campaign(path, ["parameters.push=0.3"])
    record = TrialRunner(campaign)(make_trial(campaign, 1))
    assert record["error"] is None
    assert record["success"], record["missed"]
    assert record["figures"]["quiet"] < 5.0


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_a_policy_that_dies_is_noticed_and_stand_takes_over(tmp_path):
    file = save(tmp_path / "arm.onnx", [0.0, 0.0], metadata=METADATA)
    settings = [f"policy.file={file}", "policy.watchdog=true", "parameters.end=dies"]
    campaign = load_campaign(FOLDER / "campaigns" / "users.yaml", settings)
    record = TrialRunner(campaign)(make_trial(campaign, 1))
    assert record["error"] is None
    assert record["success"], record["missed"]
    assert record["figures"]["quiet"] < 1.0


@pytest.mark.slow
def test_a_policy_and_environments_have_the_figures_promised(load, monkeypatch):
    users = load("users")
    monkeypatch.setattr(users, "TICKS", 3)
    assert users.tick_ms() > 0.0
    steps, ratio = users.rate(users.walk(), 0.3)
    assert steps > 0.0
    assert ratio > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("behavior", ["MANIPULATE", "STEP"])
def test_a_push_comes_in_the_behavior_that_is_asked_for(behavior):
    parameters = {"behavior": behavior, "speed": 0.6, "direction": 0.0}
    with AtlasSimulation(Scenario(seed=3)) as sim:
        done = module_of("standing").pushed(sim, parameters)
        changes = [event.text for event in sim.events if event.kind == "behavior"]
    assert changes[:2] == [f"STAND -> {behavior}", f"{behavior} -> WALK (by itself)"]
    assert done["stands"]
