"""The distance of the CMP from the CoP that the motion of the legs costs."""

import numpy as np
import pytest

from atlas_drake.control.whole_body.angular_momentum import (
    legs_offset,
    swing_inertia,
    trunk_inertia,
)
from atlas_drake.control.whole_body.model import standing_terms
from atlas_drake.units import GRAVITY

STILL = np.zeros(6)


@pytest.fixture
def standing(model):
    """Plant, context and terms of the robot at rest, with knees bent unequally."""
    robot, plant, context = model.robot, model.plant, model.create_context()
    state = plant.GetPositionsAndVelocities(context)
    joints = robot.stand_prep.copy()
    for leg, more in zip(robot.legs, (0.2, 0.5), strict=True):
        joints[leg.knee] += leg.knee_sign * more
    state[robot.indices(plant).q] = joints
    return plant, context, model.evaluate(context, state)


def momentum(plant, context, v):
    """Angular momentum about the center of mass by Drake [N·m·s], shape (3,)."""
    plant.SetVelocities(context, v)
    com = plant.CalcCenterOfMassPositionInWorld(context)
    about_com = plant.CalcSpatialMomentumInWorldAboutPoint(context, com)
    return about_com.rotational()


@pytest.mark.parametrize("foot", [0, 1])
def test_the_offset_is_the_rate_of_the_angular_momentum(model, standing, foot):
    plant, context, terms = standing
    leg, order = model.robot.legs[foot], model.robot.indices(plant).generalized
    # From rest, accelerations change the momentum as velocities of their size make it.
    v = np.zeros(plant.num_velocities())
    v[order[6 + leg.joints]] = np.random.default_rng(foot).uniform(-5.0, 5.0, 6)
    sole = terms.feet[foot].J_WF @ v[order]
    x, y, _ = momentum(plant, context, v)
    legs = [leg.joints for leg in model.robot.legs]
    soles = [sole if one == foot else STILL for one in (0, 1)]
    found = legs_offset(terms, legs, soles, np.zeros(2))
    expected = np.array([y, -x]) / (terms.mass * GRAVITY)
    # The damping of the inverse takes a few per cent.
    np.testing.assert_allclose(found, expected, atol=0.05 * np.hypot(*expected))


def test_a_leg_whose_motion_is_not_known_has_no_part(model, standing):
    *_, terms = standing
    legs = [None, model.robot.legs[1].joints]
    moving = np.array([0.0, 0.0, 0.0, 5.0, 0.0, 0.0])
    found = legs_offset(terms, legs, [moving, STILL], np.zeros(2))
    np.testing.assert_array_equal(found, np.zeros(2))


def test_the_cmp_stays_behind_a_foot_that_is_accelerated(model):
    legs = [leg.joints for leg in model.robot.legs]
    ahead, aside = swing_inertia(standing_terms(model.robot), legs)
    assert -0.01 < ahead < -0.002
    assert -0.01 < aside < -0.002


def test_the_trunk_turns_less_easily_sideways(model):
    # With the shoulders and arms far from the middle.
    legs = [leg.joints for leg in model.robot.legs]
    about_x, about_y = trunk_inertia(standing_terms(model.robot), legs)
    mass = model.robot.mass
    assert 3.0 < about_y * mass * GRAVITY < about_x * mass * GRAVITY < 20.0
