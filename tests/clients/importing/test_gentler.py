"""Robots that stand and do not walk with the usual steps."""

import re

import pytest

from atlas_drake.clients.importing.files import write_controller
from atlas_drake.clients.importing.gentler import find_gentler, gentler_gaits
from atlas_drake.clients.importing.report import results
from atlas_drake.clients.importing.trial import try_robot
from atlas_drake.config import read_yaml
from atlas_drake.scenario import Scenario

from .replaced import limits


def test_gentler_gaits_are_the_robots_own_and_go_into_its_file(imported):
    robot, _ = imported()
    usual = Scenario(model=str(robot.path)).controller_config()
    gaits = dict(gentler_gaits(usual))
    assert len(gaits) == 8
    for words, values in gaits.items():
        made = usual.with_values(values)
        gait, before = made.gait(), usual.gait()
        assert (gait.stride < before.stride) == ("smaller" in words)
        assert (gait.duration > before.duration) == ("slower" in words)
        assert (gait.stance_width < before.stance_width) == ("narrower" in words)
    write_controller(robot.path, values, "It is small.")
    assert Scenario(model=str(robot.path)).controller_config() == made


@pytest.mark.slow
def test_a_weak_robot_is_told_what_it_needs_and_walks_with_smaller_steps(
    imported, tmp_path, monkeypatch
):
    robot, _ = imported(
        limits(r"\w+_hip_roll", 'lower="-0.6" upper="0.6" effort="17" velocity="12"')
    )
    said = []
    monkeypatch.setattr("atlas_drake.clients.importing.trial.LONGEST_PUSHES", 0.0)
    trial = try_robot(robot.path, tmp_path / "log.mcap", said.append)
    assert trial.walks
    found = dict(results(trial))
    needed = r"for steps of [\d.]+ m in [\d.]+ s, \w+_hip_roll needs (\d+).* has 17 N·m"
    assert float(re.match(needed, found["what bounds it"])[1]) > 30
    assert "walks with smaller ones" in found["gentler steps"]
    assert "smaller steps" in said
    written = read_yaml(robot.path.read_text())["controller"]
    assert written["walk"]["steps"]["stride"] == pytest.approx(trial.stride)


SCALED = {"xyz": 1, "size": 1, "radius": 1, "length": 1, "value": 3, "i..": 5} | {
    "effort": 4, "velocity": -0.5, "damping": 4.5
}  # fmt: skip
"""Powers of the size with which attributes of a URDF grow, at the same density."""


@pytest.mark.slow
def test_a_robot_of_a_quarter_of_a_meter_walks_with_gentler_steps(imported):
    def shrink(found):
        power = next(p for name, p in SCALED.items() if re.fullmatch(name, found[2]))
        numbers = [0.2**power * float(number) for number in found[3].split()]
        return f'{found[1]}{found[2]}="{" ".join(map(str, numbers))}"'

    robot, _ = imported(
        (
            rf'((?<!<axis)(?<!_dynamic)(?<!_static) )({"|".join(SCALED)})="([^"]*)"',
            shrink,
        )
    )
    assert robot.com_height < 0.15
    words, values, failed = find_gentler(robot.path, lambda text: None)
    assert words
    assert values
    assert words not in failed
