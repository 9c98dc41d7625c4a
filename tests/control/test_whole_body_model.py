"""Model terms against finite differences and against Drake's own quantities."""

import copy
import dataclasses

import numpy as np
import pytest
from pydrake.multibody.tree import MultibodyForces

from atlas_drake.errors import RobotDescriptionError

SEEDS = range(2)
STEP = 1e-6
"""Of the finite differences [s]."""


@pytest.fixture(params=SEEDS)
def state(request, random_state):
    """A few states in which everything moves."""
    return random_state(request.param)


@pytest.fixture
def terms(model, state):
    return model.evaluate(model.create_context(), state)


@pytest.fixture
def generalized(terms):
    """Generalized velocities in the controller's order."""
    return np.concatenate([terms.V_WP, terms.v])


def moved(model, state, generalized, time):
    """Terms after going on for ``time`` [s] with constant generalized velocities."""
    plant = model.plant
    context = model.create_context()
    velocity = np.empty(plant.num_velocities())
    velocity[model.robot.indices(plant).generalized] = generalized
    q = state[: plant.num_positions()]
    plant.SetPositions(context, q)
    rate = plant.MapVelocityToQDot(context, velocity)
    return model.evaluate(context, np.concatenate([q + time * rate, velocity]))


def derivative(model, state, generalized, quantity):
    """Central difference of a quantity of the terms along the motion."""
    after = quantity(moved(model, state, generalized, STEP))
    before = quantity(moved(model, state, generalized, -STEP))
    return (after - before) / (2.0 * STEP)


def angular_velocity(model, state, generalized, rotation):
    """Angular velocity in W of a rotation matrix that the terms hold."""
    W = (
        derivative(model, state, generalized, rotation)
        @ rotation(moved(model, state, generalized, 0.0)).T
    )
    return np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]]) / 2.0


FRAMES = ("pelvis", "chest", "head", "l_hand", "l_sole", "r_sole")


@pytest.mark.parametrize("name", FRAMES)
def test_velocity_and_bias_of_a_frame_are_derivatives(
    model, state, terms, generalized, name
):
    file = model.robot.file
    name = {"pelvis": file.pelvis, "chest": file.chest}.get(name, name)
    frame = terms.frame(name)
    linear = derivative(model, state, generalized, lambda t: t.frame(name).p_WF)
    angular = angular_velocity(model, state, generalized, lambda t: t.frame(name).R_WF)
    rate = derivative(model, state, generalized, lambda t: t.frame(name).J_WF)
    np.testing.assert_allclose(frame.V_WF, [*angular, *linear], atol=1e-6)
    np.testing.assert_allclose(frame.J_WF @ generalized, frame.V_WF, atol=1e-12)
    np.testing.assert_allclose(frame.bias, rate @ generalized, atol=1e-5)


@pytest.mark.parametrize("name", ["l_hand", "l_sole", "r_sole"])
def test_a_frames_jacobian_column_by_column(model, random_state, name):
    # One velocity at a time, so that an exchange of columns cannot go unseen.
    state = random_state(0)
    terms = model.evaluate(model.create_context(), state)
    for column in range(6 + model.robot.num_joints):
        unit = np.zeros(6 + model.robot.num_joints)
        unit[column] = 1.0
        linear = derivative(model, state, unit, lambda t: t.frame(name).p_WF)
        np.testing.assert_allclose(
            terms.frame(name).J_WF[3:, column], linear, atol=1e-6, err_msg=str(column)
        )


def test_the_terms_of_soles_chest_and_pelvis_are_those_of_their_frames(model, terms):
    file = model.robot.file
    for foot, sole in zip(terms.feet, file.feet, strict=True):
        assert foot is terms.frame(sole.sole_frame)
    chest, pelvis = terms.frame(file.chest), terms.frame(file.pelvis)
    np.testing.assert_array_equal(terms.R_WC, chest.R_WF)
    np.testing.assert_array_equal(terms.w_WC, chest.V_WF[:3])
    np.testing.assert_array_equal(terms.R_WP, pelvis.R_WF)
    np.testing.assert_array_equal(terms.p_WP, pelvis.p_WF)
    np.testing.assert_array_equal(terms.V_WP, pelvis.V_WF)


