"""The controller's defaults for a robot of another size."""

from dataclasses import replace

import pytest

from atlas_drake.behaviors.scaling import dimension, scaled
from atlas_drake.robot import ATLAS, load_robot
from atlas_drake.shipped import CONTROLLER

QUARTER = replace(
    ATLAS, mass=ATLAS.mass / 8, height=ATLAS.height / 4, hip_time=ATLAS.hip_time / 2
)
"""A robot of a quarter of Atlas' height: its times are half as long."""


@pytest.mark.parametrize(
    ("unit", "powers"),
    [
        ("m", (1, 0, 0)),
        ("rad/s²", (0, -2, 0)),
        ("1/(m/s²)²", (-2, 4, 0)),
        ("1/(N·m)²", (-4, 4, -2)),
        ("N·m·s/rad", (2, -1, 1)),
        ("-", (0, 0, 0)),
    ],
)
def test_units_have_their_dimension(unit, powers):
    assert tuple(dimension(unit)) == powers


def test_an_unknown_unit_is_named():
    with pytest.raises(ValueError, match=r"m/furlong has the unknown factor furlong"):
        dimension("m/furlong")


def test_atlas_keeps_its_values():
    robot = load_robot()
    assert ATLAS.mass == pytest.approx(robot.mass, abs=1e-3)
    assert ATLAS.height == pytest.approx(robot.com_height, abs=1e-4)
    assert ATLAS.hip_time == pytest.approx(robot.hip_time, abs=1e-4)
    assert ATLAS.sole_length == robot.file.sole.length
    assert not robot.file.scaled
    assert scaled(CONTROLLER, ATLAS) == CONTROLLER


def test_each_value_scales_as_its_unit_says():
    atlas, small = CONTROLLER, scaled(CONTROLLER, QUARTER)
    for one, by in (
        (lambda c: c.walk.limits.forward, 1 / 4),
        (lambda c: c.walk.limits.duration.least, 1 / 2),
        (lambda c: c.walk.limits.toe_out, 1),
        (lambda c: c.walk.adjustment.shortest_swing, 1 / 2),
        (lambda c: c.walk.adjustment.foot_speed, 1 / 2),
        (lambda c: c.walk.swing.landing_speed, 1 / 2),
        (lambda c: c.walk.swing.late_acceleration, 1),
        (lambda c: c.gains.com_height.kp, 4),
        (lambda c: c.gains.com_height.kd, 2),
        (lambda c: c.gains.weights.com, 1),
        (lambda c: c.gains.weights.pelvis_tilt, 1 / 16),
        (lambda c: c.gains.weights.contact_force, 64),
        (lambda c: c.stance.balance_effort, 1 / 32),
        # In the unit of its coordinates: metres of height, radians of turns.
        (lambda c: c.manipulate.rates.height.speed, 1 / 2),
        (lambda c: c.manipulate.rates.turn.speed, 2),
        (lambda c: c.manipulate.rates.turn.rate, 2),
        # As the soles, which are Atlas' here.
        (lambda c: c.walk.adjustment.cop_forward, 1),
        (lambda c: c.gains.contact.width_margin, 1),
    ):
        assert one(small) == pytest.approx(by * one(atlas))


def test_stronger_hips_allow_faster_steps_for_balance():
    atlas = CONTROLLER.walk.adjustment
    strong = scaled(CONTROLLER, replace(ATLAS, hip_time=ATLAS.hip_time / 2))
    hasty = replace(
        atlas,
        shortest_swing=atlas.shortest_swing / 2,
        foot_speed=atlas.foot_speed * 2,
    )
    assert strong.walk.adjustment == hasty
    walk = replace(strong.walk, adjustment=atlas)
    assert replace(strong, walk=walk) == CONTROLLER


def test_the_feet_stand_as_in_the_stand_prep_pose():
    config = CONTROLLER.scaled(replace(QUARTER, stance_width=0.09, sole_width=0.05))
    assert config.stance.width == 0.09
    least, greatest = config.walk.limits.width
    assert least < 0.09 < greatest
    assert config.gait().half_width == pytest.approx(0.045)


def test_wide_soles_of_a_low_robot_stay_apart():
    low = replace(QUARTER, height=0.30, sole_width=0.10, stance_width=0.12)
    assert CONTROLLER.scaled(low).walk.limits.width.least > 0.10
