"""The whole-body QP: physics hold exactly, bounds are kept, tasks are met."""

import dataclasses

import numpy as np
import pytest

from atlas_drake.control.gains import ControlGains, QpWeights
from atlas_drake.control.whole_body.command import (
    TOES,
    EffortBounds,
    FootCommand,
    Pressure,
    WholeBodyCommand,
)
from atlas_drake.control.whole_body.model import GRAVITY
from atlas_drake.control.whole_body.qp import MIDDLE, WholeBodyQp

FEET = {"both": (0, 1), "left": (0,), "right": (1,), "none": ()}
TOLERANCE = 1e-5
"""To which the solver keeps bounds and equalities [N·m]."""

UNBOUNDED = 1e5
"""Normal force that no foot here reaches [N]."""


@pytest.fixture(scope="module")
def gains():
    return ControlGains()


@pytest.fixture(scope="module")
def qp(robot, gains):
    return WholeBodyQp(robot, gains)


@pytest.fixture
def bounds(robot):
    """All joints the behaviour's own."""
    limit = robot.effort_limit
    return EffortBounds(-limit, limit, np.zeros(robot.num_joints, dtype=bool))


def command_for(robot, contacts, random=None, scale=1.0):
    """A command with the given feet in contact: to rest, or at random."""

    def wish(size):
        return np.zeros(size) if random is None else scale * random.normal(size=size)

    return WholeBodyCommand(
        com_acceleration=wish(3),
        pendulum_base=0.1 * wish(3),
        pelvis_angular_acceleration=wish(3),
        chest_angular_acceleration=wish(3),
        feet=tuple(
            FootCommand(wish(6), UNBOUNDED if foot in contacts else 0.0)
            for foot in (0, 1)
        ),
        joint_acceleration=wish(robot.num_joints),
        joint_weight=np.full(robot.num_joints, 0.05),
        balance=bool(contacts),
    )


def over_its_feet(command, terms, acceleration=(0.0, 0.0, 0.0)):
    """The command with the pendulum's base where it gives the acceleration."""
    acceleration = np.array(acceleration)
    base = np.array([*terms.com[:2], terms.feet[0].p_WF[2]])
    base[:2] -= acceleration[:2] * (terms.com[2] - base[2]) / GRAVITY
    return dataclasses.replace(
        command, com_acceleration=acceleration, pendulum_base=base
    )


def moving(model, random_state, standing, seed):
    """Terms near the stand-prep pose, so that contacts make sense, but in motion."""
    random = np.random.default_rng(seed)
    state = random_state(seed)
    indices = model.robot.indices(model.plant)
    state[:4] = np.array([1.0, 0.0, 0.0, 0.0]) + 0.02 * random.normal(size=4)
    state[:4] /= np.linalg.norm(state[:4])
    state[indices.q] = standing.q + 0.05 * random.normal(size=len(standing.q))
    state[model.plant.num_positions() :] *= 0.1
    return model.evaluate(model.create_context(), state)


def residual(terms, solution):
    """What the equations of motion lack with the solution's forces, shape (6 + n,).

    The pelvis' acceleration, which the solution leaves out, is taken from the six
    rows without motors, so that the residual is in the joints' rows.
    """
    force = -terms.h
    for foot, wrench in zip(terms.feet, solution.foot_wrenches, strict=True):
        force = force + foot.J_WF.T @ wrench
    force[6:] += solution.effort
    joints = solution.joint_acceleration
    pelvis = np.linalg.solve(terms.M[:6, :6], force[:6] - terms.M[:6, 6:] @ joints)
    return terms.M @ np.concatenate([pelvis, joints]) - force


@pytest.mark.parametrize("feet", FEET)
@pytest.mark.parametrize("seed", range(5))
def test_solution_obeys_the_equations_of_motion(
    model, robot, qp, bounds, random_state, standing, feet, seed
):
    terms = moving(model, random_state, standing, seed)
    random = np.random.default_rng(seed)
    solution = qp.solve(terms, command_for(robot, FEET[feet], random), bounds)
    assert solution.found
    np.testing.assert_allclose(residual(terms, solution), 0.0, atol=1e-6)
    assert (np.abs(solution.effort) <= robot.effort_limit + TOLERANCE).all()


