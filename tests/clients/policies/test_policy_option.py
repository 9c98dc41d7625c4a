"""``atlas-drake run --policy``."""

import json

import pytest

from atlas_drake.clients.cli.main import main
from tests.policy_networks import METADATA, save


@pytest.fixture
def network(tmp_path):
    """A policy that holds an arm."""
    return save(tmp_path / "arm.onnx", [0.0, 0.0], metadata=METADATA)


@pytest.mark.slow
def test_a_policy_commands_a_run(network, tmp_path, capsys):
    summary = tmp_path / "run.json"
    options = ["--headless", "--duration", "0.6", "--json", str(summary)]
    status = main(["run", "--policy", str(network), "--watchdog", *options])
    assert status == 0
    assert json.loads(summary.read_text())["upright"]
    assert "Success" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--watchdog"], "policy.file: is missing"),
        (["--policy", "FILE", "--velocity", "fast"], "'fast' is not X,Y,TURN"),
        (["--policy", "nowhere.onnx"], "nowhere.onnx"),
        (["--policy", "FILE", "--policy-joints", "a,b"], "has no joint 'a'"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(network, arguments, words, capsys):
    given = [str(network) if one == "FILE" else one for one in arguments]
    try:
        status = main(["run", "--headless", *given])
    except SystemExit as end:
        status = end.code
    assert status == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1


@pytest.mark.slow
def test_a_file_names_a_policy_beside_it(network, tmp_path, capsys):
    scenario = tmp_path / "run.yaml"
    scenario.write_text("{policy: {file: arm.onnx, watchdog: true}, duration: 0.5}")
    assert main(["run", str(scenario), "--headless"]) == 0
    assert main(["run", str(scenario), "--headless", "--velocity", "9,9,99"]) == 2
    assert "policy.velocity[2]" in capsys.readouterr().err


@pytest.mark.slow
def test_a_campaign_may_have_a_policy(network, tmp_path, capsys):
    campaign = tmp_path / "held.yaml"
    campaign.write_text("{duration: 0.4, trials: 2, success: [upright], metrics: []}")
    out = tmp_path / "out"
    options = ["--policy", str(network), "--jobs", "1", "--out", str(out)]
    assert main(["sweep", str(campaign), *options]) == 0
    assert "arm.onnx" in (out / "campaign.yaml").read_text()
