"""Steps that the ranges of the leg joints allow."""

from dataclasses import replace
from pathlib import Path

import pytest

from atlas_drake import Scenario
from atlas_drake.behaviors.leg_ranges import MARGIN, within_ranges
from atlas_drake.frozen import read_only
from atlas_drake.robot import load_robot

HERON = str(Path(__file__).parents[1] / "robots" / "heron" / "heron.yaml")
DROP = 0.02
"""Of the center of mass [m]."""


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
    found = within_ranges(limits, robot, DROP)
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
    found = within_ranges(limits, narrowed(robot, joint, share), DROP)
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
    found = within_ranges(limits, weakened(robot, 0.5), DROP)
    assert found.forward == pytest.approx(0.5 * limits.forward, rel=0.01)
    assert found.backward == pytest.approx(0.5 * limits.backward, rel=0.01)
    assert found.width.greatest == pytest.approx(0.5 * limits.width.greatest, rel=0.01)
    weakest = within_ranges(limits, weakened(robot, 0.1), DROP)
    assert weakest.width.greatest == robot.stance_width


def test_limits_of_a_scaled_robot_are_within_its_ranges():
    config, robot = Scenario(model=HERON).controller_config(), load_robot(HERON)
    found = within_ranges(config.walk.limits, robot, config.stance.com_drop)
    assert found.width == config.walk.limits.width
    assert found.toe_in == config.walk.limits.toe_in