@pytest.mark.parametrize("feet", ["both", "left", "right"])
def test_wrenches_are_ones_that_the_ground_can_give(
    model, robot, qp, gains, bounds, random_state, standing, feet
):
    contact, sole = gains.contact, robot.file.sole
    # Centre of pressure: p = (-m_y, m_x) / normal.
    reach_x = sole.length / 2 - contact.length_margin
    reach_y = sole.width / 2 - contact.width_margin
    yaw = contact.friction * contact.yaw_moment_arm
    limits_met = 0
    for seed in range(10):
        terms = moving(model, random_state, standing, seed)
        # Wishes far beyond what friction and the soles' edges allow.
        random = np.random.default_rng(seed)
        command = command_for(robot, FEET[feet], random, scale=30.0)
        solution = qp.solve(terms, command, bounds)
        assert solution.found
        for foot in FEET[feet]:
            R_FW = terms.feet[foot].R_WF.T
            moment = R_FW @ solution.foot_wrenches[foot, :3]
            force = R_FW @ solution.foot_wrenches[foot, 3:]
            normal, slack = force[2], 1e-5
            assert normal >= -slack
            # The true friction cone; the program keeps to a pyramid inside it.
            assert np.hypot(force[0], force[1]) <= contact.friction * normal + slack
            assert abs(moment[1]) <= reach_x * normal + slack
            assert abs(moment[0]) <= reach_y * normal + slack
            assert abs(moment[2]) <= yaw * normal + slack
            limits_met += abs(moment[1]) > 0.999 * reach_x * normal > slack
            limits_met += abs(moment[0]) > 0.999 * reach_y * normal > slack
    assert limits_met >= 3, "wishes too small to test the limits"


@pytest.mark.parametrize("foot", [0, 1])
def test_a_foot_in_the_air_gets_no_wrench(robot, qp, bounds, standing, foot):
    solution = qp.solve(standing, command_for(robot, (1 - foot,)), bounds)
    assert solution.found
    np.testing.assert_array_equal(solution.foot_wrenches[foot], 0.0)
    assert solution.foot_wrenches[1 - foot, 5] > 0.0


def test_standing_still_takes_the_weight(robot, qp, bounds, standing):
    command = over_its_feet(command_for(robot, (0, 1)), standing)
    solution = qp.solve(standing, command, bounds)
    assert solution.found
    weight = robot.mass * GRAVITY
    total = solution.foot_wrenches[:, 3:].sum(axis=0)
    np.testing.assert_allclose(total, [0.0, 0.0, weight], atol=0.01 * weight)
    # The pose is the same on both sides up to rounding of its figures.
    left, right = solution.foot_wrenches[:, 5]
    assert left == pytest.approx(right, rel=0.1)
    # The wrists start at their end stops, which they leave at once.
    trunk = robot.limb("back", "neck", "l_leg", "r_leg")
    np.testing.assert_allclose(solution.joint_acceleration[trunk], 0.0, atol=0.5)


@pytest.mark.parametrize("ahead", [0.0, 0.05])
def test_centre_of_pressure_is_where_it_shall_be(robot, qp, bounds, standing, ahead):
    height = standing.com[2] - standing.feet[0].p_WF[2]
    acceleration = [-ahead * GRAVITY / height, 0.0, 0.0]
    command = over_its_feet(command_for(robot, (0, 1)), standing, acceleration)
    solution = qp.solve(standing, command, bounds)
    moment = np.zeros(3)
    for foot, wrench in zip(standing.feet, solution.foot_wrenches, strict=True):
        moment += wrench[:3] + np.cross(foot.p_WF, wrench[3:])
    force = solution.foot_wrenches[:, 5].sum()
    cop = np.array([-moment[1], moment[0]]) / force
    np.testing.assert_allclose(cop, command.pendulum_base[:2], atol=0.01)


@pytest.mark.parametrize("aside", [(0.03, 0.0), (0.0, 0.03)])
@pytest.mark.parametrize("raised", [0.0, 0.05])
def test_the_force_of_the_ground_goes_through_the_pendulums_base(
    robot, bounds, standing, aside, raised
):
    # Where the acceleration asked for is another than that which the base gives.
    command = over_its_feet(command_for(robot, (0, 1)), standing)
    base = command.pendulum_base + np.array([*aside, raised])
    command = dataclasses.replace(command, pendulum_base=base)

    def moment(weights):
        gains = dataclasses.replace(ControlGains(), weights=weights)
        wrenches = WholeBodyQp(robot, gains).solve(standing, command, bounds)
        total = np.zeros(3)
        for foot, wrench in zip(standing.feet, wrenches.foot_wrenches, strict=True):
            total += wrench[:3] + np.cross(foot.p_WF - base, wrench[3:])
        return np.linalg.norm(total[:2])

    with_it, without = moment(QpWeights()), moment(QpWeights(pendulum=0.0))
    assert without > 0.02 * robot.mass * GRAVITY
    assert with_it < 0.5 * without


