"""Benchmarks: they run, and their figures have the documented names.

The measured values are not tested here.
"""

import argparse
import importlib
import importlib.util
import json
import platform
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from atlas_drake.campaigns import load_campaign, processes
from atlas_drake.campaigns.plan import case_list, make_trial
from atlas_drake.campaigns.sources import Sources
from atlas_drake.campaigns.threshold import level_of
from atlas_drake.campaigns.trial_runner import TrialRunner
from atlas_drake.config import LeastGreatest
from atlas_drake.control.feet.footstep import limit_duration, saturate
from atlas_drake.control.feet.step_limits import StepLimits
from atlas_drake.messages.footstep import RIGHT, FootPose
from atlas_drake.rotations import rotation_z

FOLDER = Path(__file__).parents[1] / "benchmarks"
SCRIPTS = sorted(
    path.stem for path in FOLDER.glob("*.py") if "def main" in path.read_text()
)


@pytest.fixture
def load(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module


CAMPAIGNS = sorted(
    path.stem
    for path in (FOLDER / "campaigns").glob("*.yaml")
    if path.stem != "disturbed"
)


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_benchmark_explains_itself(load, name, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as end:
        load(name).main()
    assert end.value.code == 0
    assert "--json" in capsys.readouterr().out


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_benchmark_names_its_versions(load, name):
    script, report = load(name), load("report")
    assert script.command_line is report.command_line
    assert script.write_figures is report.write_figures


def test_versions_come_first_and_go_with_the_figures(
    load, monkeypatch, capsys, tmp_path
):
    report = load("report")
    path = tmp_path / "figures.json"
    monkeypatch.setattr(sys, "argv", ["any", "--json", str(path)])
    options = report.command_line(argparse.ArgumentParser())
    python = platform.python_version()
    said = f"Drake {version('drake')}, Python {python}\n"
    assert capsys.readouterr().out == said
    report.write_figures(options.json, {"speed": 1.0})
    assert json.loads(path.read_text()) == {
        "versions": {"drake": version("drake"), "python": python},
        "speed": 1.0,
    }
    report.write_figures(None, {"speed": 1.0})


@pytest.mark.slow
def test_speed_has_the_figures_promised(load, monkeypatch, capsys):
    realtime = load("realtime")
    monkeypatch.setattr(realtime, "DURATION", 0.1)
    monkeypatch.setattr(realtime, "PIECE", 0.1)
    monkeypatch.setattr(realtime, "RESETS", 1)
    result = realtime.measure("atlas")
    assert result["bare_upright"]
    assert all(result[key] > 0.0 for key in realtime.GOALS)
    assert result["reset_s"] < 1.0 < result["memory"] < 3.0
    assert set(result["tick_ms"]) == {"median", "p99", "max"}
    realtime.print_table(result)
    shown = capsys.readouterr().out
    assert all(label in shown for label, _ in realtime.GOALS.values())


@pytest.mark.slow
def test_contact_models_take_turns_in_speed(load, monkeypatch):
    models, disturbed = load("contact_models"), load("disturbed")
    monkeypatch.setattr(models, "PIECE", 0.1)
    physics = [disturbed.Physics(name, 0.002, 0.004) for name in ("lagged", "sap")]
    speeds = models.measure_speed("atlas", physics, seed=1, duration=0.2)
    assert set(speeds) == {"lagged", "sap"}
    lagged, sap = speeds["lagged"], speeds["sap"]
    assert lagged["speed closed quotient"] == lagged["speed bare quotient"] == 1.0
    for speed in (lagged, sap):
        assert 0.0 < speed["speed bare"] < speed["speed closed"]
        assert speed["speed factor"] == pytest.approx(0.002 / speed["speed closed"])


def test_contact_models_make_a_table(load):
    models = load("contact_models")
    figures = {
        "lagged": {"walk slip": [0.0012, 0.0034], "walk ok": [1.0, 0.0]},
        "sap": {"walk ok": [1.0, 1.0]},
    }
    assert models.table(figures) == [
        "| | lagged | sap |",
        "| --- | --- | --- |",
        "| sole's slip in single support, max [mm] | 3.40 | – |",
        "| walks that succeed [%] | 50 | 100 |",
    ]
    # Whatever a trial finds has a row.
    keys = {key for key, *_ in models.ROWS}
    trials = load("contact_trials")
    pushes = {f"push {p} {d}" for p in trials.INCREMENT for d in trials.DIRECTIONS}
    assert pushes <= keys
    assert {f"{part} ok" for part in trials.PARTS} <= keys


def test_contact_models_count_the_pushes_that_die(load, monkeypatch):
    models, trials = load("contact_models"), load("contact_trials")
    physics, Outcome = [load("disturbed").Physics()], processes.Outcome
    monkeypatch.setattr(trials, "_largest_push", lambda *_: 20.0)
    found = trials.run_trial(trials.Trial("push", physics[0], "atlas", 1))

    def runs(function, work, jobs):
        yield Outcome(work[0], found)
        yield Outcome(work[1], None, "process died (-9)")

    monkeypatch.setattr(models, "run_in_processes", runs)
    figures, complete = models.compare("atlas", physics, ["push"], range(2), 1)
    assert complete
    assert "| push searches that end [%] | 50 |" in models.table(figures)


def test_contact_models_that_are_interrupted_take_no_further_robot(
    load, monkeypatch, capsys
):
    models = load("contact_models")

    def runs(function, work, jobs):
        raise KeyboardInterrupt

    monkeypatch.setattr(models, "run_in_processes", runs)
    monkeypatch.setattr(sys, "argv", ["contact_models", "--seed", "1"])
    assert models.main() == 0
    assert capsys.readouterr().out.count("Interrupted") == 1


@pytest.mark.parametrize("borne_up_to", [0.0, 15.0, 25.0, 40.0])
def test_the_largest_push_is_found_from_either_side(load, monkeypatch, borne_up_to):
    trials, disturbed = load("contact_trials"), load("disturbed")
    monkeypatch.setattr(
        trials,
        "judged",
        lambda sim, name, push: {"success": push["impulse"] <= borne_up_to},
    )
    monkeypatch.setattr(trials, "_simulation", lambda trial: None)
    monkeypatch.setitem(trials.FIRST_IMPULSE, "walking", 25.0)
    monkeypatch.setitem(trials.INCREMENT, "walking", 5.0)
    trial = trials.Trial("push", disturbed.Physics(), "atlas", 1)
    assert trials._largest_push(trial, "walking", "left") == borne_up_to


def test_a_probe_reads_every_step_of_the_physics(load):
    trials, disturbed = load("contact_trials"), load("disturbed")
    physics = disturbed.Physics("sap", 0.002, 0.004)
    sim = trials._simulation(trials.Trial("stand", physics, "atlas", 1))
    sim.advance(0.3)
    probe = load("contact_probe").ContactProbe(sim)
    before = probe.sole_places()
    sim.advance(0.1)
    # Eight corners, however the advance is cut into pieces.
    assert len(probe.normal) == 8 * 50
    weight = sum(probe.normal) / 50
    assert weight == pytest.approx(sim.robot.mass * 9.81, rel=0.1)
    assert 0.0 < probe.ratios().max() <= 1.0 + 1e-6
    assert not probe.slips
    assert np.abs(probe.sole_places() - before).max() < 0.002


@pytest.mark.parametrize("name", CAMPAIGNS)
def test_a_campaign_can_be_run(name):
    campaign = load_campaign(FOLDER / "campaigns" / f"{name}.yaml")
    TrialRunner(campaign, Sources(tuple(campaign.code)))
    commands = (FOLDER.parent / "docs" / "benchmarks.md").read_text()
    assert f"atlas-drake sweep benchmarks/campaigns/{name}.yaml" in commands


def module_of(name):
    """A Python file of a campaign as a module."""
    path = FOLDER / "campaigns" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"campaign_{name}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # Dataclasses look themselves up there.
    spec.loader.exec_module(module)
    return module


FEET = [
    FootPose(np.array([0.0, y, 0.0]), rotation_z(yaw))
    for y, yaw in ((0.12, 0.05), (-0.12, -0.05))
]


@pytest.mark.parametrize("forward", [0.42, 0.7])
def test_random_walks_are_within_the_limits_whatever_they_are(forward):
    walks = module_of("random_walks")
    limits = StepLimits(forward=forward, duration=LeastGreatest(0.5, 2.0))
    ahead, quickest = [], np.inf
    for seed in range(40):
        now, last = list(FEET), RIGHT
        random = np.random.default_rng(seed)
        steps = walks.random_steps(FEET, limits, random, 25)
        assert [step.index for step in steps] == list(range(1, 26))
        for step in steps:
            assert step.index == 1 or step.foot != last
            start, stance = now[step.foot], now[1 - step.foot]
            legal = limit_duration(
                saturate(step, stance, limits), start, stance, limits
            )
            np.testing.assert_allclose(legal.p_WF, step.p_WF, atol=1e-12)
            assert legal.yaw == pytest.approx(step.yaw)
            assert legal.duration == step.duration <= walks.SLOWEST
            assert legal.swing_height == step.swing_height
            ahead.append((rotation_z(stance.yaw).T @ (step.p_WF - stance.p_WF))[0])
            quickest = min(quickest, step.duration)
            now[step.foot], last = step.pose, step.foot
        side_by_side = (rotation_z(now[0].yaw).T @ (now[0].p_WF - now[1].p_WF))[:2]
        np.testing.assert_allclose(side_by_side, [0.0, 0.24], atol=1e-9)
    # They go to the limits.
    assert -limits.backward <= min(ahead) < 0.95 * -limits.backward
    assert 0.95 * forward < max(ahead) <= forward
    assert 0.5 <= quickest < 0.51


def test_the_same_seed_is_the_same_random_walk():
    walks, limits = module_of("random_walks"), StepLimits()
    one, again, other = (
        walks.random_steps(FEET, limits, np.random.default_rng(seed), 25)
        for seed in (1, 1, 2)
    )
    assert [step.duration for step in one] == [step.duration for step in again]
    assert [step.duration for step in one] != [step.duration for step in other]


def test_directions_of_pushes_are_relative_to_the_stance_foot():
    angle = module_of("push_moments")._angle
    left, right = 0.5 * np.pi, -0.5 * np.pi
    assert angle("forward", "left") == angle("forward", "right") == 0.0
    # The left foot swings while the right one stands.
    assert (angle("outward", "right"), angle("inward", "right")) == (left, right)
    assert (angle("outward", "left"), angle("inward", "left")) == (right, left)


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_pushes_share_a_walk_and_are_those_of_walks_of_their_own():
    campaign = load_campaign(FOLDER / "campaigns" / "push_moments.yaml")
    sources = Sources(tuple(campaign.code))
    shared = TrialRunner(campaign, sources)
    cases = case_list(campaign)

    def trial(moment):
        case = {
            "parameters.moment": moment,
            "parameters.direction": "outward",
            "parameters.stance": "left",
        }
        return make_trial(campaign, 3 * len(cases) + cases.index(case), 1)

    shared(trial("late"))
    record = shared(trial("mid"))
    assert record["error"] is None
    assert record["figures"]["stands"]
    alone = TrialRunner(campaign, sources)
    assert alone(trial("mid"))["figures"] == record["figures"]


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_a_random_walk_is_walked_to_its_end():
    path = FOLDER / "campaigns" / "random_walks.yaml"
    campaign = load_campaign(path, ["parameters.num_steps=4"])
    trial_runner = TrialRunner(campaign, Sources(tuple(campaign.code)))
    record = trial_runner(make_trial(campaign, 1))
    assert record["error"] is None
    assert record["success"], record["missed"]
    assert record["figures"]["last_index"] == 4


@pytest.mark.slow
@pytest.mark.usefixtures("restored_loggers")
def test_a_displaced_start_is_judged():
    path = FOLDER / "campaigns" / "entry_joints.yaml"
    steps = ["physics_step=0.002", "control_period=0.004"]
    campaign = load_campaign(path, steps)
    trial_runner = TrialRunner(campaign, Sources(tuple(campaign.code)))
    for level, survived in ((1, True), (4, False)):
        number = 4 * level
        assert level_of(campaign, number) == level
        record = trial_runner(make_trial(campaign, number, level))
        assert record["error"] is None
        assert record["figures"]["survived"] is survived
        assert record["figures"]["let_in"] == 0
