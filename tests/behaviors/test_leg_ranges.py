"""Steps that the ranges of the leg joints allow."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from atlas_drake import Scenario
from atlas_drake.behaviors.leg_clearance import leg_clearance
from atlas_drake.behaviors.leg_ranges import MARGIN, within_ranges
from atlas_drake.behaviors.scaling import CLEARANCE
from atlas_drake.frozen import read_only
from atlas_drake.robot import load_robot

HERON = str(Path(__file__).parents[1] / "robots" / "heron" / "heron.yaml")
DROP = 0.02
"""Of the center of mass [m]."""

FROM_LINE = re.MULTILINE | re.DOTALL


def ranges(limits, robot):
    return within_ranges(limits, robot, robot.stance_width, DROP)


@pytest.fixture(scope="module")
def limits():
    return Scenario(model="atlas").controller_config().walk.limits


def narrowed(robot, joint, share):
    """The robot with a share of the ranges of both joints of this name."""
    places = [robot.joint_index(f"{side}_leg_{joint}") for side in "lr"]
    lower, upper = robot.position_lower.copy(), robot.position_upper.copy()
    lower[places] *= share
    upper[places] *= share
    return replace(
        robot, position_lower=read_only(lower), position_upper=read_only(upper)
    )


def test_atlas_reaches_what_its_file_allows(robot, limits):
    found = ranges(limits, robot)
    assert found.width.greatest == pytest.approx(limits.width.greatest, rel=0.002)
    assert found.backward == pytest.approx(limits.backward, rel=0.002)
    assert found.toe_out == limits.toe_out
    # Up to the margin.
    assert found.toe_in == pytest.approx(limits.toe_in, abs=MARGIN)


@pytest.mark.parametrize(
    ("joint", "share", "name"),
    [("akx", 0.25, "width"), ("hpy", 0.1, "backward"), ("hpz", 0.3, "toe_in")],
)
def test_a_joint_with_little_range_bounds_its_steps(robot, limits, joint, share, name):
    found = ranges(limits, narrowed(robot, joint, share))
    less, usual = getattr(found, name), getattr(limits, name)
    if name == "width":
        assert less.least == usual.least
        less, usual = less.greatest, usual.greatest
    assert robot.stance_width * (name == "width") <= less < 0.9 * usual


def weakened(robot, share):
    effort = robot.effort_limit.copy()
    effort[[leg.knee for leg in robot.legs]] *= share
    return replace(robot, effort_limit=read_only(effort))


def test_weak_knees_carry_shorter_and_narrower_steps(robot, limits):
    found = ranges(limits, weakened(robot, 0.5))
    assert found.forward == pytest.approx(0.5 * limits.forward, rel=0.01)
    assert found.backward == pytest.approx(0.5 * limits.backward, rel=0.01)
    assert found.width.greatest == pytest.approx(0.5 * limits.width.greatest, rel=0.01)
    weakest = ranges(limits, weakened(robot, 0.1))
    assert weakest.width.greatest == robot.stance_width


def test_feet_pass_each_other_nearer_than_they_step():
    limits = Scenario(model=HERON).controller_config().walk.limits
    sole = load_robot(HERON).file.sole
    assert sole.width < limits.passing < 1.4 * sole.width


def test_limits_of_a_scaled_robot_are_within_its_ranges():
    config, robot = Scenario(model=HERON).controller_config(), load_robot(HERON)
    found = ranges(config.walk.limits, robot)
    assert tuple(found.width) == pytest.approx(config.walk.limits.width, abs=1e-3)
    assert found.toe_in == config.walk.limits.toe_in


def test_legs_pass_each_other_at_all_widths_of_a_walk(tmp_path):
    """A robot whose shanks are wide stands and steps as much wider as it needs."""
    shutil.copytree(Path(HERON).parent, tmp_path, dirs_exist_ok=True)
    urdf, file = tmp_path / "heron.urdf", tmp_path / "heron.yaml"
    text = urdf.read_text()
    for side in ("left", "right"):
        link = f'<link name="{side}_shank">'
        shape = '<geometry><box size="0.1 0.16 0.2" /></geometry>'
        text = text.replace(
            link, f'{link}<collision><origin xyz="0 0 -0.15" />{shape}</collision>'
        )
    urdf.write_text(text)
    own = re.sub(r"^controller:.*?(?=^joints:)", "", file.read_text(), flags=FROM_LINE)
    file.write_text(own)
    robot, config = load_robot(file), Scenario(model=str(file)).controller_config()
    limits, width = config.walk.limits, config.gait().stance_width
    apart = 0.16 + CLEARANCE * robot.com_height
    assert limits.width.least == pytest.approx(apart, abs=0.002)
    assert limits.passing == pytest.approx(apart, abs=0.002)
    # With feet side by side one may turn inward, and as far outward as it may.
    assert width > max(apart, robot.stance_width)
    clears = leg_clearance(robot)
    assert all(clears(width, turn) for turn in (-limits.toe_in, limits.toe_out))
    assert not clears(width - 0.01, -limits.toe_in)


@pytest.mark.parametrize("model", ["atlas", "atlas_v3"])
def test_legs_of_the_projects_robots_pass_each_other(model):
    clears = leg_clearance(load_robot(model))
    config = Scenario(model=model).controller_config()
    assert clears(config.walk.limits.width.least)
    assert clears(config.walk.limits.passing)
    assert clears(config.gait().stance_width, -config.walk.limits.toe_in)
