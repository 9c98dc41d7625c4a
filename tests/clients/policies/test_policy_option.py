"""``atlas-drake run --policy``."""

import json

import pytest

from atlas_drake.clients.cli.main import main
from tests.policy_networks import METADATA, save


@pytest.fixture
def network(tmp_path):
    """A policy that holds an arm."""
    return save(tmp_path / "arm.onnx", [0.0, 0.0], metadata=METADATA)


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
        (["--watchdog"], "--watchdog needs --policy"),
        (["--policy", "FILE", "--velocity", "fast"], "'fast' is not X,Y,TURN"),
        (["--policy", "nowhere.onnx"], "nowhere.onnx"),
        (["--policy", "FILE", "--policy-joints", "a,b"], "has no joint 'a'"),
        (["--policy", "FILE", "--set", "schedule=tutorial"], "commands of its own"),
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
