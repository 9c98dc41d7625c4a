"""Campaigns as data: what a file may say, and what is drawn from it."""

import re
from pathlib import Path

import numpy as np
import pytest

from atlas_drake import ScenarioError
from atlas_drake.clients.campaigns import Campaign, load_campaign
from atlas_drake.clients.campaigns.campaign import unmet
from atlas_drake.clients.campaigns.distributions import check_distribution, draw
from atlas_drake.clients.campaigns.plan import (
    case_list,
    make_trial,
    parameters_of,
    scenario_of,
    trial_seed,
)


@pytest.mark.slow
def test_trials_draw_their_values_from_the_distributions_of_the_file(campaign_file):
    path = campaign_file(
        "vary:\n"
        "  jitter.joints: {normal: [0.01, 1e-3]}\n"
        "  parameters.side: {choice: [left, right]}\n"
        "  start.yaw: {sign: 0.5}\n"
        "  controller.gains.dcm_gain: {log_uniform: [1.5, 3.0]}\n"
        "cases: {model: [atlas, atlas_v3]}\n"
        "parameters: {length: 2.0}\n"
    )
    campaign = load_campaign(path, ["ground_friction=0.8"])
    assert case_list(campaign) == [{"model": "atlas"}, {"model": "atlas_v3"}]
    two = Campaign(cases={"model": ["atlas", "atlas_v3"], "parameters.a": [1, 2]})
    assert len(case_list(two)) == 4
    assert campaign.scenario.ground_friction == 0.8
    assert campaign.scenario.duration == 0.1
    trials = [make_trial(campaign, number) for number in range(60)]
    scenarios = [scenario_of(campaign, trial) for trial in trials]
    assert {s.model for s in scenarios} == {"atlas", "atlas_v3"}
    assert {s.start.yaw for s in scenarios} == {-0.5, 0.5}
    impulses = [s.pushes[0].impulse for s in scenarios]
    assert 5.0 <= min(impulses) < 15.0 < 30.0 < max(impulses) <= 40.0
    gains = [s.controller_config().gains.dcm_gain for s in scenarios]
    assert 1.5 <= min(gains) < max(gains) <= 3.0
    assert np.mean([s.jitter.joints for s in scenarios]) == pytest.approx(
        0.01, abs=1e-3
    )
    parameters = [parameters_of(campaign, trial) for trial in trials]
    assert {p["side"] for p in parameters} == {"left", "right"}
    assert {p["length"] for p in parameters} == {2.0}
    # The two robots get the same draws.
    for one, other in zip(trials[::2], trials[1::2], strict=True):
        assert one.seed == other.seed
        assert one.values["start.yaw"] == other.values["start.yaw"]


def test_another_varied_field_does_not_change_a_trials_seed_and_draws(campaign):
    plain, more = campaign(), campaign("vary: {start.yaw: {sign: 0.5}}")
    path = "pushes[0].impulse"
    for number in (0, 7):
        one, other = make_trial(plain, number), make_trial(more, number)
        assert one.seed == other.seed
        assert one.values[path] == other.values[path]


def test_seeds_are_spread_or_counted():
    assert trial_seed(Campaign(seed=5, seeds="counted"), 3) == 8
    spread = {trial_seed(Campaign(seed=5), k) for k in range(1000)}
    assert len(spread) == 1000
    assert trial_seed(Campaign(seed=6), 0) not in spread


@pytest.mark.parametrize("kind", ["uniform", "log_uniform", "normal"])
def test_distributions_have_the_moments_of_their_names(kind):
    random = np.random.default_rng(3)
    distribution = check_distribution({kind: [1.0, 2.0]}, "here")
    values = np.array([draw(distribution, random) for _ in range(2000)])
    if kind == "normal":
        assert values.mean() == pytest.approx(1.0, abs=0.15)
        assert values.std() == pytest.approx(2.0, abs=0.15)
    else:
        assert 1.0 <= values.min() < 1.02 < 1.98 < values.max() <= 2.0
        median = np.sqrt(2.0) if kind == "log_uniform" else 1.5
        assert np.median(values) == pytest.approx(median, abs=0.04)


def test_integers_are_drawn_with_both_ends():
    random = np.random.default_rng(3)
    distribution = check_distribution({"integers": [2, 4]}, "here")
    drawn = [draw(distribution, random) for _ in range(50)]
    assert set(drawn) == {2, 3, 4}
    assert all(type(number) is int for number in drawn)


