"""The examples: each has a docstring, runs without a view and ends with success."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "examples"
EXPECTED = {
    "01_user_mode": "Atlas still stands.",
    "02_stand": "Atlas still stands.",
    "03_mixed_control": "Atlas still stands.",
    "04_walk": "Atlas walked its curve.",
    "05_control_mode_switch": "Atlas stands, 4 steps further on.",
    "06_manipulate": "Atlas stands again.",
    "07_step": "Atlas stands on the block.",
    "08_walk_streaming": "Atlas walked its circle.",
    "09_cockpit": "Atlas stands after 9 steps.",
    "10_obstacles": "Atlas stands behind it.",
    "11_tour": "Atlas completed its tour.",
    "12_crate": "The crate is on the other table.",
    "13_valve": "The valve is open.",
    "14_door": "Atlas is through the door.",
    "15_box": "The box is out of the way.",
    "16_tray": "The glass is served.",
    "walker": "Atlas stands.",
    "walker_qp": "Atlas stands.",
}
"""What each prints last when all is well."""
SHORTER = {"16_tray": ["--far", "1"]}
"""Arguments of examples that take long."""


def test_every_example_is_expected_here():
    assert {path.stem for path in FOLDER.glob("*.py")} == set(EXPECTED)


@pytest.mark.parametrize("name", EXPECTED)
def test_examples_explain_themselves_and_are_watched_from_here_alone(run_program, name):
    status, out = run_program(FOLDER / f"{name}.py", "--help")
    assert status == 0
    assert "--headless" in out
    text = (FOLDER / f"{name}.py").read_text()
    assert "view=" in text or "open_cockpit(" in text
    assert "eshcat(" not in text


@pytest.mark.slow
@pytest.mark.parametrize(("name", "status"), [("02_stand", -2), ("09_cockpit", 0)])
def test_ctrl_c_ends_an_example_without_a_traceback(name, status):
    """Also with the view, and where there is no standard input."""
    process = subprocess.Popen(
        [sys.executable, "-u", str(FOLDER / f"{name}.py")],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert " at http://localhost:" in process.stdout.readline()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == status, errors
    assert "Traceback" not in errors


@pytest.mark.slow
@pytest.mark.parametrize(("name", "last"), EXPECTED.items(), ids=EXPECTED)
def test_examples_run_to_a_good_end(run_program, name, last):
    arguments = ["--headless", *SHORTER.get(name, [])]
    status, out = run_program(FOLDER / f"{name}.py", *arguments)
    assert status == 0, out
    assert last in out.splitlines()[-1]