@pytest.mark.parametrize("roll", [-0.002, 0.002])
def test_feet_do_not_push_against_each_other_for_next_to_nothing(
    model, robot, qp, bounds, standing, roll
):
    # With the pressure at the toes, a sole turned by so little wins a thousandth of
    # the moment that is lacking, if 160 N push the feet apart or together.
    state = np.zeros(model.num_states)
    state[0] = 1.0
    state[robot.indices(model.plant).q] = standing.q
    for name, sign in (("l_leg_akx", 1.0), ("r_leg_akx", -1.0)):
        state[robot.indices(model.plant).q[robot.joint_index(name)]] += sign * roll
    terms = model.evaluate(model.create_context(), state)
    command = over_its_feet(command_for(robot, (0, 1)), terms, [-2.0, 0.0, 0.0])
    left, right = qp.solve(terms, command, bounds).foot_wrenches
    assert abs(left[4] - right[4]) < 40.0


@pytest.mark.parametrize("axis", range(3))
def test_com_acceleration_asked_for_is_reached(robot, qp, bounds, standing, axis):
    command = over_its_feet(command_for(robot, (0, 1)), standing)
    still = qp.solve(standing, command, bounds).foot_wrenches[:, 3:].sum(axis=0)
    wanted = np.zeros(3)
    wanted[axis] = 0.1
    command = over_its_feet(command, standing, wanted)
    pushed = qp.solve(standing, command, bounds).foot_wrenches[:, 3:].sum(axis=0)
    gained = (pushed - still) / robot.mass
    np.testing.assert_allclose(gained, wanted, atol=0.03)


def test_in_the_air_the_robot_falls_and_only_inner_forces_act(
    robot, qp, bounds, standing
):
    falling = FootCommand(np.array([0.0, 0.0, 0.0, 0.0, 0.0, -GRAVITY]), 0.0)
    command = dataclasses.replace(command_for(robot, ()), feet=(falling, falling))
    solution = qp.solve(standing, command, bounds)
    assert solution.found
    np.testing.assert_array_equal(solution.foot_wrenches, 0.0)
    # A falling robot that keeps its pose needs no effort at all, but for the wrists,
    # which start at their end stops and leave them at once.
    still = robot.limb("back", "neck", "l_leg", "r_leg")
    np.testing.assert_allclose(solution.effort[still], 0.0, atol=0.05)


@pytest.mark.parametrize("feet", FEET)
def test_user_held_joints_get_exactly_the_users_effort(
    robot, qp, bounds, standing, feet
):
    held = robot.limb("l_arm", "r_arm", "neck")
    effort = np.where(held, np.linspace(-5.0, 5.0, robot.num_joints), 0.0)
    mixed = EffortBounds(
        np.where(held, effort, bounds.lower), np.where(held, effort, bounds.upper), held
    )
    command = command_for(robot, FEET[feet])
    solution = qp.solve(standing, command, mixed)
    assert solution.found
    np.testing.assert_allclose(solution.effort[held], effort[held], atol=TOLERANCE)
    # Their motion is what these efforts give, and the rest of the body knows of it.
    np.testing.assert_allclose(residual(standing, solution), 0.0, atol=1e-6)
    free = qp.solve(standing, command, bounds)
    assert np.abs(solution.joint_acceleration - free.joint_acceleration)[held].max() > 1


def test_users_that_resist_acceleration_are_reckoned_with(robot, qp, bounds, standing):
    # The user's damper takes an effort of inertia·v̇ off what the bounds say.
    held = robot.limb("l_arm", "r_arm", "neck")
    effort = np.where(held, np.linspace(-5.0, 5.0, robot.num_joints), 0.0)
    inertia = np.where(held, 0.3, 0.0)
    mixed = EffortBounds(
        np.where(held, effort, bounds.lower),
        np.where(held, effort, bounds.upper),
        held,
        inertia,
    )
    solution = qp.solve(standing, command_for(robot, (0, 1)), mixed)
    assert solution.found
    np.testing.assert_allclose(residual(standing, solution), 0.0, atol=1e-6)
    resisted = effort - inertia * solution.joint_acceleration
    np.testing.assert_allclose(solution.effort[held], resisted[held], atol=TOLERANCE)
    assert np.abs(inertia * solution.joint_acceleration).max() > 0.1


def test_effort_bounds_of_blended_joints_are_kept(robot, qp, bounds, standing):
    free = qp.solve(standing, command_for(robot, (0, 1)), bounds)
    half = 0.5 * np.abs(free.effort)
    tight = EffortBounds(-half, half, bounds.user_held)
    solution = qp.solve(standing, command_for(robot, (0, 1)), tight)
    assert solution.found
    assert (np.abs(solution.effort) <= half + TOLERANCE).all()
    np.testing.assert_allclose(residual(standing, solution), 0.0, atol=1e-6)