@pytest.mark.parametrize(
    ("more", "field"),
    [
        ("trails: 5", "trails"),
        ("trials: 0", "trials"),
        ("seeds: random", "seeds"),
        ("seed: -1", "seed"),
        ("goal: 2.0", "goal"),
        ("trial_timeout: -1", "trial_timeout"),
        ("trial_timeout: .inf", "trial_timeout"),
        ("vary: {start.yaw: {uniform: [1]}}", "vary.start.yaw.uniform"),
        ("vary: {start.yaw: {uniform: [2, 1]}}", "vary.start.yaw.uniform"),
        ("vary: {seed: {integers: [0.5, 1]}}", "vary.seed.integers[0]"),
        ("vary: {start.yaw: {uniforn: [1, 2]}}", "vary.start.yaw.uniforn"),
        ("vary: {start.yaw: {sign: .nan}}", "vary.start.yaw.sign"),
        ("vary: {start.yaw: 3}", "vary.start.yaw"),
        ("vary: {jitter.mass: {log_uniform: [0, 1]}}", "vary.jitter.mass.log_uniform"),
        ("vary: {jitter.mas: {uniform: [0, 1]}}", "vary.jitter.mas"),
        ("vary: {seed: {uniform: [0, 1]}}", "vary.seed"),
        ("vary: {jitter.mass: {uniform: [0, 7]}}", "vary.jitter.mass"),
        ("vary: {'pushes[0].impulse': {sign: 1}}", "vary.pushes[0].impulse"),
        ("cases: {model: atlas}", "cases.model"),
        ("cases: {model: [atlas, atlass]}", "cases.model"),
        ("success: [tilt_max_rad << 3]", "success[0]"),
        ("threshold: {of: jitter.mass, max: 0.1, step: 0}", "threshold.step"),
        ("threshold: {of: jitter.mass, max: 0.1, step: 0.2}", "threshold.step"),
        (
            "threshold: {of: jitter.mass, max: 0.1, step: 0.1, passes: 9}",
            "threshold.passes",
        ),
        ("model: atlas", "model"),
        ("threshold: {of: jitter.mass, max: 2.0, step: 1}", "threshold.of"),
    ],
)
def test_bad_input_names_the_field(more, field, campaign_file):
    with pytest.raises(ScenarioError) as caught:
        load_campaign(campaign_file(more))
    assert caught.value.field == field
    assert "tiny.yaml" in caught.value.problem


def test_a_scenario_is_a_file_or_its_fields(tmp_path):
    (tmp_path / "scenario.yaml").write_text("ground_friction: 0.7\n")
    (tmp_path / "campaign.yaml").write_text("scenario: scenario.yaml\n")
    campaign = load_campaign(tmp_path / "campaign.yaml")
    assert campaign.scenario.ground_friction == 0.7
    for text in ("scenario: {ground_friction: -1}", "scenario: {ground_friction: {}}"):
        (tmp_path / "campaign.yaml").write_text(text)
        with pytest.raises(ScenarioError) as caught:
            load_campaign(tmp_path / "campaign.yaml")
        assert caught.value.field == "scenario.ground_friction"


def test_unmet_conditions_are_listed():
    figures = {"success": True, "error": 0.01, "steps": 4, "none": None}
    assert unmet(["success", "error <= 0.02", "steps == 4"], figures) == []
    assert unmet(["error > 0.02", "none < 1", "missing"], figures) == [
        "error > 0.02",
        "none < 1",
        "missing",
    ]


def test_a_setting_replaces_distribution_and_cases(campaign_file):
    path = campaign_file("cases: {model: [atlas, atlas_v3], parameters.side: [1, 2]}")
    settings = ["pushes[0].impulse=7", "parameters.side=left"]
    campaign = load_campaign(path, settings, {"model": "atlas_v3"})
    assert set(campaign.vary) == {"pushes[0].direction"}
    assert campaign.cases == {}
    trial = make_trial(campaign, 0)
    assert scenario_of(campaign, trial).pushes[0].impulse == 7.0
    assert scenario_of(campaign, trial).model == "atlas_v3"
    assert parameters_of(campaign, trial) == {"side": "left"}
    for text in ("parameters.=3", "parameters.side"):
        with pytest.raises(ScenarioError, match="--set"):
            load_campaign(path, [text])


def test_the_docs_campaigns_can_be_loaded(tmp_path):
    page = Path(__file__).parents[3] / "docs" / "campaigns.md"
    blocks = re.findall(r"^```yaml\n(.*?)^```", page.read_text("utf-8"), re.S | re.M)
    assert len(blocks) == 3
    whole, pushes, threshold = blocks
    for text in (whole, pushes, threshold + "pushes: [{time: 0.1}]\n"):
        path = tmp_path / "campaign.yaml"
        path.write_text(text)
        campaign = load_campaign(path)
        assert scenario_of(campaign, make_trial(campaign, 3)).pushes