def test_a_frame_is_computed_once_and_for_the_state_of_its_terms(model, random_state):
    context = model.create_context()
    terms = model.evaluate(context, random_state(0))
    # The context goes on to another state before the frame is asked for.
    model.evaluate(context, random_state(1))
    hand = terms.frame("l_hand")
    assert terms.frame("l_hand") is hand
    fresh = model.evaluate(model.create_context(), random_state(0)).frame("l_hand")
    for late, expected in zip(hand, fresh, strict=True):
        np.testing.assert_array_equal(late, expected)


def test_a_frame_that_the_robot_does_not_have_is_named(terms):
    with pytest.raises(RobotDescriptionError, match=r"'l_hnad'.*'l_hand'"):
        terms.frame("l_hnad")


def test_center_of_mass(model, state, terms, generalized):
    velocity = derivative(model, state, generalized, lambda t: t.com)
    np.testing.assert_allclose(terms.com_velocity, velocity, atol=1e-6)
    # The momentum of a uniform motion of all masses is that of the CoM.
    momentum = terms.M[3:6] @ generalized
    np.testing.assert_allclose(
        momentum, model.robot.mass * terms.com_velocity, atol=1e-8
    )


def test_mass_matrix_gives_the_kinetic_energy(model, state, terms, generalized):
    context = model.create_context()
    model.plant.SetPositionsAndVelocities(context, state)
    energy = model.plant.CalcKineticEnergy(context)
    assert 0.5 * generalized @ terms.M @ generalized == pytest.approx(energy)
    np.testing.assert_allclose(terms.M, terms.M.T, atol=1e-9)
    assert np.linalg.eigvalsh(terms.M)[0] > 0.0


def damping_of(model):
    joints = [model.plant.GetJointByName(name) for name in model.robot.joint_names]
    return np.array([joint.default_damping_vector()[0] for joint in joints])


def test_equations_of_motion_are_drakes(model, state, terms):
    plant = model.plant
    # Without damping the feet land on their heels: it would be a fault to lose it.
    assert (damping_of(model) > 0.0).all()
    context = model.create_context()
    plant.SetPositionsAndVelocities(context, state)
    order = model.robot.indices(plant).generalized
    acceleration = np.random.default_rng(1).normal(size=len(order))
    in_plant_order = np.empty_like(acceleration)
    in_plant_order[order] = acceleration
    forces = MultibodyForces(plant)
    plant.CalcForceElementsContribution(context, forces)
    expected = plant.CalcInverseDynamics(context, in_plant_order, forces)[order]
    np.testing.assert_allclose(terms.M @ acceleration + terms.h, expected, atol=1e-8)


def test_joints_are_in_message_order(model, random_state):
    robot, plant = model.robot, model.plant
    context = model.create_context()
    for index, name in enumerate(robot.joint_names):
        joint = plant.GetJointByName(name)
        state = random_state(0)
        state[plant.num_positions() :] = 0.0
        state[joint.position_start()] = 0.123
        state[plant.num_positions() + joint.velocity_start()] = 0.456
        terms = model.evaluate(context, state)
        assert terms.q[index] == 0.123
        np.testing.assert_array_equal(np.flatnonzero(terms.v), [index])
        assert terms.v[index] == 0.456


def test_terms_do_not_depend_on_what_a_context_was_used_for(model, random_state):
    context = model.create_context()
    first = model.evaluate(context, random_state(0))
    kept = copy.deepcopy(first)
    model.evaluate(context, random_state(1))
    fresh = model.evaluate(model.create_context(), random_state(0))
    again = model.evaluate(context, random_state(0))
    for field in dataclasses.fields(first):
        if field.name not in ("feet", "frames", "compute_frame"):
            for terms in (first, fresh, again):
                np.testing.assert_array_equal(
                    getattr(terms, field.name), getattr(kept, field.name), field.name
                )