def test_normal_force_keeps_to_its_bounds(robot, qp, bounds, standing):
    command = over_its_feet(command_for(robot, (0, 1)), standing)
    share = 0.1 * robot.mass * GRAVITY
    capped = dataclasses.replace(command.feet[0], max_normal_force=share)
    solution = qp.solve(
        standing, dataclasses.replace(command, feet=(capped, command.feet[1])), bounds
    )
    assert solution.found
    assert solution.foot_wrenches[0, 5] <= share + 1e-5
    raised = dataclasses.replace(command.feet[0], min_normal_force=8.0 * share)
    solution = qp.solve(
        standing, dataclasses.replace(command, feet=(raised, command.feet[1])), bounds
    )
    assert solution.found
    assert solution.foot_wrenches[0, 5] >= 8.0 * share - 1e-5


def test_joints_beyond_their_limits_are_turned_back(model, robot, qp, bounds, standing):
    knee = robot.joint_index("l_leg_kny")
    state = np.zeros(model.num_states)
    state[0] = 1.0
    q = standing.q.copy()
    q[knee] = robot.position_upper[knee] + 0.05
    state[robot.indices(model.plant).q] = q
    terms = model.evaluate(model.create_context(), state)
    wish = np.zeros(robot.num_joints)
    wish[knee] = 50.0
    command = dataclasses.replace(command_for(robot, ()), joint_acceleration=wish)
    solution = qp.solve(terms, command, bounds)
    assert solution.found
    assert solution.joint_acceleration[knee] < 0.0


@pytest.mark.parametrize("feet", FEET)
def test_contradicting_bounds_still_give_finite_efforts(
    robot, qp, bounds, standing, feet
):
    crossed = EffortBounds(bounds.upper, bounds.lower, bounds.user_held)
    solution = qp.solve(standing, command_for(robot, FEET[feet]), crossed)
    assert not solution.found
    assert np.isfinite(solution.effort).all()
    assert (np.abs(solution.effort) <= robot.effort_limit).all()


def test_without_a_solution_the_efforts_carry_the_weight(robot, qp, bounds, standing):
    command = command_for(robot, (0, 1))
    impossible = dataclasses.replace(
        command.feet[0], min_normal_force=2.0, max_normal_force=1.0
    )
    solution = qp.solve(
        standing,
        dataclasses.replace(command, feet=(impossible, command.feet[1])),
        bounds,
    )
    assert not solution.found
    weight = robot.mass * GRAVITY
    np.testing.assert_allclose(
        solution.foot_wrenches[:, 5], [weight / 2, weight / 2], rtol=1e-12
    )
    expected = standing.h[6:].copy()
    for foot, wrench in zip(standing.feet, solution.foot_wrenches, strict=True):
        expected -= foot.J_WF[:, 6:].T @ wrench
    np.testing.assert_allclose(solution.effort, expected, atol=1e-9)


def test_same_input_same_bits(model, robot, gains, qp, bounds, random_state, standing):
    random = np.random.default_rng(3)
    terms = moving(model, random_state, standing, 3)
    command = command_for(robot, (0, 1), random)
    first = qp.solve(terms, command, bounds)
    qp.solve(standing, command_for(robot, (1,)), bounds)
    for again in (
        qp.solve(terms, command, bounds),
        WholeBodyQp(robot, gains).solve(terms, command, bounds),
    ):
        for field in dataclasses.fields(first):
            before, after = getattr(first, field.name), getattr(again, field.name)
            assert np.asarray(before).tobytes() == np.asarray(after).tobytes()


@pytest.mark.parametrize(
    ("pressure", "low", "high"),
    [(Pressure.MIDDLE, -MIDDLE, MIDDLE), (Pressure.TOES, 0.13 - TOES, 0.13)],
)
def test_pressure_keeps_to_its_part_of_the_sole(
    robot, qp, bounds, standing, pressure, low, high
):
    command = command_for(robot, (0, 1))
    left, right = command.feet
    left = dataclasses.replace(left, pressure=pressure, min_normal_force=80.0)
    # Ahead and aside, so that the pressure runs to where it may.
    for acceleration in ([1.0, 0.5, 0.0], [-1.0, -0.5, 0.0]):
        wanted = dataclasses.replace(
            command, feet=(left, right), com_acceleration=np.array(acceleration)
        )
        solution = qp.solve(standing, wanted, bounds)
        assert solution.found
        moment = standing.feet[0].R_WF.T @ solution.foot_wrenches[0, :3]
        force = standing.feet[0].R_WF.T @ solution.foot_wrenches[0, 3:]
        assert force[2] >= 80.0 - TOLERANCE
        assert low - 1e-6 <= -moment[1] / force[2] <= high + 1e-6
