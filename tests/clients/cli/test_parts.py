"""``--with FILE.py``: the user's own parts on the command line."""

import json

import pytest

from atlas_drake.clients.cli.main import main

pytestmark = pytest.mark.usefixtures("restored_loggers")
SHORT = ["--headless", "--set", "duration=0.02"]
PARTS = """
from helpers import NUMBER
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.behaviors.idle import Idle

behaviors = [
    BehaviorEntry(
        name="REST",
        number=NUMBER,
        make=lambda tools, config: Idle(),
        description="Do nothing.",
    )
]

def extend(builder, station):
    builder.ExportOutput(station.GetOutputPort("effort"), "effort_again")

if __name__ == "__main__":
    raise SystemExit("this is no run of its own")
"""

TAKEN = """
def extend(builder, station):
    builder.ExportOutput(station.GetOutputPort("effort"), "effort")
"""


@pytest.fixture
def parts(tmp_path):
    def write(text):
        (tmp_path / "helpers.py").write_text("NUMBER = 123\n")
        path = tmp_path / "parts.py"
        path.write_text(text)
        return str(path)

    return write


def test_a_file_brings_its_parts(parts, scenario, tmp_path):
    summary = tmp_path / "run.json"
    arguments = ["run", scenario(), *SHORT, "--with", parts(PARTS)]
    messages = "[{time: 0.0, atlas_sim_interface_command: {behavior: REST}}]"
    arguments += ["--set", f"messages={messages}", "--json", str(summary)]
    assert main(arguments) == 0
    assert json.loads(summary.read_text())["final_behavior"] == "REST"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 / 0", "failed: ZeroDivisionError"),
        ("x = 1", "defines none of controller, behaviors, world, extend"),
        ("controller = 3", "controller must be a System or a callable"),
        ("behaviors = [3]", "must be a list of BehaviorEntry values"),
        ("extend = 3", "extend must be a callable"),
        ("world = 3", "world must be a list"),
        ("behaviors = None", "must be a list of BehaviorEntry values"),
        ("raise SystemExit(0)", "failed: SystemExit"),
        (TAKEN, "extend adds what Drake cannot build: System _ already has an output"),
    ],
)
def test_a_file_that_cannot_be_used_is_named(text, words, parts, scenario, capsys):
    file = parts(text)
    assert main(["run", scenario(), *SHORT, "--with", file]) == 2
    assert words in capsys.readouterr().err


def test_a_missing_file_of_with_is_named(scenario, capsys):
    assert main(["run", scenario(), *SHORT, "--with", "nowhere.py"]) == 2
    assert "nowhere.py: there is no such file" in capsys.readouterr().err
