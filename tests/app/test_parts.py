"""``--with FILE.py``: the user's own parts on the command line."""

import json
from pathlib import Path

import pytest

from atlas_drake.app.main import main

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
MAKE = PARTS.replace("Idle(),", '{}["idle"],')


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
    assert main([*arguments, "--json", str(summary)]) == 0
    assert json.loads(summary.read_text())["success"]


def test_a_scenario_sets_the_parameters_of_a_behavior_that_a_file_brings(
    scenario, tmp_path
):
    summary = tmp_path / "run.json"
    shipped = Path(__file__).parents[2] / "examples" / "extending" / "own_behavior.py"
    command = "{behavior: BOW, params: {depth: 0.3}}"
    messages = f"[{{time: 0.0, atlas_sim_interface_command: {command}}}]"
    arguments = ["run", scenario(), *SHORT, "--with", str(shipped)]
    arguments += ["--set", f"messages={messages}", "--json", str(summary)]
    assert main(arguments) == 0
    assert json.loads(summary.read_text())["final_behavior"] == "BOW"


@pytest.mark.parametrize("form", ["--with {}", "--with={}"])
def test_help_names_the_behaviors_that_it_brings(form, parts, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["run", "--help", *form.format(parts(PARTS)).split()])
    assert stop.value.code == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "WALK (4): Walk dynamically" in out
    assert "REST (123): Do nothing." in out


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 / 0", "failed: ZeroDivisionError"),
        ("x = 1", "defines none of controller, behaviors, world, extend"),
        ("controller = 3", "controller must be a System or a callable"),
        ("behaviors = [3]", "must be BehaviorEntry values"),
        ("extend = 3", "extend must be a callable"),
        ("world = 3", "world must be a list"),
        ("behaviors = None", "must be a list of BehaviorEntry values"),
        ("raise SystemExit(0)", "failed: SystemExit"),
        ("def controller(robot, scenario): 1 / 0", "controller of {} failed: ZeroDiv"),
        ("def add(plant): plant.fly()\nworld = [add]", "world[0] of {} failed: Attrib"),
        (MAKE, "behaviors[0].make of {} failed: KeyError"),
        (TAKEN, "extend adds what Drake cannot build: System _ already has an output"),
        ("def extend(builder, station): 1 / 0", "extend of {} failed: ZeroDivision"),
    ],
)
def test_a_file_that_cannot_be_used_is_named(text, words, parts, scenario, capsys):
    file = parts(text)
    assert main(["run", scenario(), *SHORT, "--with", file]) == 2
    assert words.format(file) in capsys.readouterr().err
    if text.startswith("behaviors"):
        assert main(["run", "--help", "--with", parts(text)]) == 2
        assert words in capsys.readouterr().err


def test_a_missing_file_of_with_is_named(scenario, capsys):
    assert main(["run", scenario(), *SHORT, "--with", "nowhere.py"]) == 2
    assert "nowhere.py: there is no such file" in capsys.readouterr().err
