"""Trials in one process: figures, errors, simulations that are kept."""

from dataclasses import replace
from itertools import pairwise

import pytest

from atlas_drake import AtlasSimulation, ScenarioError
from atlas_drake.clients.campaigns.plan import make_trial
from atlas_drake.clients.campaigns.results import same_result
from atlas_drake.clients.campaigns.shipped import walk
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.scenario import Scenario, with_settings

pytestmark = pytest.mark.usefixtures("restored_loggers")

OWN = """
    import numpy as np

    def hop(sim, parameters):
        if sim.scenario.seed % 2:
            raise ValueError("an odd seed")
        sim.advance(0.02)
        if sim.scenario.seed == 2:
            return {"height_m": 0.0}
        return {"kind": parameters["kind"], "size": np.float64(parameters["size"])}

    def height(sim):
        return {"height_m": sim.pelvis_pose.translation()[2], "none": float("nan")}
"""
LINES = """
trial: hop
parameters: {kind: low}
vary: {parameters.size: {uniform: [1, 2]}}
metrics: [success, height]
success: [success, height_m > 0.5]
seeds: counted
"""


@pytest.mark.slow
def test_the_walk_takes_the_gait_of_its_parameters():
    sim = AtlasSimulation(Scenario(duration=9.0))
    gait = {"stride": 0.25, "step_duration": 0.8, "swing_height": 0.12}
    assert walk(sim, {"distance": 1.15, **gait}) == {"walk_ended": True}
    places = [step["commanded"][0] for step in sim.footsteps]
    assert len(places) >= 4
    assert max(b - a for a, b in pairwise(places)) == pytest.approx(0.25, abs=1e-3)
    landings = [e.time for e in sim.events if e.kind == "footstep"]
    assert landings[2] - landings[1] == pytest.approx(0.8, abs=0.03)


@pytest.mark.slow
def test_every_trial_is_reproducible_alone(campaign):
    lines = "vary: {ground_friction: {uniform: [0.5, 0.9]}}"
    cases = "cases: {controller.gains.dcm_gain: [2.0, 2.5]}"
    campaign = campaign(f"{lines}\n{cases}\n")
    trial_runner = TrialRunner(campaign)
    records = [trial_runner(make_trial(campaign, number)) for number in range(4)]
    # The gain is built in, and friction, push and jitter are not.
    assert [r["machine"]["built_anew"] for r in records] == [True, True, False, False]
    assert all(r["success"] for r in records)
    figures = records[2]["figures"]
    assert figures["sim_time_s"] == pytest.approx(0.1)
    assert figures["work_taken_j"] > 0.0
    assert 0.0 < figures["tilt_max_rad"] < 1.0
    assert len({r["figures"]["tilt_max_rad"] for r in records}) == 4
    # Another runner has kept nothing.
    alone = TrialRunner(campaign)(make_trial(campaign, 2))
    assert alone["machine"]["built_anew"]
    assert same_result(alone) == same_result(records[2])


@pytest.mark.slow
def test_user_functions_run_and_measure_a_trial(campaign):
    campaign = campaign(LINES, OWN)
    trial_runner = TrialRunner(campaign)
    trials = [trial_runner(make_trial(campaign, number)) for number in range(3)]
    good, odd, doubled = trials
    assert good["success"]
    assert good["error"] is None
    figures = good["figures"]
    assert figures["kind"] == "low"
    assert figures["none"] is None
    assert figures["size"] == good["values"]["parameters.size"]
    # A trial that raises is a result, and its simulation is not used again.
    assert not odd["success"]
    assert "Traceback" in odd["error"]
    assert odd["error"].endswith("ValueError: an odd seed\n")
    assert doubled["machine"]["built_anew"]
    assert "height: there is a figure height_m already" in doubled["error"]


@pytest.mark.parametrize(
    ("more", "field"),
    [
        ("metrics: [succes]", "metrics[0]"),
        ("metrics: ['no.module:f']", "metrics[0]"),
        ("trial: jump", "trial"),
        ("code: nothing.py", "code"),
    ],
)
def test_an_unknown_function_is_named_with_its_field(more, field, campaign):
    lines = more if "metrics" not in more else f"trial: run\n{more}"
    with pytest.raises(ScenarioError) as caught:
        TrialRunner(campaign(lines.replace("metrics", "success: []\nmetrics")))
    assert caught.value.field == field


LEAN = """
    from dataclasses import dataclass

    from atlas_drake.behaviors.entry import BehaviorEntry
    from atlas_drake.config import Share

    @dataclass(frozen=True)
    class Lean:
        angle: Share = 0.1

    behaviors = [
        BehaviorEntry(
            name="LEAN", number=100, make=lambda _tools, _config: None, config=Lean()
        )
    ]
"""


def test_settings_of_a_behavior_are_checked_before_the_first_trial(campaign):
    good = campaign("cases: {controller.lean.angle: [0.1]}", LEAN)
    TrialRunner(good)
    for more, words in (
        ("vary: {controller.lean.angle: {uniform: [0, 2]}}", "controller.lean.angle"),
        ("cases: {controller.laen.angle: [0.1]}", "Did you mean 'lean'"),
    ):
        made = campaign(more, LEAN)
        with pytest.raises(ScenarioError, match=words):
            TrialRunner(made)
    scenario = with_settings(Scenario(), ["controller.laen.angle=0.1"])
    with pytest.raises(ScenarioError, match="Did you mean 'lean'"):
        TrialRunner(replace(good, cases={}, scenario=scenario))
