"""``atlas-drake script``: what it prints, writes and returns, and the examples."""

import json
import math
import os
import signal
import subprocess
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from atlas_drake import read_log
from atlas_drake.clients.cli.main import main
from atlas_drake.clients.cli.run import end_after_fall
from atlas_drake.messages.event import Event

from .conftest import COMMAND

pytestmark = pytest.mark.usefixtures("restored_loggers")

EXAMPLES = Path(__file__).parents[3] / "examples" / "scripts"
TUTORIAL = (
    Path(os.environ.get("ATLAS_DRAKE_REFERENCE", "no such folder"))
    / "atlas_switching_control_modes_tutorial.txt"
)
"""The tutorial's page, which is not part of the project."""


@pytest.fixture
def program(tmp_path):
    """Writes a program's file and gives its path."""

    def write(text):
        path = tmp_path / "program.py"
        path.write_text(text)
        return str(path)

    return write


@pytest.mark.slow
def test_a_program_has_summary_log_and_verdict(program, tmp_path, capsys):
    path = program(
        "import rospy, sys\n"
        "rospy.init_node('test')\n"
        "print(sys.argv[1:])\n"
        "rospy.loginfo('at %s', 'work')\n"
        "rospy.sleep(0.2)\n"
    )
    summary, log = tmp_path / "run.json", tmp_path / "run.mcap"
    kept = ["--json", str(summary), "--log", str(log)]
    assert main(["script", path, "--headless", *kept, "--", "-x", "--json"]) == 0
    out = capsys.readouterr().out
    assert "['-x', '--json']" in out
    assert "[INFO] [0.0" in out
    assert "]: at work" in out
    assert "Success: the robot is upright after 0.2 s." in out
    told = json.loads(summary.read_text())
    assert told["success"]
    assert told["scenario"] == "program"
    assert told["sim_time"] == pytest.approx(0.2, abs=0.01)
    assert read_log(log).time[-1] == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize(
    ("text", "status", "words"),
    [
        ("import rospy\nrospy.Foo\n", 2, ["rospy.Foo", 'program.py", line 2']),
        ("import nothing_like_it\n", 2, ["nothing_like_it"]),
        ("x = (\n", 2, ["program.py:1:"]),
        ("1 / 0\n", 1, ["ZeroDivisionError", 'program.py", line 1']),
        ("raise SystemExit(4)\n", 1, ["ended with status 4"]),
        ("raise SystemExit\n", 0, ["Success"]),
    ],
)
def test_the_exit_status_tells_a_faulty_program_from_an_unsupported_one(
    program, text, status, words, capsys
):
    assert main(["script", program(text), "--headless"]) == status
    told = "".join(capsys.readouterr())
    for word in words:
        assert word in told


@pytest.mark.parametrize("text", ["import rospy\nrospy.spin()\n", "x = 1\n"])
def test_a_run_lasts_for_its_duration_with_any_program(program, text, capsys):
    path = program(text)
    assert main(["script", path, "--headless", "--duration", "0.1"]) == 0
    assert "upright after 0.1 s" in capsys.readouterr().out


def test_a_program_that_ends_with_a_command_gets_the_hint_to_give_a_duration(
    program, capsys
):
    path = program(
        "import rospy\nfrom std_msgs.msg import String\n"
        "rospy.Publisher('atlas/control_mode', String).publish('Manip')\n"
    )
    assert main(["script", path, "--headless"]) == 0
    assert "--duration" in capsys.readouterr().out
    assert main(["script", path, "--headless", "--duration", "0.05"]) == 0
    out = capsys.readouterr().out
    assert "--duration" not in out
    assert "STAND -> MANIPULATE" in out


@pytest.mark.parametrize(("fallen", "end"), [(True, 7.0), (False, math.inf)])
def test_a_run_ends_after_the_last_fall(fallen, end):
    falls = [Event(time, "fall", "") for time in (1.0, 5.0)]
    sim = SimpleNamespace(has_fallen=fallen, events=falls)
    assert end_after_fall(sim) == end


def test_steps_that_were_not_taken_are_told(program, capsys):
    path = program(
        "import actionlib, rospy\nfrom atlas_msgs.msg import *\n"
        "goal = WalkDemoGoal(behavior=WalkDemoGoal.WALK)\n"
        "for i in range(1, 6):\n"
        "    step = AtlasBehaviorStepData(step_index=i, foot_index=i % 2)\n"
        "    step.duration, step.pose.position.y = 0.63, 0.1 - i % 2 * 0.2\n"
        "    goal.steps.append(step)\n"
        "client = actionlib.SimpleActionClient('atlas/bdi_control', WalkDemoAction)\n"
        "client.send_goal(goal)\nrospy.sleep(0.1)\n"
    )
    assert main(["script", path, "--headless"]) == 0
    out = capsys.readouterr().out
    assert "with 4 steps and a goal of atlas/bdi_control not completed" in out
    assert "--duration" in out


