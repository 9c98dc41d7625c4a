"""The page on extending: its programs run, and its pictures exist."""

import re
from dataclasses import dataclass, replace
from math import pi, sin
from pathlib import Path

import numpy as np
import pytest

from atlas_drake import (
    AtlasSimInterfaceCommand,
    AtlasSimulation,
    Behavior,
    Scenario,
    read_log,
)
from atlas_drake.behaviors.entry import BehaviorEntry
from atlas_drake.clients.parts_file import load_parts
from atlas_drake.messages.event import Event
from atlas_drake.shipped import BEHAVIORS, shipped_entry

ROOT = Path(__file__).parents[1]
FOLDER, PAGE = ROOT / "examples" / "extending", ROOT / "docs" / "extending.md"
LARGEST, LONGEST = 60_000, 80
"""A picture [byte] and a program [lines] are at most so long."""
PROGRAMS = {
    "own_diagram": ((), r"3 pictures are in \S+\."),
    "falls_on_purpose": ((), r"It fell, by 0\.7\d m, at \d\.\d m/s\."),
    "torque_free_arms": ((), r"It stands\."),
    "message_source": ((), r"STAND after 0\.\d\d m\."),
    "own_behavior": ((), r"It stands\."),
    "own_controller": ((), r"It fell\."),
    "own_robot": (("--distance", "0.3"), r"It stands\."),
    "own_task": (("--seconds", "3"), r"It stands\."),
    "own_world": ((), r"It stands\."),
}
"""Arguments of each program, and what it prints last when all is well."""


def test_the_page_shows_every_program_and_its_picture():
    text = PAGE.read_text("utf-8")
    assert "(docs/extending.md)" in (ROOT / "README.md").read_text("utf-8")[:3000]
    programs = {path.stem for path in FOLDER.glob("*.py")}
    assert programs == set(PROGRAMS)
    for name in programs:
        assert f"(../examples/extending/{name}.py)" in text
        assert f"(images/extending_{name}.png)" in text
        picture = ROOT / f"docs/images/extending_{name}.png"
        assert picture.stat().st_size <= LARGEST
        lines = (FOLDER / f"{name}.py").read_text("utf-8").splitlines()
        assert len(lines) <= LONGEST, name
        assert f"python examples/extending/{name}.py" in lines[2]


def test_the_table_leads_to_every_section():
    text = PAGE.read_text("utf-8")
    titles = re.findall(r"^## (.*)$", text, re.MULTILINE)
    anchors = [title.lower().replace(" ", "-") for title in titles]
    assert re.findall(r"\]\(#(.*?)\)", text) == anchors


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("falls_on_purpose", ["controller"]),
        ("torque_free_arms", ["controller"]),
        ("own_behavior", ["behaviors"]),
        ("own_controller", ["controller"]),
        ("own_diagram", ["world", "extend"]),
        ("own_task", ["behaviors"]),
        ("own_world", ["world"]),
    ],
)
def test_the_programs_bring_their_parts_on_the_command_line(name, parts):
    assert list(load_parts(FOLDER / f"{name}.py")) == parts


@pytest.mark.slow
@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_come_to_a_good_end(name, run_program, tmp_path):
    arguments, last = PROGRAMS[name]
    if name == "own_diagram":
        arguments = ("--folder", str(tmp_path))
    status, out = run_program(FOLDER / f"{name}.py", *arguments)
    assert status == 0, out
    assert re.fullmatch(last, out.splitlines()[-1])


def test_a_frame_of_the_robot_has_a_pose():
    sim = AtlasSimulation()
    assert sim.frame_pose("l_sole").translation()[2] == pytest.approx(0.0, abs=2e-3)
    assert sim.frame_pose("pelvis").IsExactlyEqualTo(sim.pelvis_pose)
    with pytest.raises(ValueError, match=r"no frame 'l_sol'\. Did you mean 'l_sole'"):
        sim.frame_pose("l_sol")


@pytest.mark.slow
def test_a_frame_of_two_models_is_refused_with_their_names():
    sim = AtlasSimulation(Scenario(world="tray"))
    with pytest.raises(ValueError, match=r"frames '__model__' of .*tray"):
        sim.frame_pose("__model__")


def test_an_element_of_a_channel_has_a_name(tmp_path):
    with AtlasSimulation(log=tmp_path / "run.mcap") as sim:
        sim.advance(0.02)
    log = read_log(tmp_path / "run.mcap")
    np.testing.assert_array_equal(log["balance.com.z"], log["balance.com"][:, 2])
    with pytest.raises(KeyError, match=r"balance\.com\.w.*balance\.com\.[xyz]"):
        log["balance.com.w"]


def nod(tools, config):
    """Makes STAND with a neck that nods."""
    neck = tools.robot.joint_index("neck_ry")

    def pose(upright, seen, request, leaving):
        joints = upright.joints.copy()
        joints[neck] += 0.2 * sin(2.0 * pi * seen.time / 3.0)
        return replace(upright, joints=joints)

    stand = tools.stand(pose)
    stand.feedback = lambda state, status_flags: Nodding(state.com)
    return stand


@dataclass(frozen=True)
class Nodding:
    com: np.ndarray


@pytest.mark.slow
def test_standing_with_a_nod_is_a_behavior_that_ends_when_it_is_left():
    sim = AtlasSimulation(behaviors=[BehaviorEntry(name="NOD", number=100, make=nod)])
    sim.publish(AtlasSimInterfaceCommand(behavior="NOD"))
    sim.advance(1.0)
    np.testing.assert_allclose(
        sim.atlas_sim_interface_state.feedback.com, [0.0, 0.0], atol=0.1
    )
    neck = sim.atlas_state.position[sim.robot.joint_index("neck_ry")]
    assert neck == pytest.approx(0.19, abs=0.03)
    sim.publish(AtlasSimInterfaceCommand(behavior="STAND"))
    sim.advance(0.02)
    assert sim.current_behavior is Behavior.STAND
    assert sim.atlas_sim_interface_state.feedback is None


def test_a_shipped_entry_is_found():
    assert [shipped_entry(entry.behavior) for entry in BEHAVIORS] == list(BEHAVIORS)


def test_an_event_is_printed_as_a_line():
    assert str(Event(1.25, "fall", "falling")) == "1.250 s: falling"