def test_a_refused_message_is_a_run_that_failed(program, capsys):
    path = program(
        "import rospy\nfrom atlas_msgs.msg import AtlasCommand\n"
        "p = rospy.Publisher('atlas/atlas_command', AtlasCommand)\n"
        "p.publish(AtlasCommand(position=[0] * 3))\nrospy.sleep(0.05)\n"
    )
    assert main(["script", path, "--headless"]) == 1
    assert "did not execute a command: refused: position" in capsys.readouterr().out


def test_a_missing_program_is_named(tmp_path, capsys):
    assert main(["script", str(tmp_path / "no.py"), "--headless"]) == 2
    assert "no.py: there is no such file" in capsys.readouterr().err
    assert main(["script", str(tmp_path), "--headless"]) == 2
    assert f"{tmp_path}: is a folder" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("rospy.loginfo('now')\nrospy.sleep(1e3)\n", []),
        (
            "rospy.loginfo('now')\ntry:\n    sys.stdin.readline()\n"
            "except KeyboardInterrupt:\n    print('heard')\n",
            ["heard"],
        ),
    ],
)
def test_ctrl_c_ends_a_program_and_its_summary_is_written(
    program, tmp_path, text, printed
):
    path = program("import rospy, sys\nrospy.init_node('test')\n" + text)
    summary = tmp_path / "run.json"
    process = subprocess.Popen(
        [*COMMAND, "script", path, "--headless", "--json", str(summary)],
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert "now" in process.stdout.readline()
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    process.wait(timeout=60)  # The end of its input would end the wait, too.
    out, errors = process.communicate(timeout=60)
    assert process.returncode == 130, out + errors
    assert "Stopped at" in out
    assert "Traceback" not in errors
    for word in printed:
        assert word in out
    assert json.loads(summary.read_text())["stopped"] == "interrupted"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "arguments", "keys", "words"),
    [
        (
            "trajectory",
            ["--", str(EXAMPLES / "poses.yaml"), "wave"],
            "",
            ["wave back: there at 1.7 s"],
        ),
        ("keyboard", [], "s w 4.4\nx 0.1 q", ["4 steps taken", "there is no key x"]),
        (
            "step_up",
            ["--scenario", str(EXAMPLES / "platform.yaml")],
            "",
            ["up there", "2 steps taken"],
        ),
    ],
)
def test_the_examples_run_to_a_good_end(
    name, arguments, keys, words, tmp_path, capsys, monkeypatch
):
    typed = tmp_path / "keys"
    typed.write_text(keys)
    command = ["script", str(EXAMPLES / f"{name}.py"), "--headless"]
    with typed.open() as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        assert main([*command, *arguments]) == 0
    out = capsys.readouterr().out
    assert "not up there" not in out
    for word in words:
        assert word in out


def with_indentation(page):
    """The tutorial's program as it was before the page lost its indentation."""
    lines = page.splitlines()
    level, program = 0, []
    for line in lines[lines.index("#!/usr/bin/env python") :]:
        if line.startswith(("class ", "if __name__")):
            level = 0
        elif line.startswith("def "):
            level = 1
        program.append("    " * level + line)
        if line.startswith(("class ", "def ", "for ", "if __name__")):
            level += 1
        elif "step_queue[i] = " in line:  # The end of its only loop.
            level -= 1
        elif line == "d.demo()":
            break
    return "\n".join(program) + "\n"


@pytest.mark.slow
@pytest.mark.skipif(
    not TUTORIAL.exists(),
    reason="ATLAS_DRAKE_REFERENCE names no folder with the tutorial's page",
)
def test_the_program_of_the_tutorial_runs_as_it_was_published(program, capsys):
    page = TUTORIAL.read_text(encoding="utf-8")
    assert main(["script", program(with_indentation(page)), "--headless"]) == 0
    out = capsys.readouterr().out
    told = [line for line in out.splitlines() if line.startswith(("[USER", "[BDI"))]
    assert len(told) == 6
    assert "4 steps taken" in out
    assert "upright after 17.0 s" in out
